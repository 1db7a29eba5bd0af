"""Hermite interpolation against scipy: fpd-mpeg4-talking-head equation 20, Fritsch and Butland (1984)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

from fapstream.motion.hermite import hermite, limited_slope

VALUE = st.integers(-100_000, 100_000).map(float)
WIDTH = st.integers(1, 5000).map(float)


@given(VALUE, VALUE, VALUE, VALUE, WIDTH)
def test_hermite_is_the_cubic_spline(a1: float, a2: float, d1: float, d2: float, width: float) -> None:
    spline = CubicHermiteSpline([0, width], [a1, a2], [d1, d2])
    x = np.linspace(0, 1, 9)
    ours = np.array([hermite(v, *(np.array([q]) for q in (a1, a2, width * d1, width * d2)))[0] for v in x])
    size = max(1.0, abs(a1), abs(a2), abs(width * d1), abs(width * d2))
    assert ours == pytest.approx(spline(x * width), abs=1e-9 * size)


@given(st.lists(st.tuples(WIDTH, VALUE), min_size=3, max_size=12))
def test_slopes_are_those_of_pchip(points: list[tuple[float, float]]) -> None:
    at = np.cumsum([w for w, _ in points])
    values = np.array([v for _, v in points])
    oracle = PchipInterpolator(at, values).derivative()(at)
    for i in range(1, len(at) - 1):
        slope = limited_slope(
            at[i] - at[i - 1],
            at[i + 1] - at[i],
            np.array([values[i] - values[i - 1]]),
            np.array([values[i + 1] - values[i]]),
        )
        assert slope[0] == pytest.approx(oracle[i], rel=1e-9, abs=1e-9)


@given(st.lists(st.tuples(WIDTH, VALUE), min_size=4, max_size=4))
def test_no_interval_overshoots_or_turns(points: list[tuple[float, float]]) -> None:
    """Between two keyframes the curve stays between their values and moves one way only."""
    at = np.cumsum([w for w, _ in points])
    v = np.array([[value] for _, value in points])
    d1 = limited_slope(at[1] - at[0], at[2] - at[1], v[1] - v[0], v[2] - v[1])
    d2 = limited_slope(at[2] - at[1], at[3] - at[2], v[2] - v[1], v[3] - v[2])
    width = at[2] - at[1]
    curve = np.array([hermite(x, v[1], v[2], width * d1, width * d2)[0] for x in np.linspace(0, 1, 101)])
    way = np.sign(v[2, 0] - v[1, 0])
    assert (np.diff(curve) * (way or 1.0) >= -1e-6).all()
    assert curve.min() >= min(v[1, 0], v[2, 0]) - 1e-6
    assert curve.max() <= max(v[1, 0], v[2, 0]) + 1e-6


def test_slope_is_zero_at_extremes_and_where_the_curve_is_flat() -> None:
    rises = np.array([3.0, 3.0, 0.0, -2.0])
    falls = np.array([-1.0, 0.0, 5.0, -2.0])
    assert limited_slope(1.0, 1.0, rises, falls).tolist() == [0.0, 0.0, 0.0, -2.0]
