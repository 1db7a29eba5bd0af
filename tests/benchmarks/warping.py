"""Dynamic time warping (Sakoe and Chiba 1978): two courses of the same thing at other speeds, side by
side."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

BAND = 0.15
"""How far from the diagonal the path may go, as a part of the length."""


def warped(a: Floats, b: Floats) -> Floats:
    """`a`, shape (n, d), on the time of `b`, shape (m, d): (m, d). Columns count alike, whatever their
    size."""
    scale = np.maximum(b.std(axis=0), 1e-9)
    x, y = (a - a.mean(axis=0)) / scale, (b - b.mean(axis=0)) / scale
    n, m = len(a), len(b)
    near = np.abs(np.arange(n)[:, None] / n - np.arange(m) / m) <= BAND
    cost = np.where(near, ((x[:, None] - y) ** 2).sum(axis=2), np.inf)
    total = np.full((n + 1, m + 1), np.inf)
    total[0, 0] = 0.0
    for i in range(n):
        for j in np.flatnonzero(near[i]):
            total[i + 1, j + 1] = cost[i, j] + min(total[i, j], total[i, j + 1], total[i + 1, j])
    i, j = n, m
    rows: list[list[int]] = [[] for _ in range(m)]
    while i and j:
        rows[j - 1].append(i - 1)
        ways = (total[i - 1, j - 1], total[i - 1, j], total[i, j - 1])
        i, j = ((i - 1, j - 1), (i - 1, j), (i, j - 1))[int(np.argmin(ways))]
    return np.array([a[row].mean(axis=0) for row in rows])
