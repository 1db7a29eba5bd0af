"""From the player's reports to the sample being heard: the clock that the picture follows."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Literal

State = Literal["playing", "waiting", "starved", "paused", "over"]


@dataclass(frozen=True, slots=True)
class Heard:
    """What is heard. `sample` of the turn may lie between two; in every state but `playing` it stands."""

    turn: int
    sample: float
    state: State


@dataclass(frozen=True, slots=True)
class Report:
    """From frame `frame` of the card on, the turn is played from `sample`, or is in another state.

    `pace`: samples that go by in one frame; 1 but where a period is left out (2) or said twice (0).
    """

    state: State
    turn: int
    frame: int
    sample: int
    pace: int = 1


class HeardMap:
    """Reports in, what is heard at a frame out. Ask in order of frames."""

    def __init__(self) -> None:
        self._reports: deque[Report] = deque()

    def apply(self, report: Report) -> None:
        """What the player says; reports come in order."""
        self._reports.append(report)

    def at(self, frame: float) -> Heard | None:
        """What is heard at `frame`, which may lie between two; None before the first sound."""
        reports = self._reports
        while len(reports) > 1 and reports[1].frame <= frame:
            reports.popleft()
        if not reports or frame < reports[0].frame:
            return None
        report = reports[0]
        ahead = (frame - report.frame) * report.pace if report.state == "playing" else 0.0
        return Heard(report.turn, report.sample + ahead, report.state)
