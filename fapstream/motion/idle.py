"""What a living face does unasked: blinks and small turns of the head. Seeded, a function of the sample."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fapstream.records import N_FAPS

UPPER_LIDS = (19, 20)
LOWER_LIDS = (21, 22)
UPPER_LID_CLOSED = 900
LOWER_LID_CLOSED = 124
"""Together 1024 IRISD units: the lids meet."""

BLINK_CLOSE_S, BLINK_SHUT_S, BLINK_OPEN_S = 0.08, 0.04, 0.16
BLINK_MEAN_S, BLINK_LEAST_S = 3.6, 1.2

HEAD_AMPLITUDE_RAD = {48: 0.018, 49: 0.028, 50: 0.012}
"""FAP 48 pitch, 49 yaw, 50 roll."""
AU = 1e-5
"""Radians per FAP unit of an angle."""


class IdleLife:
    """Blinks and head motion for one turn. Ask in order of time."""

    def __init__(self, seed: int, sample_rate: int) -> None:
        self._rng = np.random.default_rng(seed)
        self._sample_rate = sample_rate
        self._blink_s = float(self._rng.uniform(0.4, BLINK_MEAN_S))
        n = len(HEAD_AMPLITUDE_RAD)
        self._rates_hz = self._rng.uniform(0.07, 0.31, (n, 3))
        self._phases = self._rng.uniform(0, 2 * np.pi, (n, 3))

    def add_to(self, values: NDArray[np.float64], sample: int) -> None:
        """Add to the FAP values, shape (68,), that hold at `sample`."""
        assert values.shape == (N_FAPS,)
        t = sample / self._sample_rate
        closed = self._lid(t)
        for fap in UPPER_LIDS:
            values[fap - 1] += closed * (UPPER_LID_CLOSED - values[fap - 1])
        for fap in LOWER_LIDS:
            values[fap - 1] += closed * (LOWER_LID_CLOSED - values[fap - 1])
        sway = np.sin(2 * np.pi * self._rates_hz * t + self._phases).mean(axis=1)
        start = min(t, 1.0)
        for (fap, amplitude), s in zip(HEAD_AMPLITUDE_RAD.items(), sway, strict=True):
            values[fap - 1] += start * s * amplitude / AU

    def _lid(self, t: float) -> float:
        """How far the lids are shut at t seconds, 0 to 1."""
        while t > self._blink_s + BLINK_CLOSE_S + BLINK_SHUT_S + BLINK_OPEN_S:
            self._blink_s += BLINK_LEAST_S + float(self._rng.exponential(BLINK_MEAN_S - BLINK_LEAST_S))
        into = t - self._blink_s
        if into <= 0:
            return 0.0
        if into < BLINK_CLOSE_S:
            return _smooth(into / BLINK_CLOSE_S)
        return _smooth(1 - max(0.0, into - BLINK_CLOSE_S - BLINK_SHUT_S) / BLINK_OPEN_S)


def _smooth(x: float) -> float:
    return x * x * (3 - 2 * x)
