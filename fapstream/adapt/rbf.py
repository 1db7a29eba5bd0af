"""The fit by radial basis functions, for comparison: every feature point exactly, and what is between
somehow.

N. Sarris, N. Grammalidis, M. G. Strintzis, section 3: f(x) = sum w_j phi(|x - x_j| / support) + v_0 + V x
with f(x_i) = y_i, sum w_j = 0 and sum w_j x_j^T = 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fapstream.adapt.warp import squared_gaps

Floats = NDArray[np.float64]

SUPPORT = 0.055
"""Metres (the paper's rmax): the best of 0.03 to 0.6 on the benchmark's identities."""


@dataclass(frozen=True, slots=True)
class RadialWarp:
    """`centres` (n, 3), `weights` (n, 3), `offset` (3,), `matrix` (3, 3)."""

    centres: Floats
    weights: Floats
    offset: Floats
    matrix: Floats
    support: float

    def __call__(self, points: Floats) -> Floats:
        moved: Floats = wu(np.sqrt(squared_gaps(points, self.centres)) / self.support) @ self.weights
        return moved + self.offset + points @ self.matrix.T


def wu(r: Floats) -> Floats:
    """Wu's compactly supported function: (1-r)^6 (6 + 36r + 82r^2 + 72r^3 + 30r^4 + 5r^5) below 1, else 0
    (equation 19).
    """
    polynomial = 6 + r * (36 + r * (82 + r * (72 + r * (30 + r * 5))))
    value: Floats = np.clip(1 - r, 0, None) ** 6 * polynomial
    return value


def fit_radial(source: Floats, target: Floats, support: float = SUPPORT) -> RadialWarp:
    """The warp that takes points (n, 3) to points (n, 3), n at least 4 and not in one plane."""
    n = len(source)
    affine = np.c_[np.ones(n), source]
    system = np.zeros((n + 4, n + 4))
    system[:n, :n] = wu(np.sqrt(squared_gaps(source, source)) / support)
    system[:n, n:], system[n:, :n] = affine, affine.T
    solved: Floats = np.asarray(np.linalg.solve(system, np.r_[target, np.zeros((4, 3))]), np.float64)
    return RadialWarp(source, solved[:n], solved[n], solved[n + 1 :].T, support)
