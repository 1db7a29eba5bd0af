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

STEP_S = 0.02
"""Instants are so far apart: those of 50 frames a second, and every other one of 25."""
UNSEEN = 1e-3
"""What an instant weighs that no state covers."""


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
    """The trajectories (n, parameters) at n instants STEP_S apart."""
    n = len(mean)
    kernel = _kernel(how.width_s, n)
    system = np.repeat(kernel[None], mean.shape[1], axis=0)
    system.reshape(mean.shape[1], -1)[:, :: n + 1] += how.weight / precision.T
    found: Floats = (kernel @ np.linalg.solve(system, mean.T[..., None]))[..., 0].T
    return found


def _kernel(width_s: float, n: int) -> Floats:
    """K(t_l, t_m) of n instants, shape (n, n)."""
    known = _LARGEST if n <= _LARGEST else n
    return _whole_kernel(width_s, known)[:n, :n]


_LARGEST = 64


@cache
def _whole_kernel(width_s: float, n: int) -> Floats:
    apart = (np.arange(n)[:, None] - np.arange(n)) * STEP_S
    found: Floats = np.exp(-0.5 * (apart / width_s) ** 2)
    return found
