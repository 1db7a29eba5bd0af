"""Expressions over time: each comes softly, lasts under the phrase that follows it, and goes softly.

Smileys are silent phones that carry an expression (fpd-mpeg4-talking-head, section 4.2); there it ends with
its silence. Here it stays, weaker, until the next pause after speech, or for as long as a face keeps one up.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fapstream.fap import expressions
from fapstream.motion.chance import BACK_S, Real, minimum_jerk
from fapstream.records import N_FAPS, SILENCE, TimedPhone

COME_S, EBB_S, GO_S = 0.4, 0.6, 0.8
"""To come, to sink to what lasts, to go."""
LASTING = 0.65
"""What is left of it under speech."""
LONGEST_S = 5.0
"""It goes of itself so long after its smiley."""
PHRASE_END_S = 0.14
"""A pause of this length ends the phrase under which it lasts."""


@dataclass(slots=True)
class _Episode:
    name: str
    start: float
    end: float
    leave: float
    """When it begins to go, s."""

    def level(self, t: Real) -> Any:
        """0 to 1 at `t` seconds."""
        come = min(COME_S, max(1e-3, (self.end - self.start) / 2))
        ebb = 1.0 - (1.0 - LASTING) * minimum_jerk((t - self.end) / EBB_S)
        return minimum_jerk((t - self.start) / come) * ebb * (1.0 - minimum_jerk((t - self.leave) / GO_S))


class Feeling:
    """The expression stream of one turn. `add` phones in order, then ask for times that they have reached."""

    def __init__(self, sample_rate: int) -> None:
        self._rate = sample_rate
        self._episodes: deque[_Episode] = deque()
        self._spoke = False

    def add(self, timed: TimedPhone) -> None:
        """The next phone. What it ends, it ends from its own start on, and no earlier."""
        start, end = timed.start / self._rate, timed.end / self._rate
        name = timed.phone.expression
        if name:
            self._leave(start)
            self._episodes.append(_Episode(name, start, end, end + LONGEST_S))
            self._spoke = False
        elif timed.phone.name != SILENCE:
            self._spoke = True
        elif self._spoke and end - start >= PHRASE_END_S:
            self._leave(start)

    def cut(self, t: float) -> None:
        """What begins from `t` seconds on is void; what is there goes from then on."""
        while self._episodes and self._episodes[-1].start >= t:
            self._episodes.pop()
        self._leave(t)
        self._spoke = False

    def _leave(self, t: float) -> None:
        if self._episodes:
            self._episodes[-1].leave = min(self._episodes[-1].leave, t)

    def at(self, t: Real) -> NDArray[np.float64]:
        """FAPs (..., 68) at `t` seconds, FAP units; many instants ascend. Times go back by BACK_S at most."""
        first = np.ravel(t)[0]
        values = np.zeros((*np.shape(t), N_FAPS))
        while self._episodes and self._episodes[0].leave + GO_S < first - BACK_S:
            self._episodes.popleft()
        for episode in self._episodes:
            if first >= episode.leave + GO_S:
                continue
            values += np.multiply.outer(episode.level(t), expressions()[episode.name])
        return values
