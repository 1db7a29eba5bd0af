"""The articulatory parameters of a person: guided components of how the points of the lower face move."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fapstream.head import Fapu
from fapstream.learn.guided_pca import Guide, GuidedPca
from fapstream.learn.landmarks import Row, table
from fapstream.learn.measured import LOWER, faps_of
from fapstream.motion.articulation import COLUMNS, SPOKEN, Articulation

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NAMES = ("jaw opening", "lip parting", "lip raising", "lip spreading", "chin bunching", "corner raising")
"""What the six do, told by their extremes on our head."""

PAPER_EXPLAINED = (0.18, 0.726, 0.038, 0.021, 0.004, 0.008)
"""Of the total variance, mother-articulatory-head, 2.2: 34 postures, 64 points in space."""


def _lower() -> list[Row]:
    by_point = {row.point: row for row in table()}
    return [by_point[point] for point in LOWER]


def _mirror() -> Ints:
    """Where the twin of each of LOWER is."""
    return np.array([LOWER.index(row.mirror) for row in _lower()])


def _coordinates(part: str) -> Ints:
    """The columns of the coordinates of a part's points, x and y by turns."""
    points = np.flatnonzero([row.part == part for row in _lower()])
    return np.stack([2 * points, 2 * points + 1], axis=1).ravel()


def even(points: Floats) -> Floats:
    """Points of LOWER (..., m, 2), the mean of them and their mirror image.

    One man's crooked smile is not to be on everybody's face.
    """
    mirrored = points[..., _mirror(), :] * np.array([-1.0, 1.0])
    found: Floats = (points + mirrored) / 2
    return found


class ArticulatoryParameters:
    """Six parameters. After `fit`: `pca_`, and `articulation_`, which makes FAPs of them."""

    def fit(self, speech: Sequence[Floats], fapu: Fapu) -> ArticulatoryParameters:
        """Of the points of LOWER while people speak, each (frames, m, 2), mm, whose mean FAPU is `fapu`."""
        self._rows = rows = np.concatenate([_flat(points) for points in speech])
        everything = np.arange(rows.shape[1])
        jaw, lips = _coordinates("jaw"), _coordinates("lips")
        guides = [Guide(jaw, sign=-1), Guide(lips, 3), Guide(jaw, sign=-1), Guide(everything)]
        self.pca_ = GuidedPca(guides).fit(rows)
        moved = np.vstack([self.pca_.mean_, self.pca_.basis_]).reshape(-1, len(LOWER), 2)
        values = faps_of(moved, LOWER, fapu, SPOKEN)[:, COLUMNS]
        self.articulation_ = Articulation(NAMES, values[0], values[1:])
        return self

    def transform(self, points: Floats) -> Floats:
        """Parameters (t, 6) of points (t, m, 2), mm."""
        return self.pca_.transform(_flat(points))

    def components(self, n: int) -> Floats:
        """The part of the variance that each of n plain principal components explains, shape (n,)."""
        variances = np.linalg.eigvalsh(np.cov(self._rows, rowvar=False))[::-1]
        found: Floats = variances[:n] / variances.sum()
        return found


def _flat(points: Floats) -> Floats:
    return even(points).reshape(len(points), -1)
