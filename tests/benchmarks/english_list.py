"""English words that the trees were never shown, pronounced by us and by others.

The tenth of CMUdict whose CRC-32 is divisible by ten, as the lexicon that is shipped has it. Without stress
the reduced vowel counts as its full one, as CMUdict writes both AH.
"""

from __future__ import annotations

import importlib.util
import re
import subprocess
import sys
import types
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from fapstream.tts.english import english
from fapstream.tts.lexicon import Lexicon
from fapstream.tts.stems import Stems
from fapstream.tts.tables import read_bytes
from tools.cmudict import distance, token

Phones = tuple[str, ...]
Predict = Callable[[str], Phones]
"""Word -> phones, vowels with stress digits where they are known."""


@dataclass(frozen=True, slots=True)
class Score:
    """Of `words`: how many are wholly right without and with stress; `phone_error_rate`: edits per phone."""

    words: int
    right: int
    right_with_stress: int
    phone_error_rate: float


@cache
def held_out(limit: int = 0) -> dict[str, Phones]:
    """Words of letters only, at most `limit` of them if that is not 0, spread over all."""
    lexicon = Lexicon(read_bytes("en/lexicon.bin"))
    words = [w for w in lexicon.words() if re.fullmatch("[a-z]{2,}", w) and zlib.crc32(w.encode()) % 10 == 0]
    return {w: lexicon.get(w) or () for w in words[:: max(1, len(words) // limit) if limit else 1]}


def plain(tokens: Phones) -> Phones:
    """Without stress."""
    return tuple("V" if t.rstrip("012") == "@" else t.rstrip("012") for t in tokens)


def score_words(predict: Predict, words: Mapping[str, Phones]) -> Score:
    """How right the predictions are."""
    right = stressed = edits = phones = 0
    for word, wanted in words.items():
        guess = predict(word)
        right += plain(guess) == plain(wanted)
        stressed += guess == wanted
        edits += distance(plain(guess), plain(wanted))
        phones += len(wanted)
    return Score(len(words), right, stressed, edits / phones)


def contestants(words: Mapping[str, Phones]) -> dict[str, Predict]:
    """Who is there: the trees alone, ours with stems and compounds of the other words, espeak-ng, g2p-en."""
    own = english()
    lexicon = Lexicon(read_bytes("en/lexicon.bin"))
    every = held_out()
    stems = Stems(lambda word: None if word in every else lexicon.get(word))
    found: dict[str, Predict] = {
        "trees": own.guess,
        "with_stems": lambda word: stems.inflected(word) or stems.compound(word) or own.guess(word),
    }
    if read := espeak(words):
        found["espeak"] = read
    if predict := g2p_en():
        found["g2p_en"] = predict
    return found


def espeak(words: Mapping[str, Phones]) -> Predict | None:
    """The command espeak-ng on all the words at once; None if it is not there."""
    command = ["espeak-ng", "-q", "-v", "en-us", "--ipa"]
    try:
        done = subprocess.run(command, input="\n\n".join(words), text=True, capture_output=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    lines = [line.strip() for line in done.stdout.splitlines() if line.strip()]
    return dict(zip(words, map(from_ipa, lines), strict=True)).__getitem__


@cache
def _ipa() -> tuple[re.Pattern[str], dict[str, Phones]]:
    path = Path(__file__).parent / "data" / "espeak_en.tsv"
    rows = [
        line.split("\t") for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith(";")
    ]
    table = {symbol: tuple(phones.split()) for symbol, phones in rows}
    longest = "|".join(re.escape(s) for s in sorted(table, key=len, reverse=True))
    return re.compile(f"[ˈˌ]|{longest}"), table


def from_ipa(text: str) -> Phones:
    """espeak-ng's notation in our phones; a stress mark stands before its syllable's first phone."""
    pattern, table = _ipa()
    out: list[str] = []
    stress = "0"
    for found in pattern.findall(text):
        if found in "ˈˌ":
            stress = "1" if found == "ˈ" else "2"
            continue
        for phone in table[found]:
            vowel = phone[0] in "A{VO@EIiUua" or phone == "r="
            out.append(phone + stress if vowel else phone)
            stress = "0" if vowel else stress
    return tuple(out)


def g2p_en() -> Predict | None:
    """The network of the package g2p-en, which was trained on CMUdict, these words too; None if it is
    missing.

    Its import asks for data that cannot be fetched and that its network does not need: stand-ins are given.
    """
    if importlib.util.find_spec("g2p_en") is None:
        return None
    names = ("nltk", "nltk.corpus", "nltk.tokenize", "inflect")
    before = {name: sys.modules.get(name) for name in names}
    for name in names:
        sys.modules[name] = types.ModuleType(name)
    nltk, corpus, tokenize, inflect = (sys.modules[name] for name in names)
    nltk.__dict__.update(pos_tag=None, corpus=corpus, data=types.SimpleNamespace(find=lambda path: path))
    corpus.__dict__.update(cmudict=types.SimpleNamespace(dict=dict))
    tokenize.__dict__.update(TweetTokenizer=lambda: types.SimpleNamespace(tokenize=str.split))
    inflect.__dict__.update(engine=lambda: None)
    try:
        from g2p_en import G2p

        network = G2p()
    finally:
        for name, module in before.items():
            if module is None:
                del sys.modules[name]
            else:
                sys.modules[name] = module
    return lambda word: tuple(token(phone) for phone in network.predict(word))
