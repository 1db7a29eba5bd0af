"""Smooth warps: diffeomorphisms, and the most probable face."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.adapt.covariance import Covariance
from fapstream.adapt.smooth import GaussianWarp, fit_diffeomorphism, fit_probable
from fapstream.adapt.warp import jacobians
from tests.unit.adapt.persons import made_up, places

SOURCE = np.array(list(places().values()))
SPACE = np.random.default_rng(1).uniform(-0.1, 0.13, (4000, 3))


def test_slopes_are_those_of_the_appendix() -> None:
    """Df = 1 - sum K b (x - x_k)^T / sigma^2."""
    rng = np.random.default_rng(2)
    warp = GaussianWarp(SOURCE, rng.normal(0, 0.002, SOURCE.shape), 0.03)
    at = rng.normal(0, 0.06, (6, 3))
    np.testing.assert_allclose(warp.jacobians(at), jacobians(warp, at), atol=1e-4)


def test_one_large_step_folds_space_and_small_ones_do_not() -> None:
    """Two points that change places by more than the kernel bears."""
    source = np.array([[0.0, 0, 0], [0.02, 0, 0]])
    target = np.array([[0.015, 0, 0], [0.02, 0.001, 0]])
    kernel = np.exp(-((source[:, None] - source) ** 2).sum(-1) / (2 * 0.01**2))
    once = GaussianWarp(source, np.linalg.solve(kernel, target - source), 0.01)
    line = np.c_[np.linspace(-0.01, 0.04, 200), np.zeros((200, 2))]
    assert np.linalg.det(once.jacobians(line)).min() < 0, "the plain sum is no diffeomorphism here"
    steps = fit_diffeomorphism(source, target, 0.01)
    assert len(steps.warps) > 3
    assert np.linalg.det(jacobians(steps, line)).min() > 0
    np.testing.assert_allclose(steps(source), target, atol=3e-4)


@pytest.mark.parametrize("seed", range(4))
def test_faces_are_met_without_folding(seed: int) -> None:
    target = np.array(list(made_up(seed).values()))
    warp = fit_diffeomorphism(SOURCE, target)
    assert np.linalg.norm(warp(SOURCE) - target, axis=1).max() < 1.5e-3
    assert np.linalg.det(jacobians(warp, SPACE)).min() > 0


@pytest.mark.parametrize("seed", range(4))
def test_the_most_probable_face_meets_points_within_their_noise(seed: int) -> None:
    target = np.array(list(made_up(seed).values()))
    faces = Covariance()
    exact, loose = (fit_probable(SOURCE, target, noise, faces) for noise in (1e-6, 2e-3))
    assert np.linalg.norm(exact(SOURCE) - target, axis=1).mean() < 2e-4
    assert (
        np.linalg.norm(loose(SOURCE) - target, axis=1).mean()
        > np.linalg.norm(exact(SOURCE) - target, axis=1).mean()
    )
    assert np.linalg.det(jacobians(exact, SPACE)).min() > 0
    far = np.array([[0.0, 2.0, 0.0]])
    np.testing.assert_allclose(exact(far), far, atol=1e-9)


def test_its_slopes_are_its_own() -> None:
    warp = fit_probable(SOURCE, np.array(list(made_up(1).values())), 1e-4, Covariance())
    np.testing.assert_allclose(warp.jacobians(SPACE[:20]), jacobians(warp, SPACE[:20]), atol=1e-4)  # type: ignore[attr-defined]
