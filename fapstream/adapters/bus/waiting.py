"""A queue that never grows beyond its bounds: what is oldest in it goes."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic
from typing import Generic, TypeVar

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Bounds:
    """How much may wait."""

    entries: int
    size: int
    """Bytes."""
    age_s: float = math.inf
    """What has waited for longer is not worth sending any more."""


OUTBOX = Bounds(1 << 16, 16_000_000, age_s=4.0)
"""For what waits to be sent. Who has not read for as long as a backlog lasts needs only the live edge."""


class Waiting(Generic[T]):
    """Things in order, each with its size in bytes.

    When a bound is passed the older half goes at once: one wide gap is less harm than many small ones.
    """

    def __init__(self, bounds: Bounds, now: Callable[[], float] = monotonic) -> None:
        self._bounds = bounds
        self._now = now
        self._things: deque[tuple[T, int, float]] = deque()
        self._size = 0

    def __len__(self) -> int:
        return len(self._things)

    def put(self, thing: T, size: int) -> bool:
        """Add one. Whether others had to go for it."""
        self._things.append((thing, size, self._now()))
        self._size += size
        if len(self._things) <= self._bounds.entries and self._size <= self._bounds.size:
            return False
        before = len(self._things)
        while len(self._things) > 1 and (
            len(self._things) > self._bounds.entries // 2 or self._size > self._bounds.size // 2
        ):
            self.pop()
        return len(self._things) < before

    def pop(self) -> T:
        """The oldest. Raises IndexError when there is none."""
        thing, size, _ = self._things.popleft()
        self._size -= size
        return thing

    def take(self, size: int) -> list[T]:
        """The oldest of about that size together, at least one if there is any; the stale are skipped."""
        oldest = self._now() - self._bounds.age_s
        while self._things and self._things[0][2] < oldest:
            self.pop()
        taken: list[T] = []
        while self._things and (size > 0 or not taken):
            size -= self._things[0][1]
            taken.append(self.pop())
        return taken

    def clear(self) -> None:
        """Drop everything."""
        self._things.clear()
        self._size = 0
