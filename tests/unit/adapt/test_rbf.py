"""Radial basis functions (section 3)."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.adapt.rbf import fit_radial, wu
from tests.unit.adapt.persons import made_up, places

SOURCE = np.array(list(places().values()))


def test_wus_function() -> None:
    """Equation 19; positive, falling, smooth at its support's end."""
    r = np.linspace(0, 1.5, 301)
    values = wu(r)
    assert values[0] == 6
    assert wu(np.array([0.5]))[0] == pytest.approx(0.5**6 * (6 + 18 + 20.5 + 9 + 1.875 + 0.15625))
    assert (np.diff(values) <= 0).all()
    assert (values[r >= 1] == 0).all()
    assert wu(np.array([0.99]))[0] < 1e-9


def test_every_point_is_met_and_the_side_conditions_hold() -> None:
    target = np.array(list(made_up(0).values()))
    warp = fit_radial(SOURCE, target)
    np.testing.assert_allclose(warp(SOURCE), target, atol=1e-9)
    np.testing.assert_allclose(warp.weights.sum(0), 0, atol=1e-9)
    np.testing.assert_allclose(warp.weights.T @ SOURCE, 0, atol=1e-9)


def test_affine_changes_are_reproduced_everywhere() -> None:
    matrix = np.array([[1.1, 0.05, 0], [0, 0.9, 0.1], [0, 0, 1.2]])
    warp = fit_radial(SOURCE, SOURCE @ matrix.T + 0.01)
    far = np.random.default_rng(0).normal(0, 1, (5, 3))
    np.testing.assert_allclose(warp(far), far @ matrix.T + 0.01, atol=1e-7)
    np.testing.assert_allclose(warp.matrix, matrix, atol=1e-8)
