"""Third-order Hermite interpolation between keyframes that never overshoots.

fpd-mpeg4-talking-head, equation 20, with both tangents: the paper's form has only the first, which
leaves a kink at every keyframe. Slopes are limited after Fritsch and Carlson (1980), "Monotone
piecewise cubic interpolation", with Fritsch and Butland's harmonic mean (1984).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]


def hermite(x: float | Values, a1: Values, a2: Values, g1: Values, g2: Values) -> Values:
    """f(x) = (2x^3-3x^2+1)a1 + (-2x^3+3x^2)a2 + (x^3-2x^2+x)g1 + (x^3-x^2)g2 for x in [0, 1].

    `g1`, `g2` are slope x interval. All arrays have one shape.
    """
    x2, x3 = x * x, x * x * x
    return (2 * x3 - 3 * x2 + 1) * a1 + (3 * x2 - 2 * x3) * a2 + (x3 - 2 * x2 + x) * g1 + (x3 - x2) * g2


def limited_slope(
    before: float | Values, after: float | Values, rise_before: Values, rise_after: Values
) -> Values:
    """Slope at a keyframe, in value per unit of time.

    `before`, `after`: the intervals to its neighbours; `rise_before`, `rise_after`: how much the
    values change over them. Zero where the keyframe is an extreme, else a weighted harmonic mean of
    the two chords, which keeps each interval monotone.
    """
    left, right = rise_before / before, rise_after / after
    same_way = left * right > 0
    weight_left, weight_right = 2 * after + before, after + 2 * before
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = (weight_left + weight_right) / (weight_left / left + weight_right / right)
    return np.where(same_way, mean, 0.0)
