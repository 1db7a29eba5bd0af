"""Chance that can be asked again: numbers that follow from (seed, channel, index) and nothing else.

The web client computes the same numbers (clients/web/src/motion/chance.ts; protocol/vectors/life.json holds
both to it), so 32-bit integers only: MurmurHash3's finaliser (Appleby, public domain), once for each key.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from math import cos, exp, floor, log, pi, sqrt

_MASK = 0xFFFFFFFF


@lru_cache(maxsize=4096)
def bits(seed: int, channel: int, index: int) -> int:
    """32 bits."""
    return _stir(index + _stir(channel + _stir(seed)))


def _stir(key: int) -> int:
    h = (key + 0x9E3779B9) & _MASK
    h = ((h ^ (h >> 16)) * 0x85EBCA6B) & _MASK
    h = ((h ^ (h >> 13)) * 0xC2B2AE35) & _MASK
    return h ^ (h >> 16)


def uniform(seed: int, channel: int, index: int) -> float:
    """A number in [0, 1)."""
    return bits(seed, channel, index) / 2**32


@lru_cache(maxsize=4096)
def normal(seed: int, channel: int, index: int) -> float:
    """A number of mean 0 and variance 1 (Box and Muller 1958)."""
    radius = sqrt(-2.0 * log(1.0 - uniform(seed, channel, 2 * index)))
    return radius * cos(2.0 * pi * uniform(seed, channel, 2 * index + 1))


def log_normal(seed: int, channel: int, index: int, law: Mapping[str, float]) -> float:
    """A number whose logarithm is normal: `median`, `sigma`, kept within `least` and `most`."""
    value = law["median"] * exp(law["sigma"] * normal(seed, channel, index))
    return min(max(value, law["least"]), law["most"])


def noise(seed: int, channel: int, at: float) -> float:
    """Smooth noise within [-1, 1]: one random value at each integer, quintic between (Perlin 2002)."""
    cell = floor(at)
    x = at - cell
    a = 2.0 * uniform(seed, channel, cell & _MASK) - 1.0
    b = 2.0 * uniform(seed, channel, (cell + 1) & _MASK) - 1.0
    return a + (b - a) * minimum_jerk(x)


def minimum_jerk(x: float) -> float:
    """From 0 at 0 to 1 at 1, held beyond: how limbs, eyes and faces move (Flash and Hogan 1985)."""
    x = min(1.0, max(0.0, x))
    return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x)


class Events:
    """Instants in seconds, event k+1 following event k by gap(k); event 0 is one second before 0.

    Ask in order of time; going back is allowed and starts over.
    """

    def __init__(self, gap: Callable[[int], float]) -> None:
        self._gap = gap
        self._rewind()

    def _rewind(self) -> None:
        self._k, self._start = 0, -1.0
        self._next = self._start + self._gap(0)

    def at(self, t: float) -> tuple[int, float]:
        """The newest event at `t` >= -1 s: its number, and how long ago it was."""
        if t < self._start:
            self._rewind()
        while self._next <= t:
            self._k, self._start = self._k + 1, self._next
            self._next += self._gap(self._k)
        return self._k, t - self._start
