"""Time-stretch by whole pitch periods, without changing the pitch. Twin of clients/web/src/stream/stretch.ts.

One period is left out, or said twice, under a cross-fade (WSOLA: Verhelst and Roelands 1993). Sound is float,
full scale 1, at `rate` Hz.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Sound = NDArray[np.float64]

SHORTEST_S, LONGEST_S = 0.0025, 0.015
"""Of a pitch period: 400 to 67 Hz."""
LEAST_COMPARED_S = 0.0125
"""Shorter stretches are alike by chance, within the ringing of a formant."""
COARSE_HZ = 8000
"""Periods are first sought at this rate."""
ALIKE = 0.9
"""Correlation from which two periods may stand for each other."""
VOICED = 0.5
"""Correlation from which a sound is continued as a voice rather than as noise."""
QUIET = 0.004
"""Root mean square of a pause: -48 dB of full scale."""
NOISE_FALL_S = 0.012
"""Noise that is repeated would buzz: it falls faster than a voice."""
DECAY_S = 0.0014
"""A step dies away with this time constant."""


def periods(rate: int) -> tuple[int, int]:
    """The shortest and the longest period in samples."""
    return round(SHORTEST_S * rate), round(LONGEST_S * rate)


def is_quiet(sound: Sound) -> bool:
    """Is there nothing in it that anyone would miss?"""
    return float(sound @ sound) <= QUIET * QUIET * len(sound)


def likeness(sound: Sound, at: int, other: int, n: int) -> float:
    """Normalised cross-correlation of n samples at `at` and at `other`; 0 if one of them is silent."""
    a, b = sound[at : at + n], sound[other : other + n]
    power = float(a @ a) * float(b @ b)
    return float(a @ b) / power**0.5 if power > 1e-12 else 0.0


def period(sound: Sound, at: int, way: int, rate: int) -> tuple[int, float]:
    """The lag (samples) at which sound[at:at+lag] is most like what lies `lag` ahead (way 1) or back (-1).

    And that likeness; (0, 0.0) if there is too little sound to tell.
    """
    least, most = periods(rate)
    window = round(LEAST_COMPARED_S * rate)
    ahead = len(sound) - at
    most = (
        min(most, ahead - window, ahead // 2) if way > 0 else min(most, ahead if ahead >= window else 0, at)
    )
    if most < least:
        return 0, 0.0
    step = max(1, rate // COARSE_HZ)
    near, _ = _best(
        sound[at % step :: step], at // step, way, range(least // step, most // step + 1), window // step
    )
    lags = range(max(least, step * (near - 1)), min(most, step * (near + 1)) + 1)
    return _best(sound, at, way, lags, window)


def _best(sound: Sound, at: int, way: int, lags: range, window: int) -> tuple[int, float]:
    """The first of the lags with the greatest likeness, and that."""
    alike = [likeness(sound, at, at + way * lag, max(lag, window)) for lag in lags]
    best = int(np.argmax(alike))
    return lags[best], alike[best]


def fade(old: Sound, new: Sound, done: int = 0, length: int | None = None) -> Sound:
    """From `old` to `new`, both of one length, along a straight line: what is alike keeps its strength.

    They may be a part of a fade of that `length`, of which so much was `done` before.
    """
    share = np.arange(done + 1, done + len(old) + 1) / ((length or len(old)) + 1)
    return old + (new - old) * share


def fall(past: Sound, rate: int, seconds: float) -> Sound:
    """What follows `past` when the sound breaks off: its last period again and again, dying away.

    Joins without a step and ends in silence after `seconds`, or earlier if it is noise.
    """
    _, longest = periods(rate)
    if len(past) < 2 * longest or is_quiet(past[-2 * longest :]):
        return _decay(past, rate)
    lag, alike = period(past[::-1], 0, 1, rate)
    if alike < VOICED:
        lag, seconds = longest, min(seconds, NOISE_FALL_S)
    n = round(seconds * rate)
    again = np.resize(_loop(past, lag), n)
    step = past[-1] - past[-lag - 1]
    again += step * np.exp(-np.arange(1, n + 1) / (DECAY_S * rate))
    sunk: Sound = again * (0.5 + 0.5 * np.cos(np.pi * np.arange(1, n + 1) / n))
    return sunk


def _decay(past: Sound, rate: int) -> Sound:
    """From the last value to 0."""
    n = round(8 * DECAY_S * rate)
    last = past[-1] if len(past) else 0.0
    gone: Sound = last * np.exp(-np.arange(1, n + 1) / (DECAY_S * rate))
    return gone


def _loop(past: Sound, lag: int) -> Sound:
    """The last `lag` samples, whose end goes over into what came before their beginning."""
    loop = past[-lag:].copy()
    n = min(lag // 4, len(past) - lag)
    if n:
        loop[-n:] = fade(loop[-n:], past[len(past) - lag - n : len(past) - lag])
    return loop
