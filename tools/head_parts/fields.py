"""What displacement fields are made of: motions, contours, the skin and smooth functions on it.

Everything here is in decimetres, the unit of the source. A field is (n, 3) per knot.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from head_parts.surface import Array, Ints, smooth_fields

X, Y, Z = np.eye(3)
Unit = dict[str, float]
"""Decimetres (AU: radians) per FAP unit, by the unit's name."""


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
