"""The lips' contours as curves through their feature points (Reveret, Bailly and Badin 2000, section 3.1)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from fapstream.head.deform import deform
from fapstream.head.lips import INNER, OUTER, _closed, lip_contours
from fapstream.head.mesh import Head
from tests.unit.head.packaged import packaged


@pytest.fixture(scope="module")
def head() -> Head:
    return packaged()


def frame(values: dict[int, int]) -> np.ndarray:
    row = np.zeros(68, np.int32)
    for fap, value in values.items():
        row[fap - 1] = value
    return row


def test_the_curves_run_through_the_feature_points(head: Head) -> None:
    contours = lip_contours(head, deform(head, frame({})), 2000)
    for names, curve in ((INNER, contours.inner), (OUTER, contours.outer)):
        for name in names:
            gap = np.linalg.norm(curve - np.array(head.fdp[name]), axis=1).min()
            assert gap < 2e-4, name


def test_the_lips_touch_at_rest_and_part_by_fap_4_and_5(head: Head) -> None:
    unit = head.fapu.per_unit("MNS")
    assert lip_contours(head, deform(head, frame({}))).height < 0.01 * head.fapu.mw0
    parted = {4: -100, 8: -100, 9: -100, 5: -200, 10: -200, 11: -200}
    height = lip_contours(head, deform(head, frame(parted))).height
    assert height == pytest.approx(300 * unit, abs=0.08 * 300 * unit)


def test_stretching_the_corners_widens_the_mouth(head: Head) -> None:
    rest, wide = (lip_contours(head, deform(head, frame(f))).width for f in ({}, {6: 100, 7: 100}))
    assert wide - rest == pytest.approx(200 * head.fapu.per_unit("MW"), rel=0.15)


def test_density_changes_the_points_not_the_curve(head: Head) -> None:
    positions = deform(head, frame({5: -300, 10: -250, 11: -250}))
    few, many = (lip_contours(head, positions, n) for n in (32, 320))
    assert few.inner.shape == (32, 3)
    np.testing.assert_allclose(few.inner, many.inner[::10], atol=1e-9)
    assert few.height == pytest.approx(many.height, rel=0.02)


def test_the_curves_are_periodic_cubic_splines() -> None:
    nodes = np.random.default_rng(1).normal(size=(7, 3))
    at = np.r_[0, np.cumsum(np.linalg.norm(np.roll(nodes, -1, 0) - nodes, axis=1))]
    wanted = CubicSpline(at, np.vstack([nodes, nodes[:1]]), bc_type="periodic")
    there, back = np.linspace(0, at[3], 20, endpoint=False), np.linspace(at[3], at[-1], 20, endpoint=False)
    np.testing.assert_allclose(_closed(nodes, 3, 40), wanted(np.r_[there, back]), atol=1e-12)


@pytest.mark.parametrize("count", [7, 6, 0])
def test_a_count_that_makes_no_halves_is_refused(head: Head, count: int) -> None:
    with pytest.raises(ValueError, match="even number"):
        lip_contours(head, deform(head, frame({})), count)
