"""All face animation tables of a head as one sum.

A piecewise linear table is a sum of ramps: on each stretch between two neighbouring knots its displacement
grows by a slope times how far the drive has come on that stretch. What is left to do for a frame is one clip,
one product and one sum over rows sorted by vertex, without a loop over tables.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fapstream.head.deform import Values
from fapstream.head.mesh import FatEntry, Floats
from fapstream.records import N_FAPS


class Ramps:
    """The tables `fat` of parts whose vertices begin at `starts` in one list of all vertices."""

    def __init__(self, fat: Sequence[FatEntry], starts: Mapping[str, int]) -> None:
        self._drives = np.zeros((len(fat), N_FAPS))
        for row, entry in zip(self._drives, fat, strict=True):
            for fap, coefficient in entry.drive:
                row[fap - 1] += coefficient
        ramps = [(e, *ends) for e, entry in enumerate(fat) for ends in pairwise(_ends(entry))]
        self._entry = np.array([e for e, _, _ in ramps], np.intp)
        self._low, self._high = (np.array([ramp[k] for ramp in ramps], float) for k in (1, 2))
        self._rest = np.clip(0.0, self._low, self._high)
        self._parts = [fat[e].part for e in self._entry]
        self._sort(fat, [fat[e].indices.astype(np.intp) + starts[fat[e].part] for e in self._entry])

    def _sort(self, fat: Sequence[FatEntry], vertices: Sequence[NDArray[np.intp]]) -> None:
        """Lay out by vertex what each ramp does to each of its `vertices`."""
        none, nowhere = np.empty((0, 3), np.float32), np.empty(0, np.intp)
        slopes = np.concatenate([none, *(_slopes(entry) for entry in fat)])
        ramps = np.repeat(np.arange(len(vertices)), [len(row) for row in vertices])
        every = np.concatenate([nowhere, *vertices])
        order = np.flatnonzero(slopes.any(axis=1))
        order = order[np.argsort(every[order], kind="stable")]
        self._ramps, self._slopes = ramps[order], np.ascontiguousarray(slopes[order].T)
        self._starts = np.flatnonzero(np.diff(every[order], prepend=-1))
        self.vertices: NDArray[np.intp] = every[order][self._starts]
        """The vertices that can move, ascending (k,)."""

    def amounts(self, values: Values) -> NDArray[np.float64]:
        """How far the FAPs (68,), FAP n at n-1, have come along each ramp: (r,), in units of its drive."""
        drives = (self._drives @ values)[self._entry]
        amounts: NDArray[np.float64] = np.clip(drives, self._low, self._high) - self._rest
        return amounts

    def moved(self, amounts: NDArray[np.float64]) -> set[str]:
        """The names of the parts that `amounts` move."""
        return {self._parts[ramp] for ramp in np.flatnonzero(amounts)}

    def add(self, amounts: NDArray[np.float64], positions: Floats) -> None:
        """Move the vertices, float32 (3, n), metres, in place."""
        moves = self._slopes * amounts.astype(np.float32)[self._ramps]
        for row, move in zip(positions, np.add.reduceat(moves, self._starts, axis=1), strict=True):
            row[self.vertices] += move


def _ends(entry: FatEntry) -> tuple[float, ...]:
    """Where the ramps of a table meet: its knots and 0; the outermost ramps go on for ever."""
    return -np.inf, *sorted((*entry.knots, 0.0))[1:-1], np.inf


def _slopes(entry: FatEntry) -> Floats:
    """Metres per unit of the drive, by ramp and vertex: (k * n, 3)."""
    stretches = np.diff(sorted((*entry.knots, 0.0)))
    zero = int(np.searchsorted(entry.knots, 0.0))
    steps = np.diff(np.insert(entry.deltas.astype(float), zero, 0.0, axis=0), axis=0)
    slopes = steps * (entry.scale / stretches)[:, None, None]
    return slopes.reshape(-1, 3).astype(np.float32)
