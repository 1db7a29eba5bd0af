"""Displacement fields of the low-level FAPs on the skin, each normalised at its feature point.

Everything here is in decimetres, the unit of the source. A field is (n, 3) per knot.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from head_parts.surface import Array, Ints, smooth_fields

X, Y, Z = np.eye(3)


@dataclass(frozen=True)
class Motion:
    """One FAP on one part: displacement (n, 3) at each knot."""

    fap: int
    part: str
    knots: tuple[int, ...]
    moves: tuple[Array, ...]


@dataclass(frozen=True)
class Contour:
    """A closed lip contour: fine vertices and their lateral places, -1 (right corner) .. 1 (left)."""

    vertices: Ints
    places: Array
    upper: np.ndarray
    """bool; the two corners count as upper."""

    def point(self, place: float, upper: bool) -> int:
        """The vertex nearest to a lateral place on one half; corners belong to both."""
        cost = np.abs(self.places - place) + np.where(
            (self.upper == upper) | (np.abs(self.places) > 0.999), 0, 9
        )
        return int(self.vertices[np.argmin(cost)])


def cardinal(nodes: Sequence[float], which: int, places: Array) -> Array:
    """The natural cubic spline that is 1 at one node and 0 at the others, held constant outside."""
    values = np.zeros(len(nodes))
    values[which] = 1
    return CubicSpline(nodes, values, bc_type="natural")(np.clip(places, nodes[0], nodes[-1]))


@dataclass
class Skin:
    """The fine skin surface with what the fields need to know about it."""

    points: Array
    triangles: Ints
    normals: Array
    inner: Contour
    outer: Contour

    def solve(self, free: np.ndarray, handles: list[tuple[Ints, Array]], harmonic: float = 0.0) -> Array:
        """Smooth scalar fields (n, m): `handles` are (vertices, values (k, m)); zero where not `free`."""
        columns = handles[0][1].shape[1]
        values = np.zeros((len(self.points), columns))
        held = ~free
        for vertices, wanted in handles:
            values[vertices] = wanted
            held[vertices] = True
        fixed = np.flatnonzero(held)
        return smooth_fields(self.points, self.triangles, fixed, values[fixed], harmonic)

    def near(self, vertices: Ints, radius: float) -> np.ndarray:
        """bool (n,): closer than `radius` to any of those vertices."""
        from scipy.spatial import cKDTree

        return cKDTree(self.points[vertices]).query(self.points)[0] < radius

    def tangent(self, vertex: int, wish: Array) -> Array:
        """The direction in the surface at `vertex` that has a component of 1 along `wish`."""
        normal = self.normals[vertex]
        flat = wish - (wish @ normal) * normal
        return flat / (flat @ wish)

    def outward(self, vertex: int, wish: Array) -> Array:
        """The normal at `vertex`, scaled to a component of 1 along `wish`."""
        normal = self.normals[vertex]
        return normal / (normal @ wish)


LIP_NODES = (-1.0, -0.5, 0.0, 0.5, 1.0)
LIP_FAPS = {
    # (contour, upper, node) -> FAP; node 0 is the right corner, 4 the left
    ("inner", True): {1: 9, 2: 4, 3: 8},
    ("inner", False): {1: 11, 2: 5, 3: 10},
    ("outer", True): {1: 56, 2: 51, 3: 55},
    ("outer", False): {1: 58, 2: 52, 3: 57},
}
CORNER_FAPS = {"inner": {4: 12, 0: 13}, "outer": {4: 59, 0: 60}}
STRETCH_FAPS = {"inner": {4: 6, 0: 7}, "outer": {4: 53, 0: 54}}
DOWN = {4, 8, 9, 51, 55, 56}


class Lips:
    """Scalar fields of the lips: 1 at their own feature point, 0 at all others of their kind."""

    def __init__(self, skin: Skin, still: np.ndarray) -> None:
        """`still`: bool (n,), what no lip FAP moves (nose, deep mouth, eyes)."""
        self.skin = skin
        near = skin.near(skin.outer.vertices, 0.24) & ~still
        wide = skin.near(skin.outer.vertices, 0.42) & ~still
        self.contours = {"inner": skin.inner, "outer": skin.outer}
        self.raises = self._solve(near, LIP_FAPS, None) | self._solve(wide, None, CORNER_FAPS)
        self.stretches = self._stretch(wide)
        self.pushes = self._push(near)

    def _solve(self, free: np.ndarray, lips: dict | None, corners: dict | None) -> dict[int, Array]:
        faps, columns = [], []
        for (name, upper), row in (lips or {}).items():
            for node, fap in row.items():
                faps.append(fap)
                columns.append(
                    (name, lambda c, n=node, u=upper: cardinal(LIP_NODES, n, c.places) * (c.upper == u))
                )
        for name, row in (corners or {}).items():
            for node, fap in row.items():
                faps.append(fap)
                columns.append((name, lambda c, n=node: cardinal(LIP_NODES, n, c.places)))
        return dict(zip(faps, self._fields(free, columns).T, strict=True))

    def _stretch(self, free: np.ndarray) -> dict[int, Array]:
        faps, columns = [], []
        for name, row in STRETCH_FAPS.items():
            for node, fap in row.items():
                faps.append(fap)
                columns.append((name, lambda c, n=node: cardinal((-1.0, 0.0, 1.0), n // 2, c.places)))
        return dict(zip(faps, self._fields(free, columns).T, strict=True))

    def _push(self, free: np.ndarray) -> dict[int, Array]:
        columns = []
        for upper in (False, True):
            shape = lambda c, u=upper: np.cos(c.places * np.pi / 2) ** 0.7 * (c.upper == u)  # noqa: E731
            columns.append(("both", shape))
        return dict(zip((16, 17), self._fields(free, columns).T, strict=True))

    def _fields(self, free: np.ndarray, columns: list) -> Array:
        handles = []
        for name, contour in self.contours.items():
            values = [
                shape(contour) if where in (name, "both") else np.zeros(len(contour.places))
                for where, shape in columns
            ]
            handles.append((contour.vertices, np.stack(values, 1)))
        return self.skin.solve(free, handles, harmonic=15.0)

    def points(self) -> dict[int, int]:
        """The fine vertex of each vertical lip FAP's feature point."""
        found = {}
        for (name, upper), row in LIP_FAPS.items():
            for node, fap in row.items():
                found[fap] = self.contours[name].point(LIP_NODES[node], upper)
        for name, row in CORNER_FAPS.items():
            for node, fap in row.items():
                found[fap] = self.contours[name].point(LIP_NODES[node], True)
        return found

    def still(self, move: Array, axes: Sequence[int]) -> Array:
        """`move` (n, 3) with the lips' feature points held along the given coordinates."""
        held = move.copy()
        for fap, vertex in self.points().items():
            for axis in axes:
                held[:, axis] -= move[vertex, axis] * self.raises[fap]
        return held

    def motions(self, unit: dict[str, float]) -> list[Motion]:
        """Lip FAPs 4-13, 16, 17 and 51-60. `unit`: decimetres per FAP unit by name."""
        out = []
        for fap, field in self.raises.items():
            sign = -1.0 if fap in DOWN else 1.0
            direction = Y * sign
            if fap in (12, 13, 59, 60):
                direction = np.array([0.0, 1.0, -0.25])
            out.append(_linear(fap, field[:, None] * direction, 600 * unit["MNS"]))
        for fap, field in self.stretches.items():
            side = 1.0 if fap in (6, 53) else -1.0
            out.append(_linear(fap, field[:, None] * np.array([side, 0.0, -0.55]), 600 * unit["MW"]))
        for fap, field in self.pushes.items():
            out.append(_linear(fap, field[:, None] * Z, 600 * unit["MNS"]))
        return out


