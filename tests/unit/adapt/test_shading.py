"""The light in photos."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.adapt.shading import LUMINANCE, calibration, encoded, harmonics, linear, unlit, unrendered


def directions(count: int = 4000) -> np.ndarray:
    rows = np.random.default_rng(0).normal(size=(count, 3)) * (1, 1, 0.6) + (0, 0, 1)
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def test_srgb_comes_back() -> None:
    every = np.arange(256, dtype=np.uint8)
    assert np.array_equal(encoded(linear(every)), every)
    assert linear(np.array([255.0]))[0] == pytest.approx(1)
    assert linear(np.array([188.0]))[0] == pytest.approx(0.5, abs=0.01)


def test_light_from_one_side_is_taken_out_and_colour_stays() -> None:
    normals = directions()
    albedo = np.array([0.5, 0.3, 0.2]) * (1 + 0.1 * np.random.default_rng(1).normal(size=(len(normals), 1)))
    lamp = np.array([0.6, 0.4, 0.7]) / np.linalg.norm([0.6, 0.4, 0.7])
    lit = albedo * (0.35 + 0.65 * np.clip(normals @ lamp, 0, 1))[:, None]
    flat = unlit(lit, normals, np.ones(len(normals)))
    spread = lambda rows: np.std(np.log(rows @ LUMINANCE))  # noqa: E731
    assert spread(lit) > 2 * spread(albedo)
    assert spread(flat) < 1.35 * spread(albedo)
    np.testing.assert_allclose(flat[:, 0] / flat[:, 1], lit[:, 0] / lit[:, 1])
    assert np.log(flat @ LUMINANCE).mean() == pytest.approx(np.log(lit @ LUMINANCE).mean(), abs=0.02)


def test_dark_features_do_not_pass_for_shadow() -> None:
    normals = directions()
    brow = normals[:, 1] > 0.6
    albedo = np.where(brow, 0.03, 0.4)[:, None] * np.ones(3)
    flat = unlit(albedo, normals, np.where(brow, 0.0, 1.0))
    assert flat[~brow].std() < 0.02
    assert np.median(flat[brow]) < 0.1


def test_no_weights_and_no_light_are_no_numbers_lost() -> None:
    normals = directions(50)
    assert np.isfinite(unlit(np.zeros((50, 3)), normals, np.ones(50))).all()
    assert np.isfinite(unlit(np.ones((50, 3)), normals, np.zeros(50))).all()


def test_calibration_is_the_papers() -> None:
    """I' = A I + B with A = s_fr / s_pr and B = m_fr - A m_pr, per channel."""
    rng = np.random.default_rng(2)
    there = rng.normal(0.4, 0.1, (3000, 3))
    here = there * (1.2, 0.9, 0.8) + (0.02, 0.05, -0.01)
    factor, shift = calibration(here, there, np.ones(3000))
    np.testing.assert_allclose(factor, (1.2, 0.9, 0.8), rtol=1e-6)
    np.testing.assert_allclose(shift, (0.02, 0.05, -0.01), atol=1e-6)
    assert np.isfinite(calibration(here, there * 0, np.zeros(3000))[0]).all()


def test_harmonics_are_orthogonal_over_the_sphere() -> None:
    rows = np.random.default_rng(3).normal(size=(200000, 3))
    basis = harmonics(rows / np.linalg.norm(rows, axis=1, keepdims=True))
    gram = basis.T @ basis / len(basis)
    assert np.abs(gram - np.diag(np.diag(gram))).max() < 0.01


def test_what_is_shown_brighter_has_a_brighter_picture() -> None:
    light = np.linspace(0.01, 0.9, 50)[:, None] * np.ones(3)
    picture = unrendered(light)
    assert (np.diff(picture, axis=0) >= 0).all()
    assert picture.max() <= 1
