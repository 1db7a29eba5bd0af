"""Umeyama's closed form against the paper's own way: Euler angles by Levenberg and Marquardt (section
2.2).
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import least_squares

from fapstream.adapt.rigid import Similarity

Floats = NDArray[np.float64]


def euler(omega: float, phi: float, kappa: float) -> Floats:
    """R = R(kappa) R(phi) R(omega), equations 3 and 4 (a left-handed system: clockwise turns)."""
    (so, sp, sk), (co, cp, ck) = np.sin([omega, phi, kappa]), np.cos([omega, phi, kappa])
    about_x = np.array([[1, 0, 0], [0, co, so], [0, -so, co]])
    about_y = np.array([[cp, 0, -sp], [0, 1, 0], [sp, 0, cp]])
    about_z = np.array([[ck, sk, 0], [-sk, ck, 0], [0, 0, 1]])
    return np.asarray(about_z @ about_y @ about_x)


def by_euler(source: Floats, target: Floats) -> tuple[float, Floats, Floats]:
    """The minimum of equation 5, with a scale as the paper's step 2 wants."""
    result = least_squares(
        lambda p: (p[6] * source @ euler(*p[:3]).T + p[3:6] - target).ravel(),
        [0, 0, 0, 0, 0, 0, 1],
        method="lm",
    )
    return result.x[6], euler(*result.x[:3]), result.x[3:6]


@pytest.mark.parametrize("seed", range(12))
def test_closed_form_is_the_papers_minimum(seed: int) -> None:
    rng = np.random.default_rng(seed)
    source = rng.normal(size=(20, 3))
    target = rng.uniform(0.5, 2) * source @ euler(*rng.uniform(-0.9, 0.9, 3)).T + rng.normal(size=3)
    target += rng.normal(0, 0.1, target.shape)
    fit = Similarity.fit(source, target)
    scale, rotation, translation = by_euler(source, target)
    assert fit.scale == pytest.approx(scale, rel=1e-5)
    np.testing.assert_allclose(fit.rotation, rotation, atol=1e-5)
    np.testing.assert_allclose(fit.translation, translation, atol=1e-5)


@given(st.integers(0, 10**6))
def test_exact_points_give_back_what_moved_them(seed: int) -> None:
    rng = np.random.default_rng(seed)
    source = rng.normal(size=(5, 3))
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    moved = Similarity(1.7, turn, rng.normal(size=3))
    fit = Similarity.fit(source, moved(source))
    np.testing.assert_allclose(fit(source), moved(source), atol=1e-9)
    np.testing.assert_allclose(fit.inverse()(fit(source)), source, atol=1e-9)


def test_mirrored_points_are_not_reached_by_mirroring() -> None:
    source = np.random.default_rng(1).normal(size=(9, 3))
    fit = Similarity.fit(source, source * (-1, 1, 1))
    assert np.linalg.det(fit.rotation) == pytest.approx(1)


def test_weights_choose_and_points_on_a_line_or_in_one_place_do_no_harm() -> None:
    source = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5]])
    target = source + (1, 2, 3)
    target[3] = (-9, 9, 0)
    fit = Similarity.fit(source, target, np.array([1.0, 1, 1, 0]))
    np.testing.assert_allclose(fit(source[:3]), target[:3], atol=1e-9)
    line = np.outer(np.arange(4.0), [1, 2, 0])
    assert np.isfinite(Similarity.fit(line, line @ euler(0.3, 0.2, 0.1).T).rotation).all()
    assert Similarity.fit(np.zeros((4, 3)), np.ones((4, 3))).scale == 1.0
