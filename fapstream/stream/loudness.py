"""The loudness that phones ask for, put on their sound."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from fapstream.records import Pcm, TimedPhone

RAMP_MS = 12.0
"""How long a change of gain takes from where a phone begins."""

KNEE, FULL = 26_000.0, 32_767.0
"""Samples beyond the knee are bent, so that none goes beyond full scale: nothing is cut off hard."""


class Loudness:
    """Gain over the samples of one turn. What nobody asked to change passes untouched."""

    def __init__(self, sample_rate: int) -> None:
        self._ramp = max(1, round(RAMP_MS * sample_rate / 1000.0))
        self._gain = 1.0
        self._points: deque[tuple[int, float]] = deque([(0, 1.0)])

    def add(self, phones: Iterable[TimedPhone]) -> None:
        """The next phones, in order, no later than their sound. Pauses keep the gain before them."""
        for timed in phones:
            gain = timed.phone.gain
            if gain != self._gain and timed.phone.word >= 0:
                start = max(timed.start, self._points[-1][0])
                self._points += [(start, self._gain), (start + self._ramp, gain)]
                self._gain = gain

    def apply(self, start: int, pcm: Pcm) -> Pcm:
        """The samples from `start` on at their gain; calls come in order."""
        while len(self._points) > 1 and self._points[1][0] <= start:
            self._points.popleft()
        if len(self._points) == 1 and self._gain == 1.0:
            return pcm
        at, gain = zip(*self._points, strict=True)
        louder = pcm * np.interp(np.arange(start, start + len(pcm)), at, gain)
        return np.rint(_bent(louder)).astype(np.int16)


def _bent(samples: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unchanged up to the knee, and from there ever closer to full scale."""
    size = np.abs(samples)
    if size.max(initial=0.0) <= KNEE:
        return samples
    room = FULL - KNEE
    over = KNEE + room * np.tanh((size - KNEE) / room)
    return np.where(size > KNEE, np.copysign(over, samples), samples)