def _linear(fap: int, move: Array, amount: float, knot: int = 600) -> Motion:
    return Motion(fap, "skin", (knot,), (move * amount,))


@dataclass(frozen=True)
class Jaw:
    """The jaw's opening as found in the artist's shape: a rotation, weights, and what it leaves."""

    pivot: Array
    axis: Array
    angle: float
    shift: Array
    weights: Array
    rest: Array

    @classmethod
    def fit(cls, teeth: Array, teeth_open: Array, skin: Array, skin_open: Array) -> Jaw:
        """From lower teeth, which move rigidly, and skin, (n, 3) closed and opened."""
        centre, moved = teeth.mean(0), teeth_open.mean(0)
        u, _, vt = np.linalg.svd((teeth - centre).T @ (teeth_open - moved))
        matrix = vt.T @ np.diag([1, 1, np.sign(np.linalg.det(vt.T @ u.T))]) @ u.T
        angle = float(np.arccos(np.clip((np.trace(matrix) - 1) / 2, -1, 1)))
        axis = X if matrix[2, 1] > 0 else -X
        # the fixed point of the motion in the sagittal plane is the condyles' hinge
        plane = (np.eye(3) - matrix)[1:, 1:]
        pivot = np.array([0.0, *np.linalg.solve(plane, (moved - matrix @ centre)[1:])])
        jaw = cls(pivot, axis, angle, np.zeros(3), np.zeros(0), np.zeros(0))
        full = jaw.rigid(skin, 1.0)
        weights = np.clip(((skin_open - skin) * full).sum(1) / np.maximum((full**2).sum(1), 1e-9), 0, 1.15)
        return cls(pivot, axis, angle, np.zeros(3), weights, skin_open - skin - weights[:, None] * full)

    def rigid(self, points: Array, amount: float) -> Array:
        """Displacement (n, 3) of bone at `amount` of full opening."""
        angle = self.angle * amount * np.sign(self.axis[0])
        c, s = np.cos(angle), np.sin(angle)
        y, z = (points - self.pivot)[:, 1], (points - self.pivot)[:, 2]
        return np.stack([np.zeros(len(points)), (c - 1) * y - s * z, s * y + (c - 1) * z], 1)

    def skin(self, points: Array, amount: float) -> Array:
        """Displacement (n, 3) of the skin at `amount` of full opening."""
        return self.weights[:, None] * self.rigid(points, amount) + amount * self.rest
