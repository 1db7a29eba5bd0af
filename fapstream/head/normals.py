"""Normals of a part whose vertices move.

Only the neighbourhood of vertices that can move is computed again; what comes out is the file's own normal
plus what the movement changed, so nothing jumps at the border or at rest. Vertices split for texture seams
keep one normal.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from fapstream.head.mesh import Floats, Indices, Part

SAME_SURFACE = 0.7
"""Split vertices share a normal if their normals at rest differ by less than this angle's cosine."""

Numbers = NDArray[np.intp]


class NormalField:
    """The normals of one part; `movable` are the vertex numbers that its tables can move."""

    def __init__(self, part: Part, movable: Iterable[Indices]) -> None:
        group = weld(part)
        every = _Corners(part.triangles, group)
        own = bool(part.normals.any())
        self.rest: Floats = part.normals if own else every.normals(part.positions)[every.slots(group)]
        """Unit normals (n, 3) at rest."""
        moved = np.zeros(len(group), bool)
        for indices in movable:
            moved[group[indices]] = True
        corners, _ = _grow(part.triangles, group, moved)
        _, near = _grow(part.triangles, group, corners)
        self._corners = _Corners(near, group)
        self._vertices = np.flatnonzero(corners[group])
        self._slots = self._corners.slots(group[self._vertices])
        self._reference = self._corners.normals(part.positions)

    def write(self, positions: Floats, out: Floats) -> None:
        """The normals of the part with its vertices at `positions` (n, 3), into `out` (n, 3)."""
        out[:] = self.rest
        if self._vertices.size:
            change = self._corners.normals(positions) - self._reference
            out[self._vertices] += change[self._slots]


class _Corners:
    """Triangles and, for every welded vertex that they have, its corners: sums without a loop."""

    def __init__(self, triangles: Indices, group: Numbers) -> None:
        corners = group[triangles].ravel()
        order = np.argsort(corners, kind="stable")
        self._a, self._b, self._c = (np.ascontiguousarray(triangles[:, k]) for k in range(3))
        self._faces = order // 3
        self._welded, self._starts = np.unique(corners[order], return_index=True)

    def slots(self, groups: Numbers) -> Numbers:
        """Which row of `normals` belongs to these welded vertices; one without a triangle gets any."""
        return np.minimum(np.searchsorted(self._welded, groups), max(0, len(self._welded) - 1))

    def normals(self, positions: Floats) -> Floats:
        """Unit normals by welded vertex, float32 (k, 3): sums over the triangles round it, by area."""
        if not self._starts.size:
            return np.zeros((1, 3), np.float32)
        ax, ay, az = positions[self._a].T
        bx, by, bz = positions[self._b].T
        cx, cy, cz = positions[self._c].T
        ux, uy, uz = bx - ax, by - ay, bz - az
        vx, vy, vz = cx - ax, cy - ay, cz - az
        faces = (uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx)
        sums = np.stack([np.add.reduceat(face[self._faces], self._starts) for face in faces], axis=1)
        length = np.sqrt(np.einsum("ij,ij->i", sums, sums))
        normals: Floats = (sums / np.where(length > 0, length, 1)[:, None]).astype(np.float32)
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


def _grow(triangles: Indices, group: Numbers, marked: NDArray[np.bool_]) -> tuple[NDArray[np.bool_], Indices]:
    """The welded vertices of all triangles with a marked corner, and those triangles."""
    near = triangles[marked[group[triangles]].any(axis=1)]
    corners = np.zeros(len(group), bool)
    corners[group[near]] = True
    return corners, near
