"""Chance that can be asked again: numbers that follow from (seed, channel, index) and nothing else.

The web client computes the same numbers (clients/web/src/motion/chance.ts; protocol/vectors/life.json holds
both to it), so 32-bit integers only: MurmurHash3's finaliser (Appleby, public domain), once for each key.
Every index and instant may be one number or an array of them; what comes back has the same shape.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import deque
from collections.abc import Callable, Mapping
from functools import lru_cache
from math import floor, pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

Real = float | NDArray[np.float64]
Whole = int | NDArray[np.int64]

_MASK = 0xFFFFFFFF


def bits(seed: int, channel: Whole, index: Whole) -> Any:
    """32 bits."""
    return _stir(index + (_key(seed, channel) if isinstance(channel, int) else _stir(channel + _stir(seed))))


@lru_cache(maxsize=4096)
def _key(seed: int, channel: int) -> int:
    return int(_stir(channel + _stir(seed)))


def _stir(key: Any) -> Any:
    """A product beyond 63 bits wraps in an array; the 32 bits that count are the same."""
    h = (key + 0x9E3779B9) & _MASK
    h = ((h ^ (h >> 16)) * 0x85EBCA6B) & _MASK
    h = ((h ^ (h >> 13)) * 0xC2B2AE35) & _MASK
    return h ^ (h >> 16)


def uniform(seed: int, channel: Whole, index: Whole) -> Any:
    """A number in [0, 1)."""
    return bits(seed, channel, index) / 2**32


def normal(seed: int, channel: int, index: Whole) -> Any:
    """A number of mean 0 and variance 1 (Box and Muller 1958)."""
    radius = np.sqrt(-2.0 * np.log(1.0 - uniform(seed, channel, 2 * index)))
    return radius * np.cos(2.0 * pi * uniform(seed, channel, 2 * index + 1))


def log_normal(seed: int, channel: int, index: Whole, law: Mapping[str, float]) -> Any:
    """A number whose logarithm is normal: `median`, `sigma`, kept within `least` and `most`."""
    value = law["median"] * np.exp(law["sigma"] * normal(seed, channel, index))
    return np.minimum(np.maximum(value, law["least"]), law["most"])


def noise(seed: int, channel: Whole, at: Real) -> Any:
    """Smooth noise within [-1, 1]: one random value at each integer, quintic between (Perlin 2002)."""
    cell: Any = floor(at) if isinstance(at, (int, float)) else np.floor(at).astype(np.int64)
    a = 2.0 * uniform(seed, channel, cell & _MASK) - 1.0
    b = 2.0 * uniform(seed, channel, (cell + 1) & _MASK) - 1.0
    return a + (b - a) * minimum_jerk(at - cell)


def minimum_jerk(x: Real) -> Any:
    """From 0 at 0 to 1 at 1, held beyond: how limbs, eyes and faces move (Flash and Hogan 1985)."""
    alone = isinstance(x, (int, float))  # then Python's own are five times as fast
    x = min(1.0, max(0.0, x)) if alone else np.minimum(1.0, np.maximum(0.0, x))
    return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)


BACK_S = 5.0
"""What happened is remembered so long, for those who go back."""


class Events:
    """Instants in seconds, event k+1 following event k by gap(k); event 0 is one second before 0.

    Ask in order of time; going back is allowed, and far back starts over.
    """

    def __init__(self, gap: Callable[[int], float]) -> None:
        self._gap = gap
        self._rewind()

    def _rewind(self) -> None:
        self._first = 0
        self._starts = deque([-1.0])
        self._next = -1.0 + float(self._gap(0))

    def at(self, t: Real) -> tuple[Any, Any]:
        """The newest event at `t` >= -1 s, ascending: its number, and how long ago it was."""
        alone = isinstance(t, (int, float))
        first, last = (t, t) if alone else (t[0], t[-1])  # type: ignore[index]
        if first < self._starts[0]:
            self._rewind()
        while self._next <= last:
            self._starts.append(self._next)
            self._next += float(self._gap(self._first + len(self._starts) - 1))
        while len(self._starts) > 1 and self._starts[1] <= first - BACK_S:
            self._starts.popleft()
            self._first += 1
        if alone:
            k: Any = bisect_right(self._starts, t) - 1
            return self._first + k, t - self._starts[k]
        starts = np.array(self._starts)
        k = np.searchsorted(starts, t, side="right") - 1
        return self._first + k, t - starts[k]
