"""How well recorded speech is aligned with its text, and understood without one.

usage: tools/bench align [--json] [--grid DIRECTORY] [--sentences N]

mbrola: its speech against the times it was told, by voice, and the word error rate of recognition.
refused: which part of right and wrong transcripts of GRID recordings is not taken for right: as they are,
through a telephone, with white noise, in a hall. wer: recognition of them, with the language model and with
GRID's grammar. --grid: their folder (flac/*.flac, phones.json, split.json); else there is only MBROLA.
"""

from __future__ import annotations

import argparse
import json
import random
from collections.abc import Callable, Sequence
from difflib import SequenceMatcher
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import resample_poly

from fapstream.adapters.aligner import Aligner
from fapstream.adapters.sound_file import read_sound
from fapstream.errors import ClipError
from fapstream.records import Heard, Pcm
from fapstream.tts.cmu import to_cmu
from tests.benchmarks.mbrola import say

VOICES = ("us1", "us2", "en1")
TEXT = Path(__file__).parent / "data" / "udhr_en.txt"
NEWS = [
    "The prime minister said on Tuesday that the government would publish its plans next week.",
    "Heavy rain fell over the mountains, and the rivers rose quickly.",
    "Scientists at the university have found a new way to store energy.",
    "Police said that nobody was hurt in the accident, which closed the road for two hours.",
    "The company paid five million dollars for the small firm.",
    "Oil prices fell to their lowest level in three years.",
    "The president will meet the leaders of six other countries in the spring.",
    "A fire destroyed part of the old city hall on Sunday night.",
    "Teachers and nurses are asking for higher pay.",
    "The court ruled that the law was against the constitution.",
    "More than a hundred people came to the opening of the new museum.",
    "The weather will stay warm and dry until the end of the week.",
]
GRAMMAR = """#JSGF V1.0; grammar grid;
public <s> = (bin | lay | place | set) (blue | green | red | white) (at | by | in | with)
(a(2) | b | c | d | e | f | g | h | i | j | k | l | m | n | o | p | q | r | s | t | u | v | x | y | z)
(zero | one | two | three | four | five | six | seven | eight | nine) (again | now | please | soon);
"""


def boundaries(heard: Heard, phones: Sequence[tuple[str, float]]) -> NDArray[np.float64]:
    """Found minus true begin of every phone that can be matched with one that was said, seconds."""
    true = [(to_cmu(name).rstrip("012"), at) for name, at in phones if name != "_"]
    found = [(p.name.rstrip("012"), p.start_s) for word in heard.words if word.text for p in word.phones]
    out: list[float] = []
    matcher = SequenceMatcher(None, [name for name, _ in true], [name for name, _ in found], autojunk=False)
    for kind, i, i_end, j, j_end in matcher.get_opcodes():
        if kind == "equal" or i_end - i == j_end - j:
            out += [b - a for (_, a), (_, b) in zip(true[i:i_end], found[j:j_end], strict=True)]
    return np.array(out)


def word_errors(said: Sequence[str], heard: Sequence[str]) -> int:
    """The edit distance."""
    row = list(range(len(heard) + 1))
    for i, word in enumerate(said, 1):
        above, row = row, [i]
        for j, other in enumerate(heard, 1):
            row.append(min(above[j - 1] + (word != other), above[j] + 1, row[j - 1] + 1))
    return row[-1]


def paragraphs(count: int) -> list[str]:
    """Of the Universal Declaration of Human Rights, those that are sentences."""
    return [p for p in TEXT.read_text(encoding="utf-8").split("\n\n") if 40 < len(p) < 260][:count]


def mbrola(count: int) -> dict[str, Any]:
    """Boundaries by voice, and the word error rate of the news."""
    aligner, table = Aligner(), {}
    for voice in VOICES:
        off = [
            boundaries(aligner.align(s.pcm, p), s.phones) for p in paragraphs(count) for s in [say(voice, p)]
        ]
        ms = 1000 * np.abs(np.concatenate(off))
        table[voice] = {
            "n": len(ms),
            "within_20_ms": round(float((ms <= 20).mean()), 3),
            "mean_ms": round(float(ms.mean()), 1),
            "news_wer": rate([(plain(text), heard(aligner, say(voice, text).pcm)) for text in NEWS]),
        }
    return table


def plain(text: str) -> list[str]:
    return text.lower().replace(",", "").replace(".", "").split()


def heard(aligner: Aligner, pcm: Pcm) -> list[str]:
    """The words recognised, none where that failed."""
    try:
        return [word.text.rstrip(".") for word in aligner.recognise(pcm).words if word.text]
    except ClipError:
        return []


def rate(pairs: Sequence[tuple[list[str], list[str]]]) -> float:
    return round(sum(word_errors(*pair) for pair in pairs) / sum(len(said) for said, _ in pairs), 3)


# GRID


def telephone(pcm: Pcm) -> Pcm:
    return _int16(resample_poly(resample_poly(pcm.astype(float), 1, 2), 2, 1))


