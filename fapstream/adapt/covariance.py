"""How faces differ from the generic one: smooth, of several sizes, and much the same on both sides.

The difference field of two faces is taken for a Gaussian process: a sum of Gaussian kernels, each split
into a part that is mirrored from one side of the face to the other and a small part that is not. It is what
is known before any photo is seen, so it fills in depths that only the front photo could have told, and
joins the points to a face.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fapstream.adapt.points import MIRROR
from fapstream.adapt.warp import squared_gaps

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Covariance:
    """Sum over (length, sd) of sd^2 exp(-|a - b|^2 / 2 length^2), metres; `asymmetry`: the share of the
    variance that the two sides of a face do not have in common; `own`: the sd that each point has for itself.
    """

    scales: tuple[tuple[float, float], ...] = (
        (0.010, 0.0022),
        (0.030, 0.0036),
        (0.080, 0.0072),
        (0.200, 0.0108),
    )
    asymmetry: float = 0.03
    own: float = 0.0003

    def between(self, a: Floats, b: Floats) -> Floats:
        """(3n, 3m): of the differences at points a (n, 3) and b (m, 3), xyz within points."""
        direct, crossed = self._kernel(a, b), self._kernel(a, b * MIRROR)
        blocks = np.zeros((len(a), 3, len(b), 3))
        for axis in range(3):
            shared = (1 - self.asymmetry) / 2 * (direct + MIRROR[axis] * crossed)
            blocks[:, axis, :, axis] = shared + self.asymmetry * direct
        return blocks.reshape(3 * len(a), 3 * len(b))

    def within(self, points: Floats) -> Floats:
        """(3n, 3n): positive definite."""
        matrix: Floats = self.between(points, points) + self.own**2 * np.eye(3 * len(points))
        return matrix

    def field(self, points: Floats, centres: Floats, weights: Floats) -> Floats:
        """(n, 3): the sum over centres (m, 3) of `between(points, centres)` times their weights (m, 3)."""
        shared = (1 - self.asymmetry) / 2
        direct = self._kernel(points, centres) @ (weights * (shared + self.asymmetry))
        crossed = self._kernel(points, centres * MIRROR) @ (weights * (shared * MIRROR))
        total: Floats = direct + crossed
        return total

    def slopes(self, points: Floats, centres: Floats, weights: Floats) -> Floats:
        """(n, 3, 3): `field`'s derivatives; entry (i, j) is coordinate i along axis j."""
        shared = (1 - self.asymmetry) / 2
        total = np.zeros((len(points), 3, 3))
        for at, row in (
            (centres, weights * (shared + self.asymmetry)),
            (centres * MIRROR, weights * (shared * MIRROR)),
        ):
            steep = self._kernel(points, at, 2)
            for axis in range(3):
                total[:, :, axis] += steep @ (row * at[:, [axis]]) - points[:, [axis]] * (steep @ row)
        return total

    def _kernel(self, a: Floats, b: Floats, power: int = 0) -> Floats:
        """(n, m); each Gaussian divided by its length to the `power`."""
        squared = squared_gaps(a, b)
        total = np.zeros(squared.shape)
        for length, sd in self.scales:
            total += sd**2 / length**power * np.exp(squared / (-2 * length**2))
        return total


def precision(faces: Covariance, points: Floats) -> Floats:
    """(3n, 3n): how dear differences at points (n, 3) are. Where the head is, how it is turned and how
    large it is are for the cameras to say, so differences may not shift, turn or scale the points as a whole.

    Without this the smallest sum of differences would be that of a head too small.
    """
    matrix = np.linalg.inv(faces.within(points))
    poses = similarities(points)
    rigid: Floats = matrix + RIGID * np.trace(matrix) / len(matrix) * poses @ poses.T
    return rigid


RIGID = 1e3
"""How much dearer a shift of all points is than a difference of one."""


def similarities(points: Floats) -> Floats:
    """(3n, 7), orthonormal: the directions in which points (n, 3) are shifted, turned and scaled as a
    whole.
    """
    arm = points - points.mean(0)
    ways = [np.broadcast_to(axis, points.shape) for axis in np.eye(3)]
    ways += [np.cross(axis, arm) for axis in np.eye(3)] + [arm]
    basis, _ = np.linalg.qr(np.stack([way.ravel() for way in ways], 1))
    return np.asarray(basis, float)
