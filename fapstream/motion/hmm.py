"""The mouth as tied-state triphones move it: speech-enabled-avatars, section 4 and appendix B, piece by
piece.

A trajectory over a whole talk would be one large system of equations. Here a few instants at a time are
solved for by themselves, with what lies a little before and after them: the kernel is too narrow for what is
further away to matter (the test says by how much). The cost is linear, and a unit needs the two after it: the
next one as a triphone.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import floor

import numpy as np
from numpy.typing import NDArray

from fapstream.motion.questions import Context
from fapstream.motion.spline import AFTER, AT_ONCE, BEFORE, STEP_S, Segments, Smoothness, observed, windowed
from fapstream.motion.trees import TiedStates
from fapstream.motion.units import SIL, TimedUnit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
State = tuple[int, float]
"""A leaf of the trees, and the part of its unit that the state takes."""

MOST_STATES = 4096
"""Units in context whose states are remembered: half of those of English news."""


class HmmMouth:
    """See `MouthModel`."""

    look_ahead = 2

    def __init__(self, states: TiedStates, how: Smoothness) -> None:
        self._states = states
        self._precision = 1 / states.var
        self._weighted = self._precision * states.mean
        self._how = how
        self._state = lru_cache(MOST_STATES)(self._look_up)

    def parameters(self, units: Sequence[TimedUnit], of: Ints, first: int, rate: int) -> Floats:
        """See `MouthModel`."""
        begin, n = first - BEFORE, len(of)
        last = min(int(of[-1]) + 1, len(units) - 1)
        segments = self._segments(units[: last + 2], last, rate, (begin - 0.5) * STEP_S)
        seen = observed(segments, begin, BEFORE + n + AT_ONCE + AFTER)
        starts = np.flatnonzero(_begins(of))
        # an instant of which a part lies beyond what is known is not known
        ends = [floor(units[min(unit + 1, last)].end / rate / STEP_S + 0.5) for unit in of[starts]]
        pieces = np.stack([starts + BEFORE, np.array(ends) - begin], axis=1)
        rows = windowed(seen, pieces, self._how)
        return rows[starts[:, None] + np.arange(AT_ONCE) < np.append(starts[1:], n)[:, None]]

    def _segments(self, units: Sequence[TimedUnit], last: int, rate: int, begin: float) -> Segments:
        """The states from an instant (s) on to the end of a unit."""
        start = last
        while start > 0 and units[start].start > begin * rate:
            start -= 1
        edges: list[float] = []
        leaves: list[int] = []
        for i in range(start, last + 1):
            unit = units[i]
            here, length = unit.start / rate, (unit.end - unit.start) / rate
            for leaf, share in self._state(_context(units, i)):
                leaves.append(leaf)
                edges.append(here)
                here += share * length
        edges.append(units[last].end / rate)
        bounds = np.array(edges)
        return Segments(bounds[:-1], bounds[1:], self._precision[leaves], self._weighted[leaves])

    def _look_up(self, context: Context) -> tuple[State, ...]:
        leaves = self._states.states(context)
        return tuple(zip(leaves.tolist(), self._states.shares(leaves).tolist(), strict=True))


def _begins(of: Ints) -> NDArray[np.bool_]:
    """Whether a piece begins at each instant: with each unit, and after AT_ONCE instants of it."""
    new = np.ones(len(of), np.bool_)
    np.not_equal(of[1:], of[:-1], out=new[1:])
    at = np.arange(len(of))
    since = at - np.maximum.accumulate(np.where(new, at, 0))
    return np.asarray(since % AT_ONCE == 0)


def _context(units: Sequence[TimedUnit], i: int) -> Context:
    """Silence lies around everything that is known."""
    before = units[i - 1].name if i else SIL
    return Context(before, units[i].name, units[i + 1].name if i + 1 < len(units) else SIL)
