"""Layers joined to one picture: by bands across seams, and carried on where nothing was seen."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

Floats = NDArray[np.floating[Any]]

COARSE = 8.0
"""Blur, texels of 1024, that parts what is coarse from what is fine."""
WIDE, NARROW = 20.0, 2.5
"""Blur of the seams: for what is coarse, and for what is fine."""
COARSEST_BLUR = 4.0
"""Texels; wider Gaussians are taken over averages."""
LITTLE = 1e-3


def joined(pictures: Sequence[Floats], weights: Sequence[Floats]) -> Floats:
    """One picture (n, n, 3) of several, each with weights (n, n), 0 where it has nothing.

    What is coarse changes over a wide seam, what is fine over a narrow one (P. J. Burt, E. H. Adelson 1983, A
    multiresolution spline with application to image mosaics).
    """
    unit = len(weights[0]) / 1024
    bases = [_coarse(picture, weight, unit) for picture, weight in zip(pictures, weights, strict=True)]
    fine, narrow = np.zeros(pictures[0].shape, np.float32), np.zeros(weights[0].shape, np.float32)
    coarse, wide = np.zeros(bases[0][0].shape, np.float32), np.zeros(bases[0][1].shape, np.float32)
    for picture, weight, (base, broad) in zip(pictures, weights, bases, strict=True):
        sharp = blurred(weight, NARROW * unit) * (weight > LITTLE)
        fine += sharp[..., None] * (picture - _doubled(_doubled(base)))
        coarse += broad[..., None] * base
        narrow += sharp
        wide += broad
    fine /= np.maximum(narrow, LITTLE)[..., None]
    coarse /= np.maximum(wide, LITTLE)[..., None]
    return _doubled(_doubled(coarse)) + fine


def _coarse(picture: Floats, weight: Floats, unit: float) -> tuple[Floats, Floats]:
    """At a quarter of the size: what is coarse in a layer, carried on to where it has nothing, and its
    say.
    """
    say = _halved(_halved(weight[..., None]))
    light = _halved(_halved(picture * weight[..., None]))
    spread = blurred(say, COARSE * unit / 4)
    base = carried_on(
        blurred(light, COARSE * unit / 4) / np.maximum(spread, LITTLE), np.minimum(4 * spread[..., 0], 1)
    )
    return base, blurred(say, WIDE * unit / 4)[..., 0]


def carried_on(values: Floats, weights: Floats) -> Floats:
    """(n, n, c), n a power of two: values where weights (n, n) are 1, and smoothly what is near elsewhere
    (push and pull over a pyramid: S. J. Gortler and others 1996, The lumigraph, section 3.4).
    """
    if len(weights) == 1:
        total = np.maximum(weights, 1e-9)[..., None]
        return values / total * np.minimum(weights, 1)[..., None] if weights.max() > 0 else values * 0
    share = np.minimum(weights, 1.0)
    small_weight = _halved(share[..., None])[..., 0]
    small = _halved(values * share[..., None]) / np.maximum(small_weight, 1e-9)[..., None]
    below = carried_on(small, np.minimum(4 * small_weight, 1.0))
    above = _doubled(below)
    found: Floats = share[..., None] * values + (1 - share[..., None]) * above
    return found


def blurred(values: Floats, blur: float) -> Floats:
    """(n, n, ...): Gaussian over the first two axes; a wide one over fewer, averaged texels."""
    flat = values.reshape(*values.shape[:2], -1)
    halvings = 0
    while blur > COARSEST_BLUR and len(flat) % 2 == 0:
        flat, blur, halvings = _halved(flat), blur / 2, halvings + 1
    small = ndimage.gaussian_filter(flat, (blur, blur, 0), truncate=3.0)
    for _ in range(halvings):
        small = _doubled(small)
    found: Floats = small.reshape(values.shape)
    return found


def _halved(values: Floats) -> Floats:
    n = len(values) // 2
    rows = values[: 2 * n : 2] + values[1 : 2 * n : 2]
    found: Floats = (rows[:, : 2 * n : 2] + rows[:, 1 : 2 * n : 2]) / 4
    return found


def _doubled(values: Floats) -> Floats:
    """Twice as many texels each way: a quarter of the way to the next one, three quarters their own."""
    for axis in (0, 1):
        edge = np.pad(values, [(1, 1) if k == axis else (0, 0) for k in range(3)], mode="edge")
        before, after = (np.take(edge, range(s, s + values.shape[axis]), axis) for s in (0, 2))
        both = np.stack([0.75 * values + 0.25 * before, 0.75 * values + 0.25 * after], axis + 1)
        shape = list(values.shape)
        shape[axis] *= 2
        values = both.reshape(shape)
    return values
