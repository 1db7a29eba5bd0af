"""The phones of a language as the duration and melody rules see them, and how they group into syllables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

from fapstream.tts.tables import phone_set, read_rows

LEAST: Final = 0.8
"""Share of its minimum that a phone keeps in any case."""
STRESSES = ("0", "1", "2")


@dataclass(frozen=True, slots=True)
class Sound:
    """A token of a pronunciation: a phone, and if it is a vowel its stress (0 none, 1 primary, 2 secondary).

    `min_ms` is what cannot be compressed, `span_ms` what the rules act on: mean minus minimum.
    """

    name: str
    stress: int
    vowel: bool
    voiced: bool
    kind: str
    min_ms: float
    span_ms: float
    least_ms: float
    """No rule makes it shorter at rate 1."""


def sounds(lang: str, means: Mapping[str, float]) -> dict[str, Sound]:
    """Every token of the language: `i1` for the vowel i with primary stress, `s` for a consonant.

    `means`: the mean durations, ms, of phones whose own is not to count.
    """
    found = {}
    for name, info in phone_set(lang).items():
        vowel, mean = info.kind == "vowel", means.get(name, info.mean_ms)
        least = min(info.min_ms, mean)
        for digit in STRESSES if vowel else ("",):
            found[name + digit] = Sound(
                name, int(digit or 0), vowel, info.voiced, info.kind, least, mean - least, LEAST * least
            )
    return found


@cache
def onsets(lang: str) -> frozenset[tuple[str, str]]:
    """Pairs of consonants that can begin a syllable, from `data/<lang>/onsets.tsv`."""
    return frozenset(
        (first, second)
        for _, (first, seconds) in read_rows(f"{lang}/onsets.tsv", 2)
        for second in seconds.split()
    )


def syllables(names: Sequence[str], vowels: Sequence[bool], lang: str) -> list[int]:
    """Where each syllable of a word begins: as many consonants as can stand there go before a vowel.

    `names` are phones and `vowels` says which of them are syllable nuclei, both of shape (n,). The first
    syllable begins at 0; a word without a vowel is one syllable.
    """
    legal = onsets(lang)
    starts = []
    for i, vowel in enumerate(vowels):
        if vowel:
            at = i
            while at and not vowels[at - 1] and (at == i or (names[at - 1], names[at]) in legal):
                at -= 1
            starts.append(at)
    return [0, *starts[1:]]
