"""The outputs of hidden Markov states: Gaussians with a diagonal covariance, and what is counted for them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Gaussians:
    """Of m states over d numbers. `mean`, `var`: shape (m, d); `stay`: the probability to stay, shape
    (m,)."""

    mean: Floats
    var: Floats
    stay: Floats

    def log_density(self, x: Floats, states: Ints) -> Floats:
        """Of frames (t, d) in each of the states (s,), shape (t, s)."""
        mean, precision = self.mean[states], 1 / self.var[states]
        constant = np.log(2 * np.pi * self.var[states]).sum(axis=1) + (mean**2 * precision).sum(axis=1)
        found: Floats = x @ (mean * precision).T - 0.5 * (x**2 @ precision.T + constant)
        return found


@dataclass(frozen=True, slots=True)
class Counts:
    """Sufficient statistics of m states: occupancy and stays, shape (m,); sums of x and x^2, shape (m, d)."""

    occupancy: Floats
    stays: Floats
    x: Floats
    x2: Floats

    @classmethod
    def none(cls, m: int, d: int) -> Counts:
        """Nothing counted yet."""
        return cls(np.zeros(m), np.zeros(m), np.zeros((m, d)), np.zeros((m, d)))

    def add(self, states: Ints, gamma: Floats, stays: Floats, x: Floats) -> None:
        """One sentence: its places' states (s,), how probable each is at each frame (t, s), stays (s,), and
        the frames (t, d)."""
        np.add.at(self.occupancy, states, gamma.sum(axis=0))
        np.add.at(self.stays, states, stays)
        np.add.at(self.x, states, gamma.T @ x)
        np.add.at(self.x2, states, gamma.T @ x**2)

    def of(self, states: Ints) -> Counts:
        """Of those states alone."""
        return Counts(self.occupancy[states], self.stays[states], self.x[states], self.x2[states])

    def pooled(self, groups: Ints, m: int) -> Counts:
        """Of m groups of states; `groups`: which each belongs to, shape (states,)."""
        found = Counts.none(m, self.x.shape[1])
        np.add.at(found.occupancy, groups, self.occupancy)
        np.add.at(found.stays, groups, self.stays)
        np.add.at(found.x, groups, self.x)
        np.add.at(found.x2, groups, self.x2)
        return found

    def gaussians(self, floor: Floats, before: Gaussians) -> Gaussians:
        """The likeliest, variances no less than `floor` (d,); states never met stay as they were."""
        met = self.occupancy > LEAST_FRAMES
        n = np.where(met, self.occupancy, 1.0)[:, None]
        mean = np.where(met[:, None], self.x / n, before.mean)
        var = np.where(met[:, None], np.maximum(self.x2 / n - mean**2, floor), before.var)
        stay = np.where(met, np.clip(self.stays / n[:, 0], *STAY), before.stay)
        return Gaussians(mean, var, stay)


LEAST_FRAMES = 1e-3
STAY = (0.02, 0.98)
"""A state is never sure to stay or to go."""
