"""How much sound has to be in store, from when packets arrive. Twin of clients/web/src/stream/jitter.ts.

Times are seconds; arrivals are counted on the card's own clock, for what matters is whether a packet is there
when the card fetches it. After the relative delay histograms of jitter buffers (Moon, Kurose and Towsley
1998), with two differences: what is held up together counts once, and what ran dry is believed at once.
"""

from __future__ import annotations

from bisect import bisect_left, insort
from collections import deque

FLOOR_S = 0.05
"""A packet and a little: with less in store a packet that is on time comes too late."""
MOST_S = 1.2
"""More is never waited for: a server sends at most 1.5 s ahead."""
WINDOW_S = 20.0
QUANTILE = 0.995
"""Of the lateness in the window. The latest alone does not count: one stall is no habit."""
GROW_S, MARGIN_S = 0.2, 0.02
"""One underrun lets the target grow by no more than this; and by so much more than what was missing."""
DECAY_S = 60.0
BURST = 0.5
"""A packet that comes within this part of its own duration after the one before waited with it."""
SLACK_S, LACK_S = 0.02, 0.005
"""A store may lie above and below the target by so much; together more than one pitch period."""


class Jitter:
    """Lateness of packets against the earliest ones, and `target_s`, which follows from it."""

    def __init__(self) -> None:
        self.target_s = FLOOR_S
        self._earliest: deque[tuple[float, float]] = deque()
        """(arrival, arrival - end), the second ascending: the first is the window's least."""
        self._events: deque[tuple[float, float]] = deque()
        """(arrival, lateness) of what came first in its burst."""
        self._sorted: list[float] = []
        self._last: tuple[float, float] | None = None
        self._eased: float | None = None

    def restart(self) -> None:
        """The sender's clock has been stopped or turned: what comes next is on time."""
        self._earliest.clear()
        self._last = None

    def observe(self, end_s: float, arrival_s: float) -> float:
        """A packet that was sent in real time ends at `end_s` of the talk. How late it is, s."""
        late = self._lateness(arrival_s, arrival_s - end_s)
        last, self._last = self._last, (end_s, arrival_s)
        if last is None or arrival_s - last[1] >= BURST * (end_s - last[0]):
            self._count(arrival_s, late)
        self.ease(arrival_s)
        return late

    def underrun(self, dry_s: float) -> None:
        """The sound had been dry for `dry_s` when it came: so much would just have been enough."""
        self.target_s = min(MOST_S, self.target_s + min(dry_s + MARGIN_S, GROW_S))

    def ease(self, now_s: float) -> None:
        """The target rises to what the window asks for, and comes down slowly."""
        aim = min(MOST_S, FLOOR_S + self._quantile())
        since = 0.0 if self._eased is None else max(0.0, now_s - self._eased)
        self._eased = now_s
        excess = self.target_s - aim
        self.target_s = aim if excess <= 0 else self.target_s - excess * min(1.0, since / DECAY_S)

    def _lateness(self, arrival: float, offset: float) -> float:
        earliest = self._earliest
        while earliest and earliest[-1][1] >= offset:
            earliest.pop()
        earliest.append((arrival, offset))
        while earliest[0][0] < arrival - WINDOW_S:
            earliest.popleft()
        return offset - earliest[0][1]

    def _count(self, arrival: float, late: float) -> None:
        self._events.append((arrival, late))
        insort(self._sorted, late)
        while self._events[0][0] < arrival - WINDOW_S:
            del self._sorted[bisect_left(self._sorted, self._events.popleft()[1])]

    def _quantile(self) -> float:
        return self._sorted[int(QUANTILE * (len(self._sorted) - 1))] if self._sorted else 0.0


def steer(level_s: float, target_s: float) -> int:
    """What a live talk's store wants: -1 to shrink, 1 to grow, 0 nothing.

    `level_s` is the store right after a packet plus that packet's lateness: no jitter is in it, so that it
    needs no smoothing, and only stretching, drifting clocks and lost time move it.
    """
    return int(level_s < target_s - LACK_S) - int(level_s > target_s + SLACK_S)
