"""Pupils: an iris is the disc of an eye that is darker than what surrounds it between the lids."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import fftconvolve

from fapstream.adapt.crop import Crop

Floats = NDArray[np.float64]

SIDE = 64
"""Pixels of the square an eye is looked at in."""
SHOWN = 1.5
"""Its side, over the width of the eye."""
RADII = (0.17, 0.19, 0.21, 0.23)
"""Of an iris, over the width of the eye (11.7 mm across, an opening of 28 to 32)."""
RING = 1.4
"""Outer radius of what surrounds it."""
STRAIGHT = 0.12
"""sd of the iris' middle about that of the opening, over its width, in someone who looks at the camera."""
LUMA = np.array([0.299, 0.587, 0.114], np.float32)
LEAST = 0.1
"""Contrast, of the spread of brightness, under which there is nothing to be seen."""


def find_pupil(picture: NDArray[np.uint8], lids: Floats) -> tuple[Floats, float]:
    """The pupil (2,) in an eye with `lids` (n, 2), its outline, pixels; and the contrast 0..1 of its iris.

    Where nothing stands out it is the middle of the opening, with contrast 0.
    """
    middle, width = (lids.min(0) + lids.max(0)) / 2, float(np.ptp(lids[:, 0]))
    crop = Crop((float(middle[0]), float(middle[1])), max(SHOWN * width, 1.0))
    grey = crop.cut(picture, SIDE) @ LUMA
    opening = inside(crop.find(lids) * SIDE)
    # highlights are brighter than any white of an eye, lashes darker than any iris: cut both
    low, high = np.percentile(grey[opening], (5, 85)) if opening.any() else (0.0, 0.0)
    if not high > low:
        return middle, 0.0
    darkness = (high - np.clip(grey, low, high)) / (high - low)
    at, contrast = max(
        (_best(darkness, opening, share * SIDE / SHOWN) for share in RADII), key=lambda b: b[1]
    )
    if contrast < LEAST:
        return middle, 0.0
    return crop.place(at / SIDE), min(contrast, 1.0)


def _best(darkness: NDArray[np.float32], opening: NDArray[np.bool_], radius: float) -> tuple[Floats, float]:
    """Where a disc of that radius stands out most, (x, y), and how much."""
    disc, ring = _disc(radius), _disc(RING * radius)
    margin = (len(ring) - len(disc)) // 2
    ring -= np.pad(disc, margin)
    seen = opening.astype(float)
    inner, outer = (
        fftconvolve(darkness * seen, k, "same") / np.maximum(fftconvolve(seen, k, "same"), 0.25 * k.sum())
        for k in (disc, ring)
    )
    at = np.arange(SIDE) + 0.5 - SIDE / 2
    bent = (at[:, None] ** 2 + at[None, :] ** 2) * (SHOWN / SIDE) ** 2 / (2 * STRAIGHT**2)
    score = inner - outer - 0.1 * bent
    y, x = np.unravel_index(int(score.argmax()), score.shape)
    return np.array([x + 0.5 + _between(score[y], x), y + 0.5 + _between(score[:, x], y)]), float(score[y, x])


def _between(row: Floats, at: np.intp) -> float:
    """How far off the middle of its pixel the top of a parabola through three values lies."""
    if not 0 < at < len(row) - 1:
        return 0.0
    a, b, c = row[at - 1 : at + 2]
    bend = a - 2 * b + c
    return float(np.clip(0.5 * (a - c) / bend, -0.5, 0.5)) if bend < 0 else 0.0


def _disc(radius: float) -> Floats:
    """(n, n), odd: 1 in a circle, 0 outside, with a soft edge."""
    n = int(np.ceil(radius)) + 1
    at = np.arange(-n, n + 1)
    disc: Floats = np.clip(radius + 0.5 - np.hypot(at[:, None], at[None, :]), 0, 1)
    return disc


def inside(polygon: Floats) -> NDArray[np.bool_]:
    """(SIDE, SIDE): which pixels have their middle in a polygon (n, 2)."""
    at = np.arange(SIDE) + 0.5
    x, y = np.meshgrid(at, at)
    odd = np.zeros((SIDE, SIDE), bool)
    for (x1, y1), (x2, y2) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        if y1 != y2:
            odd ^= ((y1 > y) != (y2 > y)) & (x < (x2 - x1) * (y - y1) / (y2 - y1) + x1)
    return odd
