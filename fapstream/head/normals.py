"""Normals of the parts of a head whose vertices move.

Only the neighbourhood of vertices that can move is computed again; what comes out is the file's own normal
plus what the movement changed, so nothing jumps at the border or at rest. Vertices split for texture seams
keep one normal. Vectors are (3, n), a row for each of x, y, z: numpy is quick on long rows.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fapstream.head.mesh import Floats, Part

SAME_SURFACE = 0.7
"""Split vertices share a normal if their normals at rest differ by less than this angle's cosine."""

Numbers = NDArray[np.intp]


class NormalField:
    """The normals of `parts`, their vertices numbered through; `movable` are those that tables can move."""

    def __init__(self, parts: Sequence[Part], movable: Numbers) -> None:
        starts = np.cumsum([0, *(len(part.positions) for part in parts[:-1])])
        each = list(zip(parts, starts, strict=True))
        group = np.concatenate([weld(part) + start for part, start in each])
        triangles = np.concatenate([part.triangles + start for part, start in each])
        positions = np.concatenate([part.positions for part in parts]).T
        own = np.concatenate([np.full(len(part.positions), part.normals.any()) for part in parts])
        every = _Corners(triangles, group)
        computed = every.normals(positions)[:, every.slots(group)]
        self.rest: Floats = np.where(own, np.concatenate([part.normals for part in parts]).T, computed)
        """Unit normals (3, n) at rest."""
        moved = np.zeros(len(group), bool)
        moved[group[movable]] = True
        corners, _ = _grow(triangles, group, moved)
        _, near = _grow(triangles, group, corners)
        self._corners = _Corners(near, group)
        self._slots = self._corners.slots(np.where(corners[group], group, -1))
        self._base = self.rest - self._corners.normals(positions)[:, self._slots]

    def at(self, positions: Floats) -> Floats:
        """The normals (3, n) with the vertices at `positions` (3, n)."""
        total: Floats = self._corners.normals(positions).take(self._slots, axis=1)
        total += self._base
        return total


class _Corners:
    """Triangles and, for every welded vertex that they have, its corners: sums without a loop."""

    def __init__(self, triangles: Numbers, group: Numbers) -> None:
        corners = group[triangles].ravel()
        order = np.argsort(corners, kind="stable")
        self._a, self._b, self._c = (np.ascontiguousarray(triangles[:, k]) for k in range(3))
        self._faces = order // 3
        self._welded, self._starts = np.unique(corners[order], return_index=True)

    def slots(self, groups: Numbers) -> Numbers:
        """Which column of `normals` belongs to these welded vertices; without a triangle it is the last."""
        last = len(self._welded)
        slots = np.searchsorted(self._welded, groups)
        return np.where(np.append(self._welded, -1)[slots] == groups, slots, last)

    def normals(self, positions: Floats) -> Floats:
        """Unit normals by welded vertex, float32 (3, k + 1): sums over the triangles round it, by area.

        The last is zero.
        """
        a = positions.take(self._a, axis=1)
        ux, uy, uz = positions.take(self._b, axis=1) - a
        vx, vy, vz = positions.take(self._c, axis=1) - a
        faces = np.stack([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx])
        sums = np.add.reduceat(faces.take(self._faces, axis=1), self._starts, axis=1)
        length = np.sqrt(np.einsum("ij,ij->j", sums, sums))
        normals = np.zeros((3, len(length) + 1), np.float32)
        np.divide(sums, length, out=normals[:, :-1], where=length > 0)
        return normals


def weld(part: Part) -> Numbers:
    """For each vertex the first one at the same place on the same surface, (n,)."""
    first = np.arange(len(part.positions))
    _, place, count = np.unique(part.positions, axis=0, return_inverse=True, return_counts=True)
    place = place.ravel()
    shared = np.flatnonzero(count[place] > 1)
    seen: dict[int, list[int]] = {}
    for vertex in shared.tolist():
        here = seen.setdefault(int(place[vertex]), [])
        twin = next((other for other in here if _alike(part.normals, vertex, other)), None)
        if twin is None:
            here.append(vertex)
        else:
            first[vertex] = twin
    return first


def _alike(normals: Floats, v: int, w: int) -> bool:
    """Do the file's normals, where it has any, allow the two to be one surface?"""
    return not normals[v].any() or float(normals[v] @ normals[w]) > SAME_SURFACE


def _grow(triangles: Numbers, group: Numbers, marked: NDArray[np.bool_]) -> tuple[NDArray[np.bool_], Numbers]:
    """The welded vertices of all triangles with a marked corner, and those triangles."""
    near = triangles[marked[group[triangles]].any(axis=1)]
    corners = np.zeros(len(group), bool)
    corners[group[near]] = True
    return corners, near
