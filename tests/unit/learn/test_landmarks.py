"""Points of a tracked mesh, and the head held still."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.errors import ClipError, DataError
from fapstream.fap import faps
from fapstream.learn import landmarks as module
from fapstream.learn.landmarks import (
    OUTER_EYES,
    PARTS,
    Landmarks,
    _similarities,
    columns,
    points_of,
    still,
    table,
)
from fapstream.learn.measured import MEASURED
from tests.unit.learn.faces import IDS, NEUTRAL, filmed, moved


def test_the_table_holds_every_point_once_and_its_twin_is_its_twins_twin() -> None:
    rows = {row.point: row for row in table()}
    assert len(rows) == len(table())
    assert all(0 <= point < 478 for point in rows)
    for row in table():
        assert rows[row.mirror].mirror == row.point
        assert rows[row.mirror].part == row.part


def test_every_feature_point_of_a_measured_fap_is_in_the_table() -> None:
    known = {row.fdp for row in table()}
    assert {faps()[number - 1].fdp[0] for number in MEASURED} <= known


def test_the_twin_of_a_left_feature_point_is_the_right_one() -> None:
    """Left and right of a pair of FAPs are mirrored in the table as in the standard."""
    of = {row.point: row.fdp for row in table()}
    pairs = [("2.4", "2.5"), ("2.6", "2.7"), ("2.8", "2.9"), ("8.3", "8.4"), ("8.5", "8.6"), ("8.7", "8.8"),
             ("3.1", "3.2"), ("3.3", "3.4"), ("4.1", "4.2"), ("4.3", "4.4"), ("4.5", "4.6")]  # fmt: skip
    for left, right in pairs:
        twins = {of[row.mirror] for row in table() if row.fdp == left}
        assert twins == {right}


def test_parts_are_in_the_tables_order_and_no_point_is_in_two() -> None:
    assert points_of(*PARTS) == IDS
    assert points_of("lips", "jaw") == points_of("jaw", "lips")
    assert sum(len(points_of(part)) for part in PARTS) == len(IDS)


@pytest.mark.parametrize("line", ["1\t1\tbone", "one\t1\tbone\t-", "1\t1\tnose\t-"])
def test_a_bad_line_of_the_table_is_told_by_its_number(line: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "read_lines", lambda *_: [(7, line)])
    with pytest.raises(DataError, match=r"landmarks\.tsv:7"):
        table.__wrapped__()


@pytest.mark.parametrize("shape", [(4, 3, 3), (4, 2, 2), (4, 6), (2, 3)])
def test_points_of_another_shape_than_their_numbers_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(ClipError, match="frames, 2, 3"):
        Landmarks(np.zeros(shape), (1, 2))


def test_columns_are_where_the_points_are() -> None:
    assert columns((5, 9, 7), (7, 5)).tolist() == [2, 0]
    with pytest.raises(ClipError, match="13, 14"):
        columns((5, 9, 7), (7, 13, 14))


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10**6))
def test_a_still_face_is_the_same_wherever_the_head_goes(seed: int) -> None:
    rng = np.random.default_rng(seed)
    found = still(filmed(moved({3: np.zeros(20)}), rng))
    np.testing.assert_allclose(found, np.tile(NEUTRAL, (20, 1, 1)), atol=1e-6)


def test_what_the_face_does_is_left_in_it() -> None:
    rng = np.random.default_rng(1)
    points = moved({3: rng.uniform(0, 500, 30), 31: rng.uniform(-200, 200, 30), 6: rng.uniform(0, 90, 30)})
    np.testing.assert_allclose(still(filmed(points, rng)), points, atol=1e-6)


def test_the_order_and_the_number_of_the_points_in_the_file_do_not_matter() -> None:
    rng = np.random.default_rng(2)
    film = filmed(moved({3: rng.uniform(0, 500, 12)}), rng)
    order = rng.permutation(len(IDS))
    shuffled = Landmarks(film.points[:, order], tuple(IDS[i] for i in order))
    np.testing.assert_allclose(still(shuffled), still(film)[:, order], atol=1e-9)


def test_the_eyes_are_90_mm_apart_and_the_face_upright_under_noise() -> None:
    rng = np.random.default_rng(3)
    found = still(filmed(moved({3: np.zeros(40)}), rng, noise_px=0.7))
    left, right, crown, base = found[:, columns(IDS, (*OUTER_EYES, 10, 2))].mean(axis=0)
    np.testing.assert_allclose(left - right, [90, 0, 0], atol=1e-9)
    assert crown[1] > base[1]
    assert (crown - base)[2] == pytest.approx(0, abs=1e-9)
    assert np.abs(found - NEUTRAL).mean() < 0.6


def test_lost_frames_stay_lost_and_change_nothing_else() -> None:
    rng = np.random.default_rng(4)
    film = filmed(moved({3: rng.uniform(0, 500, 20)}), rng)
    film.points[[0, 7, 8]] = np.nan
    film.points[12, 5:30, 2] = np.nan
    found, seen = still(film), np.delete(np.arange(20), [0, 7, 8, 12])
    np.testing.assert_allclose(found[seen], still(Landmarks(film.points[seen], IDS)), atol=1e-9)
    assert np.isnan(found[[0, 7, 8, 12]]).all()


@pytest.mark.parametrize("frames", [0, 9])
def test_a_clip_without_a_face_is_refused(frames: int) -> None:
    with pytest.raises(ClipError, match="no face"):
        still(Landmarks(np.full((frames, len(IDS), 3), np.nan), IDS))


@pytest.mark.parametrize("absent", [5, 33, 10, 2])
def test_a_point_that_is_not_tracked_is_named(absent: int) -> None:
    film = filmed(moved({3: np.zeros(12)}))
    kept = [i for i, point in enumerate(IDS) if point != absent]
    with pytest.raises(ClipError, match=rf"not in the file: {absent}$"):
        still(Landmarks(film.points[:, kept], tuple(IDS[i] for i in kept)))


def test_a_mirrored_face_is_turned_but_not_mirrored_back() -> None:
    shape = np.random.default_rng(5).normal(size=(1, 9, 3))
    shape -= shape.mean(axis=1, keepdims=True)
    for mirror in (1.0, -1.0):
        found = _similarities(shape * np.array([mirror, 1, 1]), shape[0])
        assert np.linalg.det(found.rotation[0]) == pytest.approx(1)
        assert found.scale[0] == pytest.approx(1) if mirror > 0 else found.scale[0] < 1


def test_points_that_are_all_in_one_place_are_no_face() -> None:
    film = filmed(moved({3: np.zeros(12)}))
    film.points[3] = 100.0
    assert np.flatnonzero(np.isnan(still(film)).any(axis=(1, 2))).tolist() == [3]
    film.points[:] = 100.0
    with pytest.raises(ClipError, match="no face"):
        still(film)


def test_points_on_a_line_are_no_face() -> None:
    line = np.arange(len(IDS))[None, :, None] * np.array([1.0, 2.0, 0.5])
    with pytest.raises(ClipError, match="on one line"):
        still(Landmarks(np.repeat(line, 12, axis=0), IDS))
