"""The mouth as tied-state triphones move it: speech-enabled-avatars, section 4 and appendix B, piece by
piece.

A trajectory over a whole talk would be one large system of equations. Here each unit's instants are solved
for by themselves, with what lies a little before and after them: the kernel is too narrow for what is further
away to matter (the test says by how much). The cost is linear, and a unit needs the two after it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from fapstream.motion.questions import UNKNOWN, Context
from fapstream.motion.spline import STEP_S, Segments, Smoothness, observed, smooth
from fapstream.motion.trees import TiedStates
from fapstream.motion.units import SIL, TimedUnit

Floats = NDArray[np.float64]
State = tuple[tuple[float, Floats, Floats], ...]
"""Of a unit: the part of it that each state takes, precisions, and precisions times means."""

BEFORE, AFTER = 6, 8
"""Instants before and after a piece that take part."""
MOST_STATES = 4096
"""Units in context whose states are remembered: 160 kB for English news."""


class HmmMouth:
    """See `MouthModel`."""

    look_ahead = 2

    def __init__(self, states: TiedStates, how: Smoothness) -> None:
        self.n = states.mean.shape[1]
        self._states = states
        self._how = how
        self._state = lru_cache(MOST_STATES)(self._look_up)

    def parameters(self, units: Sequence[TimedUnit], at: int, first: int, n: int, rate: int) -> Floats:
        """See `MouthModel`."""
        begin = first - BEFORE
        end = min(first + n + AFTER, max(first + n, int(np.ceil(units[-1].end / rate / STEP_S))))
        mean, precision = observed(self._segments(units, at, rate, begin * STEP_S), begin, end - begin)
        return smooth(mean, precision, self._how)[first - begin : first - begin + n]

    def _segments(self, units: Sequence[TimedUnit], at: int, rate: int, begin: float) -> Segments:
        """The states from an instant (s) on to the last unit."""
        edges: list[float] = []
        rows: list[tuple[float, Floats, Floats]] = []
        start = at
        while start > 0 and units[start].start > begin * rate:
            start -= 1
        for i in range(start, len(units)):
            unit = units[i]
            found = self._state(_context(units, i))
            here, length = unit.start / rate, (unit.end - unit.start) / rate
            for state in found:
                edges.append(here)
                here += state[0] * length
            rows += found
        edges.append(units[-1].end / rate)
        bounds = np.array(edges)
        return Segments(
            bounds[:-1], bounds[1:], np.array([r[1] for r in rows]), np.array([r[2] for r in rows])
        )

    def _look_up(self, context: Context) -> State:
        states = self._states.states(context)
        precision = 1 / self._states.var[states]
        rows = zip(
            self._states.shares(states).tolist(),
            precision,
            precision * self._states.mean[states],
            strict=True,
        )
        return tuple(rows)


def _context(units: Sequence[TimedUnit], i: int) -> Context:
    """Silence lies around everything; what comes after the last unit, unless that is silence, is not
    known."""
    before = units[i - 1].name if i else SIL
    if i + 1 < len(units):
        return Context(before, units[i].name, units[i + 1].name)
    return Context(before, units[i].name, SIL if units[i].name == SIL else UNKNOWN)
