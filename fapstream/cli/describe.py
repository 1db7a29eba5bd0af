"""Words as they are pronounced, for people and for programs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Any

from fapstream.records import Phone, Utterance, Word
from fapstream.tts import FrontEnd, phone_set, syllables

STRESS = {0: "", 1: "'", 2: ","}


def described(frontend: FrontEnd, utterances: Sequence[Utterance]) -> list[dict[str, Any]]:
    """The words that are spoken, in order, pauses left out.

    `word` as written, `spoken` as it is read, `path` where its phones come from (user, letter, lexicon, stem,
    compound, tree, rule), `phones` and `syllables`, each the number of the phone that it begins with.
    """
    return [
        {
            "word": word.text,
            "spoken": [" ".join(s) if isinstance(s, tuple) else s for s in word.spoken],
            "path": frontend.path(word),
            "syllables": _starts(phones, utterance.lang),
            "phones": [_phone(phone) for phone in phones],
        }
        for utterance in utterances
        for word, phones in _words(utterance)
    ]


def lines(words: Sequence[dict[str, Any]]) -> Iterator[str]:
    """Each word with its reading, then a line for each of its syllables: phones with durations, and pitch."""
    for word in words:
        total = sum(p["duration_ms"] for p in word["phones"])
        spoken = " ".join(word["spoken"])
        reading = "" if spoken == word["word"].lower() else f"  «{spoken}»"
        yield f"{word['word']:<20} {total:5.0f} ms  {word['path']}{reading}"
        edges = [*word["syllables"], len(word["phones"])]
        for first, end in pairwise(edges):
            syllable = word["phones"][first:end]
            mark = STRESS[max((p["stress"] for p in syllable), key=(0, 2, 1).index)]
            phones = " ".join(f"{p['phone']}:{p['duration_ms']:.0f}" for p in syllable)
            pitch = [hz for p in syllable for _, hz in p["pitch"]]
            f0 = (
                f"{pitch[0]:.0f}"
                + (f"-{max(pitch):.0f}" if max(pitch) > pitch[0] else "")
                + f"-{pitch[-1]:.0f}"
            )
            yield f"  {mark:>1} {phones:<40} {f0} Hz"


def _words(utterance: Utterance) -> Iterator[tuple[Word, list[Phone]]]:
    phones: list[list[Phone]] = [[] for _ in utterance.words]
    for phone in utterance.phones:
        if phone.word >= 0:
            phones[phone.word].append(phone)
    return zip(utterance.words, phones, strict=True)


def _starts(phones: Sequence[Phone], lang: str) -> list[int]:
    names = [phone.name for phone in phones]
    return syllables(names, [phone_set(lang)[name].kind == "vowel" for name in names], lang)


def _phone(phone: Phone) -> dict[str, Any]:
    pitch = [[round(percent, 1), round(hz, 1)] for percent, hz in phone.pitch]
    mean = round(sum(hz for _, hz in phone.pitch) / len(phone.pitch), 1) if phone.pitch else None
    return {
        "phone": phone.name,
        "duration_ms": round(phone.duration_ms, 1),
        "f0_hz": mean,
        "stress": phone.stress,
        "pitch": pitch,
    }
