"""The lips of a deformed head as smooth closed curves, and how far the mouth is open."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fapstream.head.mesh import Head

Points = NDArray[np.float64]

INNER = ("2.4", "2.6", "2.2", "2.7", "2.5", "2.9", "2.3", "2.8")
OUTER = ("8.3", "8.5", "8.10", "8.1", "8.9", "8.6", "8.4", "8.8", "8.2", "8.7")
"""Feature points of the two contours: from the left corner over the upper lip, back along the lower."""
RIGHT_CORNERS = ("2.5", "8.4")


@dataclass(frozen=True, slots=True)
class LipContours:
    """Two closed curves, float64 (n, 3), metres. Row 0 is the left corner, row n / 2 the right one;
    the first half is the upper lip, the second the lower, back to the left."""

    inner: Points
    outer: Points

    @property
    def height(self) -> float:
        """The largest vertical gap between the inner edges, metres; 0 or less where the lips are closed."""
        half = len(self.inner) // 2
        upper = self.inner[: half + 1][::-1]
        lower = np.vstack([self.inner[half:], self.inner[:1]])
        low, high = np.maximum(upper[0, 0], lower[0, 0]), np.minimum(upper[-1, 0], lower[-1, 0])
        across = np.linspace(low, high, 4 * half + 1)[1:-1]
        gap = np.interp(across, upper[:, 0], upper[:, 1]) - np.interp(across, lower[:, 0], lower[:, 1])
        return float(gap.max())

    @property
    def width(self) -> float:
        """Between the inner corners, metres."""
        return float(np.linalg.norm(self.inner[0] - self.inner[len(self.inner) // 2]))


def lip_contours(head: Head, positions: Mapping[str, Points], count: int = 96) -> LipContours:
    """The inner and the outer contour of a head under deformation.

    `positions` are those of `fapstream.head.deform.deform`, `count` (even, at least 8) the points of a curve:
    its density. Each curve is a closed cubic through the lips' feature points, as lips are drawn between
    control points with a density one can choose in Reveret, Bailly and Badin (2000), MOTHER: a new generation
    of talking heads, section 3.1. Raises ValueError for a count that is odd or too small, KeyError without a
    feature point.
    """
    if count < 8 or count % 2:
        raise ValueError(f"a lip contour needs an even number of points, 8 or more, not {count}")
    skin, moved = head.part("skin").positions.astype(np.float64), positions["skin"]
    curves = []
    for names, right in zip((INNER, OUTER), RIGHT_CORNERS, strict=True):
        nodes = [moved[_nearest(skin, head.fdp[name])] for name in names]
        curves.append(_closed(np.array(nodes), names.index(right), count))
    return LipContours(*curves)


def _nearest(points: Points, wanted: tuple[float, float, float]) -> int:
    return int(((points - np.array(wanted)) ** 2).sum(1).argmin())


def _closed(nodes: Points, opposite: int, count: int) -> Points:
    """A periodic cubic through nodes (k, 3) by chord length; half of the points before node `opposite`."""
    steps = np.maximum(np.linalg.norm(np.roll(nodes, -1, 0) - nodes, axis=1), 1e-6)
    at = np.r_[0.0, np.cumsum(steps)]
    half = count // 2
    there = np.linspace(0, at[opposite], half, endpoint=False)
    back = np.linspace(at[opposite], at[-1], half, endpoint=False)
    wanted: NDArray[np.float64] = np.r_[there, back]
    left = np.searchsorted(at, wanted, side="right") - 1
    return _spline(nodes, steps, left, (wanted - at[left])[:, None])


def _spline(nodes: Points, steps: NDArray[np.float64], left: NDArray[np.intp], into: Points) -> Points:
    """Points of the closed cubic spline, `into` (n, 1) beyond nodes `left` (n,); de Boor (1978), chapter IV.

    Its second derivatives at the nodes follow from slopes that are continuous there.
    """
    rows, right, before = np.arange(len(nodes)), (left + 1) % len(nodes), np.roll(steps, 1)
    system = np.diag(2 * (steps + before))
    system[rows, rows - 1] += before
    system[rows - 1, rows] += before
    slopes = (np.roll(nodes, -1, 0) - nodes) / steps[:, None]
    bend = np.linalg.solve(system, 6 * (slopes - np.roll(slopes, 1, 0)))
    step = steps[left][:, None]
    rest = step - into
    found: Points = (
        (bend[left] * rest**3 + bend[right] * into**3) / (6 * step)
        + (nodes[left] / step - bend[left] * step / 6) * rest
        + (nodes[right] / step - bend[right] * step / 6) * into
    )
    return found
