"""A warp takes every point of space to another: what all ways of fitting a head have in common."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Warp = Callable[[Floats], Floats]
"""Points (n, 3) to points (n, 3), metres; continuous."""


def squared_gaps(a: Floats, b: Floats) -> Floats:
    """(n, m): squared distances between points (n, 3) and (m, 3)."""
    squared: Floats = np.maximum((a**2).sum(1)[:, None] + (b**2).sum(1) - 2 * a @ b.T, 0)
    return squared


STEP = 2e-4
"""Metres between the points that a slope is taken from."""


@dataclass(frozen=True, slots=True)
class Chain:
    """One warp after the other."""

    warps: tuple[Warp, ...]

    def __call__(self, points: Floats) -> Floats:
        for warp in self.warps:
            points = warp(points)
        return points


@dataclass(frozen=True, slots=True)
class Eased:
    """Part of the way from one warp to another: `share` 0 is the first, 1 the second."""

    first: Warp
    second: Warp
    share: float

    def __call__(self, points: Floats) -> Floats:
        return (1 - self.share) * self.first(points) + self.share * self.second(points)


def unfolded(
    warp: Warp, safe: Warp, points: Floats, triangles: NDArray[np.integer[Any]]
) -> tuple[Warp, Floats]:
    """The warp, or as much of the way to it from `safe` as turns no triangle (m, 3) of points (n, 3) inside
    out; and where it takes the points.
    """
    safely, wholly = safe(points), warp(points)
    before = _facing(safely, triangles)
    for share in SHARES:
        moved = (1 - share) * safely + share * wholly
        if ((_facing(moved, triangles) * before).sum(1) > 0)[(before**2).sum(1) > TINY].all():
            return (warp if share == 1 else Eased(safe, warp, share)), moved
    return safe, safely


SHARES = (1.0, 0.95, 0.85, 0.7, 0.5, 0.25)
TINY = 1e-18
"""Squared area, m^4, of triangles too thin to say how they face."""


def _facing(points: Floats, triangles: NDArray[np.integer[Any]]) -> Floats:
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return np.cross(b - a, c - a)


def jacobians(warp: Warp, points: Floats) -> Floats:
    """(n, 3, 3): entry (i, j) is the slope of coordinate i along axis j, at points (n, 3); central
    differences.
    """
    ahead = [warp(points + STEP * axis) for axis in np.eye(3)]
    behind = [warp(points - STEP * axis) for axis in np.eye(3)]
    slopes: Floats = (np.stack(ahead, 2) - np.stack(behind, 2)) / (2 * STEP)
    return slopes
