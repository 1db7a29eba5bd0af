"""Lips that must meet, and a lip that must meet the teeth, whatever the rest of the face does.

In MPEG-4 the lips of the neutral face touch, so they are apart by -(upper + lower) FAP units, upper being
positive down and lower positive up. `p b m` set that sum, `f v` the lower lip's place under the upper teeth.
What the lips do together (a smile's raised corners, its width) is not touched.

Every face may be one, shape (68,), or many, shape (n, 68), each with its own share, shape (n,).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fapstream.fap import visemes

Values = NDArray[np.float64]

CLOSED, BITTEN = 1, 2
"""The visemes that show how: p b m, and f v."""

UPPER = np.array([4, 8, 9, 51, 55, 56, 17]) - 1
LOWER = np.array([5, 10, 11, 52, 57, 58, 16]) - 1
"""Columns of FAPs that face each other; the last pair is how far the lips come forward."""
VERTICAL = slice(0, 6)
JAW = np.array([3, 14, 15, 18]) - 1

UPPER_SHARE = 0.3
"""What the upper lip does of the way that closes the lips; jaw and lower lip do the rest."""


def part(values: Values) -> None:
    """Lips do not go through each other: they are nowhere nearer than when pressed. In place."""
    upper, lower = UPPER[VERTICAL], LOWER[VERTICAL]
    pressed = visemes()[CLOSED]
    excess = np.maximum(0.0, values[..., upper] + values[..., lower] - (pressed[upper] + pressed[lower]))
    values[..., upper] -= 0.5 * excess
    values[..., lower] -= 0.5 * excess


def seal(values: Values, share: float | Values, jaw: bool = True) -> None:
    """Bring the lips to the distance that p, b and m have, at share 1 exactly, and the jaw if asked to. In
    place."""
    closed = visemes()[CLOSED]
    upper, lower = UPPER[VERTICAL], LOWER[VERTICAL]
    each = np.expand_dims(share, -1)
    way = each * (closed[upper] + closed[lower] - values[..., upper] - values[..., lower])
    values[..., upper] += UPPER_SHARE * way
    values[..., lower] += (1.0 - UPPER_SHARE) * way
    top, bottom = UPPER[-1], LOWER[-1]
    apart = share * (values[..., top] - values[..., bottom] - closed[top] + closed[bottom])
    values[..., top] -= apart / 2
    values[..., bottom] += apart / 2
    if jaw:
        values[..., JAW] += each * (closed[JAW] - values[..., JAW])


def bite(values: Values, share: float | Values, jaw: bool = True) -> None:
    """Bring the lower lip to the upper teeth as f and v do, and the jaw if asked to; the upper lip keeps
    clear. In place."""
    bitten = visemes()[BITTEN]
    each = np.expand_dims(share, -1)
    for columns in (LOWER, JAW) if jaw else (LOWER,):
        values[..., columns] += each * (bitten[columns] - values[..., columns])
    upper = UPPER[VERTICAL]
    values[..., upper] -= each * np.maximum(0.0, values[..., upper] - bitten[upper])
