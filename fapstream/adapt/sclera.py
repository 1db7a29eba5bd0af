"""The eye in a profile: the patch beside the root of the nose that has less red in it than skin."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, label

from fapstream.adapt.crop import Crop
from fapstream.adapt.silhouette import Laid, Seen, chain, proportioned

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

SIDE = 96
"""Pixels of the square in which the eye is looked for."""
SHOWN = 0.36
"""Its side, heights of the face."""
SOFT = 1.0
"""sd of the blur, pixels."""
AROUND, OUTLINE = 26.0, 8.0
"""How far from where an eye is expected it is looked for, and how far it is from the outline, pixels."""
LEAST_REDNESS = 0.08
"""Between skin and the eye, of (red - blue) / (red + green + blue); photos without colour have none."""
PALEST = 1.5
"""Percentile of redness that is the eye's."""
SMALLEST, WIDEST, HIGHEST = 15, 40, 45
"""Pixels: area, width and height of what may be an eye."""
NEAR = 0.25
"""What a pixel of distance takes from how well a patch, by the root of its area, may be the eye."""
WAYS = {"3.7": (-1.0, 0.0), "3.1": (0.5, -1.0), "3.3": (0.5, 1.0)}
"""Which way from the middle of the eye its corner and the middles of the lids lie, the nose to the right."""
LAST = 0.06
"""Of the patch: whose mean is its end in a direction."""
BESIDE = {"3.7": (-0.0079, -0.0079), "3.1": (0.0058, -0.0117), "3.3": (0.0049, 0.0045)}
"""From such an end to the point itself, heights of the face: at lids it is in shadow."""
CONFIDENCE = 0.25


def profile_eye(picture: NDArray[np.uint8], laid: Laid) -> Mapping[str, Seen]:
    """x and y, pixels, and confidence of the outer corner and the lids, by their names on the left.

    Nothing where no eye stands out: without colour, under hair.
    """
    side = -1.0 if laid.facing == "left" else 1.0
    expected = proportioned(laid)
    root = laid.points[chain().names.index("nasion")]
    middle = (expected["3.7"] + root) / 2
    crop = Crop((float(middle[0]), float(middle[1])), SHOWN * laid.height, laid.tilt * side)
    flip = np.array([side, 1.0])
    both = np.array([np.mean([expected[name] for name in WAYS], axis=0), root])
    guess, root = ((crop.find(both) - 0.5) * flip + 0.5) * SIDE
    patch = _patch(crop.cut(picture, SIDE)[:, :: int(side)], guess, float(root[0]))
    seen = {}
    for name, way in WAYS.items() if patch.any() else ():
        at = _end(patch, way) / SIDE - 0.5 + np.array(BESIDE[name]) / SHOWN
        x, y = crop.place(at * flip + 0.5).tolist()
        seen[name] = (x, y, CONFIDENCE)
    return seen


def _patch(shown: NDArray[np.float32], expected: Floats, root: float) -> Mask:
    """(SIDE, SIDE): the eye, about `expected` (2,) and behind the root of the nose; all False for none."""
    soft = gaussian_filter(shown.astype(float), (SOFT, SOFT, 0))
    redness = (soft[..., 0] - soft[..., 2]) / (soft.sum(-1) + 20)
    y, x = np.mgrid[:SIDE, :SIDE] + 0.5
    near = (np.hypot(x - expected[0], y - expected[1]) < AROUND) & (x < root - OUTLINE)
    none = np.zeros((SIDE, SIDE), bool)
    if near.sum() < SMALLEST:
        return none
    skin, eye = np.median(redness[near]), np.percentile(redness[near], PALEST)
    if not skin - eye > LEAST_REDNESS:
        return none
    pieces, count = label(near & (redness < (skin + eye) / 2))
    rated = [(_rated(pieces == k, (skin - redness) / (skin - eye), expected), k) for k in range(1, count + 1)]
    best, k = max(rated, default=(-np.inf, 0))
    return pieces == k if best > -np.inf else none


def _rated(piece: Mask, paleness: Floats, expected: Floats) -> float:
    """How well a piece may be the eye; -inf if it cannot."""
    rows, columns = np.nonzero(piece)
    if len(rows) < SMALLEST or np.ptp(rows) >= HIGHEST or np.ptp(columns) >= WIDEST:
        return -np.inf
    away = np.hypot(columns.mean() + 0.5 - expected[0], rows.mean() + 0.5 - expected[1])
    return float(np.sqrt(len(rows)) * paleness[piece].mean() - NEAR * away)


def _end(patch: Mask, way: tuple[float, float]) -> Floats:
    """The end (2,) of a patch in a direction (x, y), pixels."""
    rows, columns = np.nonzero(patch)
    points = np.column_stack([columns, rows]) + 0.5
    order = np.argsort(-(points @ np.array(way)), kind="stable")
    end: Floats = points[order[: max(2, int(LAST * len(points)))]].mean(0)
    return end
