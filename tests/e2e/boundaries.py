"""Boundaries found in the sound itself, to hold the marks against."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

VOICELESS_STOPS = frozenset("ptk")
VOWELS = frozenset(
    ["A", "{", "V", "O", "aU", "@", "AI", "E", "r=", "EI", "I", "i", "@U", "OI", "U", "u", "a", "e", "o"]
)
RANGE_DB = 60.0

Phone = tuple[str, int, int]
"""Name, first sample, one past the last."""


def level_db(pcm: NDArray[np.int16], rate: int, low: float, high: float) -> NDArray[np.float64]:
    """Smoothed level of a frequency band, one value a sample, never below RANGE_DB under its top."""
    band = sosfiltfilt(butter(3, [low, min(high, 0.45 * rate)], "band", fs=rate, output="sos"), pcm)
    window = np.hanning(int(0.008 * rate))
    power = np.convolve(band**2, window / window.sum(), "same")
    level = 10 * np.log10(power + 1e-3)
    return np.asarray(np.maximum(level, level.max() - RANGE_DB))


def offsets_ms(pcm: NDArray[np.int16], rate: int, phones: Sequence[Phone]) -> dict[str, list[float]]:
    """Heard minus marked, in ms, by kind of boundary.

    `vowel after silence`, `silence after vowel`: the level passes half-way (in dB) between the two sides.
    `stop`: voiceless stops between vowels close where the level above the voice bar, walked back from the
    quietest point of the closure, comes half-way up to the vowel. `vowel after stop`: the voice bar comes
    half-way up, walked on from there.
    """
    full, speech, voice = (level_db(pcm, rate, *band) for band in ((90, 7000), (500, 4000), (90, 400)))
    found: dict[str, list[float]] = {}

    def note(kind: str, heard: int, marked: int) -> None:
        found.setdefault(kind, []).append(1000 * (heard - marked) / rate)

    for (a, a0, a1), (b, b0, b1), (c, c0, c1) in zip(phones, phones[1:], phones[2:], strict=False):
        middle_a, middle_b, middle_c = (a0 + a1) // 2, (b0 + b1) // 2, (c0 + c1) // 2
        if a == "_" and b in VOWELS:
            start = max(a0, b0 - int(0.06 * rate))
            note("vowel after silence", _rises(full, start, middle_b), b0)
        if b in VOWELS and c == "_":
            end = min(c1, c0 + int(0.06 * rate))
            note("silence after vowel", _rises_backwards(full, end, middle_b), c0)
        if a in VOWELS and b in VOICELESS_STOPS and c in VOWELS:
            quiet = middle_a + int(np.argmin(speech[middle_a:middle_c]))
            note("stop", _rises_backwards(speech, quiet, middle_a), b0)
            note("vowel after stop", _rises(voice, quiet, middle_c), c0)
    return found


def _rises(level: NDArray[np.float64], start: int, end: int) -> int:
    """Where the level comes half-way up from its least to its most between `start` and `end`."""
    part = level[start:end]
    half = (part.min() + part.max()) / 2
    return start + int(np.argmax(part >= half))


def _rises_backwards(level: NDArray[np.float64], start: int, end: int) -> int:
    """The same, walking back from `start` to `end`, which lies before it."""
    return len(level) - _rises(level[::-1], len(level) - start, len(level) - end)
