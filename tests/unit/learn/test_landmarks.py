"""Points with the head's motion taken out, and the table that says which they are."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.data import read_lines
from fapstream.errors import ClipError, DataError
from fapstream.learn import landmarks as module
from fapstream.learn.landmarks import OUTER_EYES, Landmarks, columns, points_of, still, table
from tests.unit.learn.talker import IDS, moved, neutral, turned


def test_a_face_that_only_turns_is_still() -> None:
    points = turned(moved(np.zeros((40, 68))), np.random.default_rng(1))
    held = still(Landmarks(points, IDS))
    assert held.std(axis=0).max() < 0.02
    left, right = (held[:, IDS.index(i)].mean(axis=0) for i in OUTER_EYES)
    assert left - right == pytest.approx([90, 0, 0], abs=1e-6)


def test_it_stands_upright_as_it_was_made() -> None:
    held = still(Landmarks(turned(moved(np.zeros((40, 68))), np.random.default_rng(1)), IDS)).mean(axis=0)
    made = neutral()
    made = made - (made[IDS.index(263)] + made[IDS.index(33)]) / 2
    assert held == pytest.approx(made, abs=1.5)


def test_what_the_mouth_does_does_not_turn_the_head() -> None:
    values = np.zeros((40, 68))
    values[10:30, 2], values[10:30, 4] = 600, -800
    held = still(Landmarks(turned(moved(values), np.random.default_rng(1)), IDS))
    bone = held[:, columns(IDS, points_of("bone"))]
    assert bone.std(axis=0).max() < 0.02


def test_lost_frames_stay_lost() -> None:
    points = turned(moved(np.zeros((20, 68))), np.random.default_rng(1))
    points[7] = np.nan
    held = still(Landmarks(points, IDS))
    assert np.isnan(held[7]).all()
    assert np.isfinite(np.delete(held, 7, axis=0)).all()


def test_every_point_has_a_twin_whose_twin_it_is() -> None:
    by_point = {row.point: row for row in table()}
    assert len(by_point) == len(table())
    for row in table():
        assert by_point[row.mirror].mirror == row.point
        assert by_point[row.mirror].part == row.part


def test_jaw_lips_and_face_are_as_many_points_as_the_paper_has() -> None:
    assert len(points_of("jaw", "lips", "face")) == 64


@pytest.mark.parametrize("line", ["1\t1\tbone", "x\t1\tbone\t-", "1\t1\tknee\t-"])
def test_a_wrong_line_of_the_table_is_named(line: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert list(read_lines("learn", "landmarks.tsv"))
    monkeypatch.setattr(module, "read_lines", lambda *_: iter([(9, line)]))
    table.cache_clear()
    with pytest.raises(DataError, match=r"landmarks\.tsv:9"):
        table()
    table.cache_clear()


def test_nobody_to_be_seen_is_said() -> None:
    with pytest.raises(ClipError, match="no face"):
        still(Landmarks(np.full((5, len(IDS), 3), np.nan), IDS))
