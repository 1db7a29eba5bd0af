"""English phones as those of the CMU Pronouncing Dictionary, which recognisers know, and back."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from fapstream.tts.tables import phone_set, read_pairs

Phones = tuple[str, ...]
"""As in that dictionary, vowels with stress digits: `R EH1 K ER0 D`."""

VOWELS = frozenset(["AA", "AE", "AH", "AO", "AW", "AY", "EH", "ER", "EY", "IH", "IY", "OW", "OY", "UH", "UW"])
SCHWA, STRUT = "@", "V"
"""Both are AH there."""


def to_cmu(token: str) -> str:
    """`i1` -> `IY1`, `s` -> `S`, `_` -> `SIL`. Raises KeyError for what is no English phone."""
    stress = token[-1] if token[-1].isdigit() else ""
    return _table()[token.removesuffix(stress)] + stress


def from_cmu(name: str) -> tuple[str, int]:
    """`IY1` -> (`i`, 1), the SAMPA name and its stress. Raises KeyError for what is no CMU phone."""
    stress = int(name[-1]) if name[-1].isdigit() else 0
    plain = name.rstrip("012")
    if plain == "AH":
        return (STRUT if stress else SCHWA), stress
    return _back()[plain], stress


def stressed(plain: Sequence[str], readings: Sequence[Phones]) -> Phones:
    """Phones without stress digits with those of the reading that is most like them.

    They are matched by least edit distance, in which a vowel stands for a vowel more gladly than for
    nothing. A vowel that has no partner is unstressed.
    """
    matches = [_match(tuple(plain), reading) for reading in readings]
    _, stress = min(matches, key=lambda match: match[0], default=(0, {}))
    return tuple(name + stress.get(i, "0") if name in VOWELS else name for i, name in enumerate(plain))


def _match(plain: Phones, reading: Phones) -> tuple[int, dict[int, str]]:
    """The edit distance, and the stress digits by the index of their vowels."""
    row: list[tuple[int, dict[int, str]]] = [(2 * j, {}) for j in range(len(reading) + 1)]
    for i, name in enumerate(plain):
        above, row = row, [(2 * i + 2, {})]
        for j, other in enumerate(reading):
            cost, stress = above[j]
            vowels = name in VOWELS and other[-1].isdigit()
            if vowels:
                stress = {**stress, i: other[-1]}
            change = 0 if other.rstrip("012") == name else 1 if vowels else 3
            ways = [
                (cost + change, stress),
                (above[j + 1][0] + 2, above[j + 1][1]),
                (row[j][0] + 2, row[j][1]),
            ]
            row.append(min(ways, key=lambda way: way[0]))
    return row[-1]


@cache
def _table() -> dict[str, str]:
    """CMU phone by SAMPA name. Raises DataError."""
    return read_pairs("en/cmu.tsv")


@cache
def _back() -> dict[str, str]:
    return {cmu: name for name, cmu in _table().items() if name in phone_set("en")}
