"""speech-enabled-avatars, Table 1: the phones of "security" and where they begin, in milliseconds."""

from __future__ import annotations

from itertools import pairwise

from fapstream.motion.units import SIL, TimedUnit

RATE = 16000
PHONES = ("S", "IH0", "K", "Y", "UW1", "R", "IH0", "T", "IY0")
STARTS_MS = (0, 100, 160, 240, 290, 320, 390, 440, 520)
LAST_MS = 100
"""The table does not say when the last one ends."""
BEFORE_MS = 200
"""It is spoken after so much silence here."""


def units(silence: bool = True) -> list[TimedUnit]:
    """The word between two silences, or by itself."""
    edges = [BEFORE_MS + ms for ms in (*STARTS_MS, STARTS_MS[-1] + LAST_MS)]
    per_ms = RATE // 1000
    word = [
        TimedUnit(name, a * per_ms, b * per_ms) for name, (a, b) in zip(PHONES, pairwise(edges), strict=True)
    ]
    if not silence:
        return word
    end = word[-1].end
    return [TimedUnit(SIL, 0, word[0].start), *word, TimedUnit(SIL, end, end + 300 * per_ms)]
