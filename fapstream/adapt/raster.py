"""Triangles to pixels, all at once: which pixels each covers, and what is nearest."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.floating[Any]]
Ints = NDArray[np.int64]

EDGE = 1e-4
"""Pixel centres so little outside a triangle, in shares of it, still count: no cracks between neighbours."""
AT_ONCE = 1 << 21
"""Pixels that are tried at the same time."""


@dataclass(frozen=True, slots=True)
class Cover:
    """Pixels that triangles cover: flat numbers `pixels` (k,), `triangles` (k,) and the shares (k, 3) of
    the corners.
    """

    pixels: Ints
    triangles: Ints
    shares: Floats

    def mixed(self, corners: Ints, values: Floats) -> Floats:
        """(k, ...): what vertices have, `values` (n, ...), at the pixels; `corners` (m, 3) are the
        triangles'.
        """
        found: Floats = np.einsum("kc,kc...->k...", self.shares, values[corners[self.triangles]])
        return found


def cover(points: Floats, triangles: Ints, size: tuple[int, int]) -> Cover:
    """What triangles (m, 3) of points (n, 2), in pixels, cover of a picture of `size` (width, height)."""
    found = list(_covers(points, triangles, size))
    if not found:
        return Cover(np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros((0, 3)))
    rows = zip(*((c.pixels, c.triangles, c.shares) for c in found), strict=True)
    pixels, numbers, shares = (np.concatenate(row) for row in rows)
    return Cover(pixels, numbers, shares)


def nearest(hits: Cover, closeness: Floats, size: tuple[int, int]) -> tuple[Ints, Floats]:
    """For each pixel of a picture the number in `hits` of what is nearest, -1 where there is nothing, and
    how near, -inf there; both (height, width). `closeness` (k,): larger is nearer.
    """
    order = np.argsort(closeness, kind="stable")
    chosen = np.full(size[0] * size[1], -1, np.int64)
    chosen[hits.pixels[order]] = order
    near = np.where(chosen >= 0, np.append(closeness, -np.inf)[chosen], -np.inf)
    return chosen.reshape(size[1], size[0]), near.reshape(size[1], size[0])


def _covers(points: Floats, triangles: Ints, size: tuple[int, int]) -> Iterator[Cover]:
    """By size of the triangles, so that those of a group can share a square of pixels each."""
    corners = points[triangles]
    sound = np.asarray(np.isfinite(corners).all((1, 2)))
    corners = np.where(sound[:, None, None], corners, -1.0)
    low = np.maximum(np.ceil(corners.min(1) - 0.5), 0).astype(np.int64)
    high = np.minimum(np.floor(corners.max(1) - 0.5), np.array(size) - 1).astype(np.int64)
    wide = (high - low).max(1) + 1
    usable = (high >= low).all(1) & sound
    side = 1
    while usable.any():
        group = np.flatnonzero(usable & (wide <= side))
        usable[group] = False
        step = max(1, AT_ONCE // side**2)
        for start in range(0, len(group), step):
            some = group[start : start + step]
            yield _inside(corners[some], some, low[some], high[some], side, size[0])
        side *= 2


def _inside(corners: Floats, numbers: Ints, low: Ints, high: Ints, side: int, width: int) -> Cover:
    y, x = np.mgrid[:side, :side].reshape(2, -1)
    column, row = low[:, :1] + x, low[:, 1:] + y
    (ax, ay), (bx, by), (cx, cy) = (corners[:, k].T[:, :, None] for k in range(3))
    area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
    area = np.where(np.abs(area) < 1e-12, np.inf, area)
    px, py = column + 0.5 - ax, row + 0.5 - ay
    s = (px * (cy - ay) - (cx - ax) * py) / area
    t = ((bx - ax) * py - px * (by - ay)) / area
    hit = (s >= -EDGE) & (t >= -EDGE) & (s + t <= 1 + EDGE) & np.isfinite(area)
    hit &= (column <= high[:, :1]) & (row <= high[:, 1:])
    which, _ = np.nonzero(hit)
    shares = np.stack([1 - s[hit] - t[hit], s[hit], t[hit]], 1)
    return Cover((row * width + column)[hit], numbers[which], shares)
