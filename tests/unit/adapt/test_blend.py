"""Layers joined to one picture."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import ndimage

from fapstream.adapt.blend import blurred, carried_on, joined


def test_a_wide_blur_over_averages_is_a_gaussian() -> None:
    picture = np.random.default_rng(0).normal(size=(128, 128, 2))
    wanted = ndimage.gaussian_filter(picture, (12, 12, 0))
    found = blurred(picture, 12.0)
    assert np.abs(found - wanted)[24:-24, 24:-24].max() < 0.35 * wanted.std()
    point = np.zeros((128, 128))
    point[64, 64] = 1
    assert blurred(point, 12.0).sum() == pytest.approx(1, abs=0.02)
    assert blurred(np.ones((64, 64)), 9.0) == pytest.approx(np.ones((64, 64)))


def test_one_layer_is_itself() -> None:
    picture = np.random.default_rng(1).uniform(size=(256, 256, 3)).astype(np.float32)
    weight = np.zeros((256, 256), np.float32)
    weight[:, :160] = 1
    np.testing.assert_allclose(joined([picture], [weight])[:, :150], picture[:, :150], atol=1e-4)


def test_a_seam_is_wide_for_what_is_coarse_and_narrow_for_what_is_fine() -> None:
    n = 512
    stripes = np.where(np.arange(n) % 4 < 2, 0.1, -0.1)[:, None, None] * np.ones((n, n, 3))
    left, right = 0.3 + stripes, 0.6 + 0 * stripes
    share = (np.arange(n) < n / 2)[None, :] * np.ones((n, n))
    found = joined([left, right], [share, 1 - share])
    row = found.mean(0)[:, 0]
    assert row[40] == pytest.approx(0.3, abs=0.01)
    assert row[-40] == pytest.approx(0.6, abs=0.01)
    assert np.abs(np.diff(row)).max() < 0.02, "no step in brightness"
    fine = found.std(0)[:, 0]
    assert fine[n // 2 - 12] > 0.09, "detail is there to near the seam"
    assert fine[n // 2 + 12] < 0.01


def test_what_is_known_stays_and_goes_on_smoothly() -> None:
    values, weights = np.zeros((64, 64, 1)), np.zeros((64, 64))
    values[:, :8], weights[:, :8] = 2.0, 1.0
    values[:, 56:], weights[:, 56:] = 4.0, 1.0
    found = carried_on(values, weights)[..., 0]
    assert (found[:, :8] == 2).all()
    assert (found[:, 56:] == 4).all()
    middle = found[32, 8:56]
    assert middle.min() >= 2 - 1e-6
    assert middle.max() <= 4 + 1e-6
    assert middle[:12].mean() < 2.6
    assert middle[-12:].mean() > 3.4
    assert not carried_on(values, weights * 0).any()
