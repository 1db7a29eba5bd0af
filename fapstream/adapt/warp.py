"""A warp takes every point of space to another: what all ways of fitting a head have in common."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Warp = Callable[[Floats], Floats]
"""Points (n, 3) to points (n, 3), metres; continuous."""

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


def jacobians(warp: Warp, points: Floats) -> Floats:
    """(n, 3, 3): entry (i, j) is the slope of coordinate i along axis j, at points (n, 3); central
    differences.
    """
    ahead = [warp(points + STEP * axis) for axis in np.eye(3)]
    behind = [warp(points - STEP * axis) for axis in np.eye(3)]
    slopes: Floats = (np.stack(ahead, 2) - np.stack(behind, 2)) / (2 * STEP)
    return slopes
