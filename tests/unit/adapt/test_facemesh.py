"""From a mesh to named points: the table, the checks, and a mesh of which everything is known."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.adapt.crop import Crop
from fapstream.adapt.facemesh import (
    LIDS,
    check_front,
    check_profile,
    front_marks,
    glances,
    named,
    turned_deg,
)
from fapstream.adapt.found import EYES, MESH_POINTS
from fapstream.adapt.points import feature_points
from fapstream.errors import PhotoError

GREY = np.full((400, 300, 3), 128, np.uint8)


def mesh(turn_deg: float = 0.0, roll_deg: float = 0.0) -> np.ndarray:
    """(468, 3): points anywhere in a face of 200 pixels, eyes 100 apart, in the middle of GREY."""
    points = np.random.default_rng(1).uniform(-100, 100, (MESH_POINTS, 3)) * (1, 1, 0.3)
    points[list(EYES)] = [[-50, -30, 0], [50, -30, 0]]
    for angle, (a, b) in ((turn_deg, (0, 2)), (roll_deg, (0, 1))):
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        points[:, [a, b]] = points[:, [a, b]] @ np.array([[c, s], [-s, c]])
    return points + (150, 200, 0)


def test_all_points_of_a_front_photo_are_in_the_table_or_pupils() -> None:
    front = {name for name, point in feature_points().items() if "front" in point.views}
    assert set(named().names) | set(LIDS) == front
    assert not set(named().names) & set(LIDS)


def test_each_is_a_mean_of_few_and_a_pair_is_alike() -> None:
    table = named()
    np.testing.assert_allclose(table.weights.sum(1), 1)
    assert (np.count_nonzero(table.weights, axis=1) <= 3).all()
    assert ((table.confidence > 0) & (table.confidence <= 1)).all()
    rows = dict(zip(table.names, zip(table.weights, table.confidence, strict=True), strict=True))
    for name, (weights, sure) in rows.items():
        mirror = feature_points()[name].mirror
        if mirror:
            np.testing.assert_allclose(np.sort(weights), np.sort(rows[mirror][0]), atol=1e-9)
            assert sure == rows[mirror][1]


@pytest.mark.parametrize("turn", [-60.0, -20.0, 0.0, 35.0])
@pytest.mark.parametrize("roll", [0.0, 25.0])
def test_the_turn_is_told_whatever_the_roll(turn: float, roll: float) -> None:
    assert turned_deg(mesh(turn, roll)) == pytest.approx(turn, abs=0.01)


def test_a_front_photo_is_one() -> None:
    check_front(mesh(25), 0.99)
    with pytest.raises(PhotoError, match="turned by about 35 degrees"):
        check_front(mesh(-35), 0.99)
    for score in (0.7, 0.0, np.nan):
        with pytest.raises(PhotoError, match="is it a profile"):
            check_front(mesh(), score)
    with pytest.raises(PhotoError):
        check_front(np.full((MESH_POINTS, 3), np.nan), 1.0)


def test_a_profile_is_not_from_the_front() -> None:
    check_profile(mesh(20), 0.8)
    check_profile(mesh(64), 1.0)
    check_profile(np.full((MESH_POINTS, 3), np.nan), np.nan)
    with pytest.raises(PhotoError, match="only about 40 degrees"):
        check_profile(mesh(40), 0.99)


def test_points_are_where_the_table_says() -> None:
    marks = front_marks(GREY, mesh(), 0.5)
    table = named()
    k = table.names.index("8.1")
    assert marks.points["8.1"] == pytest.approx(tuple(table.weights[k] @ mesh()[:, :2]))
    assert marks.confidence["8.1"] == pytest.approx(table.confidence[k] / 2, abs=1e-3)
    assert marks.size == (300, 400)


def test_what_is_outside_is_left_out() -> None:
    marks = front_marks(GREY, mesh() - (150, 0, 0), 1.0)
    assert 0 < len(marks.points) < len(named().names)
    assert all(0 <= x <= 300 for x, _ in marks.points.values())


def test_pupils_that_are_not_seen_are_unsure() -> None:
    marks = front_marks(GREY, mesh(), 1.0)
    lids = mesh()[list(LIDS["3.5"]), :2]
    assert marks.points["3.5"] == pytest.approx(tuple((lids.min(0) + lids.max(0)) / 2))
    assert marks.confidence["3.5"] == pytest.approx(0.1)


def test_glances_are_around_the_square() -> None:
    crop = Crop((100, 50), 80, 0.3)
    beside = glances(crop)
    np.testing.assert_allclose(np.mean([g.middle for g in beside], axis=0), crop.middle)
    assert np.mean([g.side for g in beside]) == pytest.approx(80)
    assert np.mean([g.angle for g in beside]) == pytest.approx(0.3)
    assert len({(g.middle, g.side, g.angle) for g in beside}) == len(beside)
