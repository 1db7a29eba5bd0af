"""FAP values to vertices and normals for drawing: what `deform` does, in float32, for all parts at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from fapstream.head.deform import Values, rotation
from fapstream.head.mesh import Floats, Head, Part, Turn
from fapstream.head.normals import NormalField
from fapstream.head.ramps import Ramps


@dataclass(frozen=True, slots=True)
class Shape:
    """One part as it is now; `positions` and `normals` float32 (n, 3) are the same arrays for good."""

    part: Part
    positions: Floats
    normals: Floats


class Deformer:
    """Keeps the shapes of a head; `apply` moves them, `moved` names the parts that the last call changed.

    The vertices of all parts are numbered through; vectors are (3, n), a row for each of x, y, z, until they
    are handed out: numpy is quick on few long rows.
    """

    def __init__(self, head: Head) -> None:
        ends = list(accumulate(len(part.positions) for part in head.parts))
        self._spans = {
            part.name: slice(end - len(part.positions), end)
            for part, end in zip(head.parts, ends, strict=True)
        }
        self._ramps = Ramps(head.fat, {name: span.start for name, span in self._spans.items()})
        self._field = NormalField(head.parts, self._ramps.vertices)
        self._rest = np.ascontiguousarray(np.concatenate([part.positions for part in head.parts]).T)
        self._turns = [(turn, _areas(turn, self._spans)) for turn in head.turns]
        self.shapes = tuple(
            Shape(part, part.positions.copy(), self._field.rest[:, self._spans[part.name]].T.copy())
            for part in head.parts
        )
        self._away: set[str] = set()
        self.moved: frozenset[str] = frozenset()

    def apply(self, values: Values) -> None:
        """Put every part where the FAPs (68,), FAP n at n-1, want it."""
        amounts = self._ramps.amounts(values)
        away = self._ramps.moved(amounts)
        positions = self._rest.copy()
        if away:
            self._ramps.add(amounts, positions)
        normals = self._field.at(positions) if away else self._field.rest.copy()
        for turn, areas in self._turns:
            if any(values[fap - 1] for fap in turn.faps):
                _rotate(turn, values, areas, (positions, normals))
                away |= set(self._spans if turn.parts is None else turn.parts)
        self.moved, self._away = frozenset(away | self._away), away
        for shape in self.shapes:
            if shape.part.name in self.moved:
                shape.positions[:] = positions[:, self._spans[shape.part.name]].T
                shape.normals[:] = normals[:, self._spans[shape.part.name]].T


def head_turn(head: Head, values: Values) -> NDArray[np.float64]:
    """4x4: from where the file has the skull to where FAPs 48-50 put it; only turns of every part count."""
    matrix = np.eye(4)
    for turn in head.turns:
        if turn.parts is None:
            step, pivot = np.eye(4), np.asarray(turn.pivot)
            step[:3, :3] = rotation(turn, values)
            step[:3, 3] = pivot - step[:3, :3] @ pivot
            matrix = step @ matrix
    return matrix


def _areas(turn: Turn, spans: Mapping[str, slice]) -> list[tuple[slice, Floats]]:
    """What a turn takes along: stretches of the vertices, and how much of it each vertex follows."""
    weights = {
        name: turn.weights.get(name, np.ones(span.stop - span.start, np.float32))
        for name, span in spans.items()
    }
    if turn.parts is None:
        return [(slice(None), np.concatenate(list(weights.values())))]
    return [(spans[name], weights[name]) for name in turn.parts]


def _rotate(
    turn: Turn, values: Values, areas: list[tuple[slice, Floats]], vectors: tuple[Floats, Floats]
) -> None:
    """Turn (positions, normals) in place."""
    change = (rotation(turn, values) - np.eye(3)).astype(np.float32)
    pivot = np.asarray(turn.pivot, np.float32)[:, None]
    positions, normals = vectors
    for area, weights in areas:
        positions[:, area] += change @ (positions[:, area] - pivot) * weights
        normals[:, area] += change @ normals[:, area] * weights
