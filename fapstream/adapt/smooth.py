"""Smooth warps by kernels: the third paper's diffeomorphism, and the most probable face under
`Covariance`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fapstream.adapt.covariance import Covariance
from fapstream.adapt.warp import Chain, Warp, squared_gaps

Floats = NDArray[np.float64]

WIDTH = 0.018
"""Metres (the paper's sigma): the best of 0.012 to 0.08 on the benchmark's identities."""
STEEPEST = 0.45
"""No step bends space more than this, so none folds it: |Df - 1| < 1."""
MOST_STEPS = 32
STIFFNESS = 1e-3
"""Added to the kernel matrix' diagonal: feature points nearer to one another than `WIDTH` would need
coefficients without bounds."""


@dataclass(frozen=True, slots=True)
class GaussianWarp:
    """f(x) = x + sum_k exp(-|x - x_k|^2 / 2 width^2) b_k; `centres`, `coefficients` (n, 3).

    K. Kahler and others' method as told by D. Bitouk and S. K. Nayar, Creating a speech enabled avatar from
    a single photograph, appendix A, equation 5.
    """

    centres: Floats
    coefficients: Floats
    width: float

    def __call__(self, points: Floats) -> Floats:
        moved: Floats = points + self._kernel(points) @ self.coefficients
        return moved

    def jacobians(self, points: Floats) -> Floats:
        """(n, 3, 3): 1 - sum_k K b_k (x - x_k)^T / width^2."""
        arms = points[:, None] - self.centres
        slopes = np.einsum("nk,ki,nkj->nij", self._kernel(points), self.coefficients, arms)
        found: Floats = np.eye(3) - slopes / self.width**2
        return found

    def _kernel(self, points: Floats) -> Floats:
        kernel: Floats = np.exp(squared_gaps(points, self.centres) / (-2 * self.width**2))
        return kernel


def fit_diffeomorphism(source: Floats, target: Floats, width: float = WIDTH) -> Chain:
    """A smooth one-to-one warp that takes points (n, 3) to points (n, 3).

    One sum of Gaussians is one-to-one only while its coefficients are small against the width. So the way
    is gone in steps: as many equal ones as keep every step's slope under `STEEPEST`, each fitted where the
    last one led; the composition of one-to-one maps is one-to-one.
    """
    steps, here = [], source
    for left in range(MOST_STEPS, 0, -1):
        whole = _gaussian(here, target - here, width)
        share = min(1.0, STEEPEST / max(_steepness(whole), 1e-12))
        share = max(share, 1 / left)
        step = GaussianWarp(whole.centres, whole.coefficients * share, width)
        steps.append(step)
        here = step(here)
        if share >= 1:
            break
    return Chain(tuple(steps))


def _steepness(warp: GaussianWarp) -> float:
    """The largest |Df - 1| where it may be largest: one width from a centre, along its coefficient, and
    half way to the next centre.
    """
    along = warp.coefficients / np.maximum(np.linalg.norm(warp.coefficients, axis=1, keepdims=True), 1e-12)
    gaps = ((warp.centres[:, None] - warp.centres) ** 2).sum(-1) + np.diag(np.full(len(along), np.inf))
    half_way = (warp.centres + warp.centres[gaps.argmin(1)]) / 2
    ahead, behind = (warp.centres + way * warp.width * along for way in (1, -1))
    slopes = warp.jacobians(np.concatenate([warp.centres, ahead, behind, half_way])) - np.eye(3)
    return float(np.linalg.norm(slopes, ord=2, axis=(1, 2)).max())


def _gaussian(source: Floats, moves: Floats, width: float) -> GaussianWarp:
    kernel: Floats = np.exp(squared_gaps(source, source) / (-2 * width**2)) + STIFFNESS * np.eye(len(source))
    return GaussianWarp(source, np.asarray(np.linalg.solve(kernel, moves), np.float64), width)


@dataclass(frozen=True, slots=True)
class ProbableWarp:
    """The mean of a Gaussian process: x + sum_k C(x, x_k) w_k; `centres`, `weights` (n, 3)."""

    centres: Floats
    weights: Floats
    faces: Covariance

    def __call__(self, points: Floats) -> Floats:
        return points + self.faces.field(points, self.centres, self.weights)

    def jacobians(self, points: Floats) -> Floats:
        """(n, 3, 3)."""
        return np.eye(3) + self.faces.slopes(points, self.centres, self.weights)


def fit_probable(source: Floats, target: Floats, noise: float, faces: Covariance) -> Warp:
    """The most probable smooth warp that takes points (n, 3) to points (n, 3), these known to `noise`
    metres.
    """
    matrix = faces.within(source) + noise**2 * np.eye(3 * len(source))
    weights = np.asarray(np.linalg.solve(matrix, (target - source).ravel()), np.float64)
    return ProbableWarp(source, weights.reshape(-1, 3), faces)
