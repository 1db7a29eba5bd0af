"""How far surfaces are from one another, and how smooth they are."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NEAREST = 6
"""A triangle is looked for among those of so many nearest vertices."""


class Surface:
    """A mesh to measure from: points (n, 3), triangles (m, 3)."""

    def __init__(self, points: Floats, triangles: Ints) -> None:
        self._corners = points[triangles]
        self._tree = cKDTree(points)
        order = np.argsort(triangles.ravel(), kind="stable")
        counts = np.bincount(triangles.ravel(), minlength=len(points))
        starts = np.r_[0, np.cumsum(counts)]
        most = int(counts.max())
        column = np.arange(most)
        # for each vertex its triangles, the last one repeated
        pick = np.minimum(starts[:-1, None] + column, np.maximum(starts[1:, None] - 1, 0))
        self._at = (order // 3)[np.minimum(pick, len(order) - 1)]

    def distances(self, points: Floats) -> Floats:
        """(k,): from points (k, 3) to the surface."""
        near = self._tree.query(points, NEAREST)[1]
        triangles = self._at[near].reshape(len(points), -1)
        best = np.full(len(points), np.inf)
        for column in triangles.T:
            best = np.minimum(best, to_triangles(points, self._corners[column]))
        return best


def to_triangles(points: Floats, corners: Floats) -> Floats:
    """(n,): from each point (n, 3) to its triangle (n, 3, 3)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = np.cross(b - a, c - a)
    size = np.maximum((normal**2).sum(1), 1e-24)
    over = ((points - a) * normal).sum(1) / size
    foot = points - over[:, None] * normal
    inside = np.ones(len(points), bool)
    best = np.full(len(points), np.inf)
    for p, q in ((a, b), (b, c), (c, a)):
        inside &= (np.cross(q - p, foot - p) * normal).sum(1) >= 0
        edge = q - p
        t = np.clip(((points - p) * edge).sum(1) / np.maximum((edge**2).sum(1), 1e-24), 0, 1)
        best = np.minimum(best, np.linalg.norm(points - p - t[:, None] * edge, axis=1))
    return np.where(inside, np.abs(over) * np.sqrt(size), best)


def areas(points: Floats, triangles: Ints) -> Floats:
    """(n,): a third of the area of the triangles round each vertex."""
    size = np.linalg.norm(normals(points, triangles), axis=1) / 6
    total = np.zeros(len(points))
    for corner in triangles.T:
        np.add.at(total, corner, size)
    return total


def normals(points: Floats, triangles: Ints) -> Floats:
    """Of triangles (m, 3), not of unit length."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def flipped(before: Floats, after: Floats, triangles: Ints) -> int:
    """How many triangles face the other way; `after` is aligned with `before`."""
    return int(((normals(before, triangles) * normals(after, triangles)).sum(1) <= 0).sum())


def dihedral_changes(before: Floats, after: Floats, triangles: Ints) -> Floats:
    """Radians (e,): how much the angle between the two triangles at each inner edge has changed."""
    sides = np.sort(np.stack([triangles, np.roll(triangles, -1, 1)], 2).reshape(-1, 2), 1)
    edges, inverse, counts = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(inverse, kind="stable")
    starts = np.r_[0, np.cumsum(counts)][:-1]
    inner = counts == 2
    pairs = np.stack([order[starts[inner]], order[starts[inner] + 1]], 1) // 3
    change = np.zeros(len(pairs))
    for sign, points in ((1, after), (-1, before)):
        face = normals(points, triangles)
        face /= np.maximum(np.linalg.norm(face, axis=1, keepdims=True), 1e-12)
        one, other = face[pairs[:, 0]], face[pairs[:, 1]]
        along = points[edges[inner, 1]] - points[edges[inner, 0]]
        along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-12)
        angle = np.arctan2((np.cross(one, other) * along).sum(1), (one * other).sum(1))
        change += sign * angle
    return np.abs((change + np.pi) % (2 * np.pi) - np.pi)
