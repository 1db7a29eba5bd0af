"""Turned squares cut out of pictures, and the way back."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

Floats = NDArray[np.float64]
Picture = NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class Crop:
    """A square in a picture: its middle (x, y) and side in pixels, turned clockwise by `angle`, radians."""

    middle: tuple[float, float]
    side: float
    angle: float = 0.0

    @classmethod
    def whole(cls, width: int, height: int) -> Crop:
        """The smallest square with all of a picture in its middle."""
        return cls((width / 2, height / 2), float(max(width, height)))

    @property
    def axes(self) -> Floats:
        """(2, 2): the square's right and down in the picture, of unit length, as rows."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return np.array([[c, s], [-s, c]])

    def place(self, points: Floats) -> Floats:
        """Points (..., 2) of the square, 0..1, in pixels of the picture."""
        placed: Floats = (points - 0.5) * self.side @ self.axes + self.middle
        return placed

    def find(self, points: Floats) -> Floats:
        """Pixels (..., 2) of the picture in the square, 0..1: the inverse of `place`."""
        found: Floats = (points - np.array(self.middle)) @ self.axes.T / self.side + 0.5
        return found

    def cut(self, picture: NDArray[np.uint8] | NDArray[np.float32], n: int) -> NDArray[np.float32]:
        """The square (n, n, c) of a picture (h, w, c), in the picture's unit; black beyond its edges.

        Where the square has more pixels than `n`, they are averaged first, so that nothing flickers.
        """
        blocks = max(1, int(self.side / n))
        middle = (np.arange(n) + 0.5) / n
        grid = self.place(np.stack(np.meshgrid(middle, middle), -1))
        # only what is shown is averaged: a photo may be a hundred times larger
        (left, top), (right, bottom) = _around(grid, picture.shape, 2 * blocks)
        small = _averaged(picture[top:bottom, left:right], blocks)
        grid = (grid - (left, top)) / blocks - 0.5
        at = [grid[..., 1], grid[..., 0]]
        layers = [
            map_coordinates(layer, at, order=1, output=np.float32) for layer in np.moveaxis(small, 2, 0)
        ]
        cut: NDArray[np.float32] = np.stack(layers, -1)
        return cut


def _around(grid: Floats, shape: tuple[int, ...], margin: int) -> tuple[tuple[int, int], tuple[int, int]]:
    """First and last corner (x, y) of what a picture has of a grid (n, n, 2), pixels, never nothing."""
    limit = np.array([shape[1], shape[0]])
    first = np.clip(np.floor(grid.min((0, 1))) - margin, 0, limit - 1).astype(int)
    last = np.clip(np.ceil(grid.max((0, 1))) + margin, first + 1, limit).astype(int)
    return (int(first[0]), int(first[1])), (int(last[0]), int(last[1]))


def _averaged(picture: NDArray[np.uint8] | NDArray[np.float32], n: int) -> NDArray[np.float32]:
    """float32 (ceil(h / n), ceil(w / n), c): means of n x n pixels; the last repeat the picture's edge."""
    if n == 1:
        return picture.astype(np.float32)
    h, w = picture.shape[:2]
    full = np.pad(picture, ((0, -h % n), (0, -w % n), (0, 0)), mode="edge")
    rows = np.add.reduceat(full, np.arange(0, full.shape[0], n), axis=0, dtype=np.float32)
    sums: NDArray[np.float32] = np.add.reduceat(rows, np.arange(0, full.shape[1], n), axis=1)
    return sums / np.float32(n * n)
