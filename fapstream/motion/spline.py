"""Smooth trajectories through what states say: speech-enabled-avatars, appendix B.

A parameter's trajectory minimises sum_n (a(t_n) - mu_n)^2 / sigma_n^2 + lambda |a|_K^2. By the representer
theorem a(t) = sum_l K(t_l, t) b_l with (K + lambda diag(sigma^2)) b = mu (the paper's text has Sigma inverted
there). Parameters have mean 0 over speech, so that the penalty draws to nothing but that. K is Gaussian.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STEP_S = 0.02
"""Instants are so far apart: those of 50 frames a second, and every other one of 25."""
UNSEEN = 1e-3
"""What an instant weighs that no state covers."""
BEFORE, AT_ONCE, AFTER = 5, 5, 6
"""Instants of a window: so many are told, and so many before and after them take part."""


@dataclass(frozen=True, slots=True)
class Smoothness:
    """`width_s`: standard deviation of the Gaussian kernel. `weight`: lambda, for variances of frames of
    10 ms."""

    width_s: float
    weight: float


@dataclass(frozen=True, slots=True)
class Segments:
    """States in order of time: `start`, `end`, shape (s,), s; `precision` and `weighted` (precision times
    mean), shape (s, n)."""

    start: Floats
    end: Floats
    precision: Floats
    weighted: Floats


def observed(segments: Segments, first: int, n: int) -> tuple[Floats, Floats]:
    """What the states say at n instants from number `first` on: mean and precision, each (n, parameters).

    An instant stands for the STEP_S around it; states share it by how much of it they take.
    """
    low = (np.arange(first, first + n)[:, None] - 0.5) * STEP_S
    share = np.minimum(segments.end, low + STEP_S) - np.maximum(segments.start, low)
    share = np.maximum(share, 0.0) * 100
    precision = np.maximum(share @ segments.precision, UNSEEN)
    return share @ segments.weighted / precision, precision


def smooth(mean: Floats, precision: Floats, how: Smoothness) -> Floats:
    """The trajectories (..., n, parameters) at n instants STEP_S apart: of one talk or of many windows."""
    kernel = _kernel(how.width_s, mean.shape[-2])
    return _solved(mean, precision, how, kernel, kernel)


def windowed(seen: tuple[Floats, Floats], pieces: Ints, how: Smoothness) -> Floats:
    """The trajectories of pieces of a talk, each by a window of its own: shape (pieces, AT_ONCE, parameters).

    `seen`: mean and precision, each (n, parameters). `pieces`: shape (p, 2), at which of the n instants each
    begins, BEFORE it and from it on AT_ONCE and AFTER it being among them, and from which on its window looks
    no further.
    """
    at = pieces[:, :1] + np.arange(-BEFORE, AT_ONCE + AFTER)
    beyond = (at >= pieces[:, 1:])[..., None]
    mean, precision = np.where(beyond, 0.0, seen[0][at]), np.where(beyond, UNSEEN, seen[1][at])
    kernel = _kernel(how.width_s, BEFORE + AT_ONCE + AFTER)
    return _solved(mean, precision, how, kernel, kernel[BEFORE : BEFORE + AT_ONCE])


def _solved(mean: Floats, precision: Floats, how: Smoothness, kernel: Floats, told: Floats) -> Floats:
    """K(told) (K + lambda / precision)^-1 mean, for each parameter (the last axis) by itself."""
    n = len(kernel)
    mean, precision = np.swapaxes(mean, -1, -2), np.swapaxes(precision, -1, -2)
    system = np.empty((*mean.shape, n))
    system[:] = kernel
    system.reshape(*mean.shape[:-1], n * n)[..., :: n + 1] += how.weight / precision
    found: Floats = np.swapaxes((told @ np.linalg.solve(system, mean[..., None]))[..., 0], -1, -2)
    return found


@cache
def _kernel(width_s: float, n: int) -> Floats:
    """K(t_l, t_m) of n instants, shape (n, n)."""
    apart = (np.arange(n)[:, None] - np.arange(n)) * STEP_S
    found: Floats = np.exp(-0.5 * (apart / width_s) ** 2)
    return found