def noisy(db: float) -> Callable[[Pcm], Pcm]:
    def add(pcm: Pcm) -> Pcm:
        noise = np.random.default_rng(0).standard_normal(len(pcm))
        return _int16(pcm + noise * np.sqrt((pcm.astype(float) ** 2).mean()) * 10 ** (-db / 20))

    return add


def hall(pcm: Pcm) -> Pcm:
    """An echo of noise that dies away by 60 dB in 0.55 s."""
    n = 6400
    echo = np.random.default_rng(0).standard_normal(n) * np.exp(-np.arange(n) / 1280) / 8
    echo[0] = 1
    return _int16(0.7 * np.convolve(pcm, echo)[: len(pcm)])


def _int16(sound: NDArray[np.float64]) -> Pcm:
    return np.clip(sound, -32768, 32767).astype(np.int16)


CONDITIONS: dict[str, Callable[[Pcm], Pcm]] = {
    "as it is": lambda pcm: pcm,
    "telephone": telephone,
    "noise 20 dB": noisy(20),
    "noise 10 dB": noisy(10),
    "hall": hall,
}


def refused(clips: dict[str, list[str]], sounds: dict[str, Pcm]) -> dict[str, Any]:
    """Shares of the transcripts that are not accepted."""
    aligner, table = Aligner(), {}
    for condition, change in CONDITIONS.items():
        rng, counts = random.Random(1), {}
        for name, words in clips.items():
            sound = change(sounds[name])
            for kind, text in transcripts(words, list(clips.values()), rng).items():
                counts.setdefault(kind, []).append(not accepted(aligner, sound, text))
        table[condition] = {kind: round(float(np.mean(made)), 3) for kind, made in counts.items()}
    return table


def transcripts(words: list[str], all_words: list[list[str]], rng: random.Random) -> dict[str, list[str]]:
    """By kind. `like`: another sentence of GRID, of which a third of the words are the same, on average."""
    at, word = rng.randrange(len(words)), rng.choice(plain(" ".join(NEWS)))
    return {
        "right": words,
        "a word wrong": [*words[:at], word, *words[at + 1 :]],
        "a word less": [*words[:at], *words[at + 1 :]],
        "a word more": [*words[:at], word, *words[at:]],
        "half": words[:3],
        "like": rng.choice([other for other in all_words if other != words]),
        "other": plain(rng.choice(NEWS))[: len(words)],
        "twice": words + words,
    }


def accepted(aligner: Aligner, sound: Pcm, words: Sequence[str]) -> bool:
    try:
        aligner.align(sound, " ".join(words))
    except ClipError:
        return False
    return True


def by_grammar(sounds: dict[str, Pcm]) -> dict[str, list[str]]:
    """The words of each clip as GRID's grammar lets them be understood."""
    from pocketsphinx import Decoder

    letters = GRAMMAR.split("\n")[2].strip("() ").replace("a(2)", "a").split(" | ")
    decoder = Decoder(lm=None, bestpath=False, loglevel="FATAL")
    grammar = GRAMMAR
    for letter in letters:
        grammar = grammar.replace(f"({letter}(2) | b", f"(letter_{letter} | b").replace(
            f"| {letter} ", f"| letter_{letter} "
        )
        phones = decoder.lookup_word(f"{letter}.") or decoder.lookup_word(letter)
        decoder.add_word(f"letter_{letter}", "EY" if letter == "a" else phones)
    decoder.add_jsgf_string("grid", grammar)
    decoder.activate_search("grid")
    found = {}
    for name, sound in sounds.items():
        decoder.start_utt()
        decoder.process_raw(sound.tobytes(), full_utt=True)
        decoder.end_utt()
        text = decoder.hyp().hypstr if decoder.hyp() else ""
        found[name] = [word.removeprefix("letter_").partition("(")[0] for word in text.split()]
    return found


def grid(folder: Path, count: int) -> dict[str, Any]:
    """The tables of the development sentences."""
    aligned = json.loads((folder / "phones.json").read_text(encoding="utf-8"))
    names = json.loads((folder / "split.json").read_text(encoding="utf-8"))["dev"][:count]
    clips = {name: [w[0].partition("(")[0] for w in aligned[name] if w[0] != "<sil>"] for name in names}
    written = {name: [w.upper() if len(w) == 1 else w for w in words] for name, words in clips.items()}
    sounds = {name: read_sound(folder / "flac" / f"{name}.flac") for name in names}
    aligner, strict = Aligner(), by_grammar(sounds)
    return {
        "refused": refused(written, sounds),
        "wer": rate([(clips[name], heard(aligner, sounds[name])) for name in names]),
        "wer_with_grammar": rate([(clips[name], strict[name]) for name in names]),
    }


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--grid", type=Path, metavar="DIRECTORY")
    parser.add_argument("--sentences", type=int, default=100)
    args = parser.parse_args()
    figures: dict[str, Any] = {"mbrola": mbrola(min(args.sentences, 30))}
    if args.grid:
        figures["grid"] = grid(args.grid, args.sentences)
    print(json.dumps(figures, indent=None if args.json else 2))


if __name__ == "__main__":
    main()
