"""FAP values to vertices and normals for drawing: what `deform` does, in float32, in place and prepared."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fapstream.head.deform import Values, drive_value, knot_shares, rotation
from fapstream.head.mesh import FatEntry, Floats, Head, Part, Turn
from fapstream.head.normals import NormalField


@dataclass(frozen=True, slots=True)
class Shape:
    """One part as it is now; `positions` and `normals` float32 (n, 3) are the same arrays for good."""

    part: Part
    positions: Floats
    normals: Floats


class Deformer:
    """Keeps the shapes of a head; `apply` moves them, `moved` names the parts that the last call changed."""

    def __init__(self, head: Head) -> None:
        self._head = head
        self._fields = {part.name: NormalField(part, _movable(head, part.name)) for part in head.parts}
        self.shapes = tuple(
            Shape(part, part.positions.copy(), self._fields[part.name].rest.copy()) for part in head.parts
        )
        self._by_name = {shape.part.name: shape for shape in self.shapes}
        self._deltas = [entry.deltas * np.float32(entry.scale) for entry in head.fat]
        self._away: set[str] = set()
        self.moved: frozenset[str] = frozenset()

    def apply(self, values: Values | NDArray[np.float64]) -> None:
        """Put every part where the FAPs (68,), FAP n at n-1, want it."""
        away = self._away
        for name in away:
            self._by_name[name].positions[:] = self._by_name[name].part.positions
        bent = self._bend(values)
        for name in away | bent:
            shape, field = self._by_name[name], self._fields[name]
            if name in bent:
                field.write(shape.positions, shape.normals)
            else:
                shape.normals[:] = field.rest
        turned: set[str] = set()
        for turn in self._head.turns:
            if any(values[fap - 1] for fap in turn.faps):
                turned |= self._turn(turn, values)
        self._away = bent | turned
        self.moved = frozenset(away | self._away)

    def _bend(self, values: Values | NDArray[np.float64]) -> set[str]:
        """Add what the tables want; the names of the parts that they moved."""
        bent = set()
        for entry, deltas in zip(self._head.fat, self._deltas, strict=True):
            value = drive_value(entry, values)
            if value:
                self._by_name[entry.part].positions[entry.indices] += _displacement(entry, deltas, value)
                bent.add(entry.part)
        return bent

    def _turn(self, turn: Turn, values: Values | NDArray[np.float64]) -> set[str]:
        change = (rotation(turn, values) - np.eye(3)).T.astype(np.float32)
        pivot = np.asarray(turn.pivot, np.float32)
        names: Sequence[str] = list(self._by_name) if turn.parts is None else turn.parts
        for name in names:
            shape = self._by_name[name]
            moves, turns = (shape.positions - pivot) @ change, shape.normals @ change
            if name in turn.weights:
                weights = turn.weights[name][:, None]
                moves, turns = moves * weights, turns * weights
            np.add(shape.positions, moves, out=shape.positions)
            np.add(shape.normals, turns, out=shape.normals)
        return set(names)


def head_turn(head: Head, values: Values | NDArray[np.float64]) -> NDArray[np.float64]:
    """4x4: from where the file has the skull to where FAPs 48-50 put it; only turns of every part count."""
    matrix = np.eye(4)
    for turn in head.turns:
        if turn.parts is None:
            step, pivot = np.eye(4), np.asarray(turn.pivot)
            step[:3, :3] = rotation(turn, values)
            step[:3, 3] = pivot - step[:3, :3] @ pivot
            matrix = step @ matrix
    return matrix


def _movable(head: Head, part: str) -> list[NDArray[np.uint32]]:
    return [entry.indices for entry in head.fat if entry.part == part]


def _displacement(entry: FatEntry, deltas: Floats, value: float) -> Floats:
    """`deltas` float32 (k, n, 3) in metres at the entry's knots, at one value of its drive: (n, 3)."""
    shares = knot_shares(entry.knots, value)
    parts = [deltas[knot] * np.float32(share) for knot, share in shares.items()]
    total: Floats = parts[0] if len(parts) == 1 else parts[0] + parts[1]
    return total
