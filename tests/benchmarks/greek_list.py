"""Greek words with broad IPA (WikiPron's format: word, tab, IPA) against what we or eSpeak NG say.

Both sides go through the one table `data/wikipron_el.tsv` and are compared whole, word by word:

strict  every phone as in one of the listed pronunciations;
merged  after mapping allophones to one phone (`merged`), the glide of a syllable-less i to i;
nasal   merged, and a nasal before a voiced stop may be there or not, which in Greek is free.
"""

from __future__ import annotations

import re
import subprocess
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from fapstream.tts.greek import greek
from fapstream.tts.spelling import fold_greek
from fapstream.tts.tables import phone_set

Phones = tuple[str, ...]
Listed = Mapping[str, list[Phones]]

VOWELS = frozenset("aeiou")
CONSONANTS = frozenset(phone_set("el")) - VOWELS - {"_"}
NASALS = frozenset("mn")
VOICED_STOPS = frozenset(("b", "d", "dz", "g"))
PALATAL = frozenset(("c", "gj", "C", "j"))
BACK = frozenset("aou")
AFFRICATES = {("t", "s"): "ts", ("d", "z"): "dz"}
CLASSES = ("palatal only", "synizesis only", "nasal before a voiced stop only", "s or z only", "other")


def _table() -> list[list[str]]:
    path = Path(__file__).parent / "data" / "wikipron_el.tsv"
    lines = path.read_text(encoding="utf-8").splitlines()
    return [line.split("\t") for line in lines if line and not line.startswith(";")]


IPA = {symbol: tuple(ours.split()) for symbol, ours, _ in _table()}
MERGED = {ours: same for _, ours, same in _table()}


def from_ipa(symbols: Iterable[str]) -> Phones:
    """The list's symbols as our phones; it writes affricates apart. Raises KeyError for an unknown symbol."""
    out: list[str] = []
    for phone in (phone for symbol in symbols for phone in IPA[symbol]):
        if out and (out[-1], phone) in AFFRICATES:
            out[-1] = AFFRICATES[out[-1], phone]
        else:
            out.append(phone)
    return tuple(out)


def read_list(path: Path) -> dict[str, list[Phones]]:
    """Every word of a list with all its pronunciations."""
    known: dict[str, list[Phones]] = defaultdict(list)
    for line in path.read_text(encoding="utf-8").splitlines():
        word, ipa = line.split("\t")
        known[word].append(from_ipa(ipa.split()))
    return dict(known)


def merged(phones: Phones) -> Phones:
    """Allophones as one phone, and the glide of an i that is no syllable as i."""
    out: list[str] = []
    for i, phone in enumerate(phones):
        following = phones[i + 1] if i + 1 < len(phones) else ""
        after_consonant = i > 0 and phones[i - 1] in CONSONANTS
        if phone in ("j", "C") and after_consonant and following in VOWELS:
            out.append("i")
            continue
        out.append(MERGED[phone])
        if (phone in "LJ" and following != "i") or (phone in PALATAL and following in BACK):
            out.append("i")
    return tuple(out)


def allophones(phones: Phones) -> Phones:
    """Allophones as one phone, glides left alone."""
    return tuple(MERGED[phone] for phone in phones)


def without_nasals(phones: Phones) -> Phones:
    """Merged, and no nasal before a voiced stop."""
    same = merged(phones)
    pairs = zip(same, (*same[1:], ""), strict=True)
    return tuple(p for p, following in pairs if p not in NASALS or following not in VOICED_STOPS)


def without_voice(phones: Phones) -> Phones:
    """Merged, and z as s."""
    return tuple({"z": "s", "dz": "ts"}.get(phone, phone) for phone in merged(phones))


@dataclass
class Score:
    """How many of `words` are right by each measure, and by class the words that are not strictly so."""

    words: int
    strict: int = 0
    merged: int = 0
    nasal: int = 0
    differences: dict[str, list[str]] = field(default_factory=lambda: {name: [] for name in CLASSES})

    def percent(self, measure: str) -> float:
        """`measure`: strict, merged or nasal."""
        return 100 * int(getattr(self, measure)) / self.words


def score(pronounced: Mapping[str, Phones], listed: Listed) -> Score:
    """`pronounced`: one pronunciation of every listed word, without stress."""
    result = Score(len(listed))
    for word, wanted in listed.items():
        ours = pronounced[word]
        result.strict += ours in wanted
        result.merged += _agree(merged, ours, wanted)
        result.nasal += _agree(without_nasals, ours, wanted)
        if ours not in wanted:
            result.differences[_difference(ours, wanted)].append(word)
    return result


def _agree(view: Callable[[Phones], Phones], ours: Phones, wanted: Iterable[Phones]) -> bool:
    return view(ours) in [view(w) for w in wanted]


def _difference(ours: Phones, wanted: list[Phones]) -> str:
    views = (allophones, merged, without_nasals, without_voice)
    return next((n for n, v in zip(CLASSES, views, strict=False) if _agree(v, ours, wanted)), CLASSES[-1])


def ours(words: Iterable[str]) -> dict[str, Phones]:
    """Our pronunciation of each word by itself."""
    return {w: tuple(token.rstrip("01") for token in greek().word(fold_greek(w))) for w in words}


def espeak(words: Iterable[str]) -> dict[str, Phones]:
    """eSpeak NG's, in one run of the command `espeak-ng`."""
    asked = list(words)
    command = ["espeak-ng", "-q", "-v", "el", "--ipa", "--sep=_"]
    done = subprocess.run(command, input="\n\n".join(asked), text=True, capture_output=True, check=True)
    lines = [line for line in done.stdout.splitlines() if line.strip()]
    symbols = [[s for s in re.split("[_ ]+", re.sub("[ˈˌ]", "", line)) if s] for line in lines]
    return {word: from_ipa(found) for word, found in zip(asked, symbols, strict=True)}
