"""The rigid fit: rotation, one scale and translation between two sets of points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Similarity:
    """x' = scale * rotation @ x + translation. `rotation` (3, 3) proper, `translation` (3,)."""

    scale: float
    rotation: Floats
    translation: Floats

    def __call__(self, points: Floats) -> Floats:
        """(n, 3) to (n, 3)."""
        moved: Floats = self.scale * points @ self.rotation.T + self.translation
        return moved

    def inverse(self) -> Similarity:
        """The way back."""
        back = self.rotation.T / self.scale
        return Similarity(1 / self.scale, self.rotation.T, -back @ self.translation)

    @classmethod
    def fit(cls, source: Floats, target: Floats, weights: Floats | None = None) -> Similarity:
        """Least squares: the minimum of sum w |s R x + T - y|^2 over s, R and T, in closed form.

        `source`, `target` (n, 3), `weights` (n,). S. Umeyama (1991), Least-squares estimation of
        transformation parameters between two point patterns, IEEE PAMI 13(4), equations 39 to 43. Points on
        one line leave the turn about it open; it is then as small as can be.
        """
        w = np.ones(len(source)) if weights is None else weights
        w = w / w.sum()
        from_middle, to_middle = w @ source, w @ target
        a, b = source - from_middle, target - to_middle
        together = (b * w[:, None]).T @ a
        rotation = nearest_rotation(together)
        spread = float((w[:, None] * a**2).sum())
        scale = float((rotation * together).sum() / spread) if spread > 0 else 1.0
        return cls(scale, rotation, to_middle - scale * rotation @ from_middle)


def nearest_rotation(matrix: Floats) -> Floats:
    """The proper rotation R (3, 3) with the largest trace of R^T @ matrix (Kabsch 1976)."""
    left, _, right = np.linalg.svd(matrix)
    proper = np.array([1.0, 1.0, np.sign(np.linalg.det(left) * np.linalg.det(right)) or 1.0])
    rotation: Floats = (left * proper) @ right
    return rotation
