"""Profiles: true points of two persons whom the table has not seen, turned, mirrored, cut; no profiles."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.adapt.found import Face
from fapstream.adapt.outline import trace
from fapstream.adapt.points import Marks, facing_of, feature_points, near_side
from fapstream.adapt.silhouette import OFFSETS, behind, chain, crop_around, lay, profile_marks
from fapstream.errors import PhotoError

FOLDER = Path(__file__).parent / "outlines"
PERSONS = {path.stem: json.loads(path.read_text()) for path in sorted(FOLDER.glob("*.json"))}
SURE = ("nasion", "9.15", "8.1", "stomion", "8.2", "sulcus", "2.10")
OUTLINE = 0.05
"""How far the points of the outline may be off, heights of the face."""


@pytest.fixture(params=list(PERSONS))
def person(request: pytest.FixtureRequest) -> dict[str, Any]:
    """Its outline (k, 2), true points by name, pixels, and facing."""
    row = dict(PERSONS[request.param])
    row["outline"] = np.array(row["outline"])
    return row


def height(person: dict[str, Any]) -> float:
    return float(np.hypot(*np.subtract(person["points"]["nasion"], person["points"]["2.1"])))


def found(person: dict[str, Any], guess: float | None) -> Marks:
    return profile_marks(lay(person["outline"], guess), (1000, 1000), {})


def off(marks: Marks, truth: dict[str, Any], names: tuple[str, ...]) -> float:
    """The largest distance, pixels."""
    return max(float(np.hypot(*np.subtract(marks.points[name], truth[name]))) for name in names)


@pytest.mark.parametrize("guess", [0.75, 1.0, 1.3, None])
def test_points_of_the_outline_are_found(person: dict[str, Any], guess: float | None) -> None:
    tall = height(person)
    laid = lay(person["outline"], guess and guess * tall)
    assert laid.facing == person["facing"]
    assert laid.height == pytest.approx(tall, rel=0.1)
    marks = profile_marks(laid, (1000, 1000), {})
    assert off(marks, person["points"], SURE) < OUTLINE * tall
    assert off(marks, person["points"], ("bridge", "9.3", "2.1", "glabella")) < 0.1 * tall


def test_points_behind_it_are_near_and_unsure(person: dict[str, Any]) -> None:
    marks = found(person, height(person))
    names = {left if person["facing"] == "left" else feature_points()[left].mirror for left in behind()}
    assert names <= set(marks.points)
    for name in names:
        limit = 0.25 if name.startswith("10.") else 0.12
        assert off(marks, person["points"], (str(name),)) < limit * height(person), name
        assert 0 < marks.confidence[str(name)] < 0.2
    assert facing_of(marks.points) == person["facing"]


def test_all_points_belong_to_the_side_that_is_seen(person: dict[str, Any]) -> None:
    marks = found(person, None)
    for name in marks.points:
        point = feature_points()[name]
        assert "profile" in point.views
        order = list(feature_points())
        if point.mirror:
            side = 1 if order.index(name) < order.index(point.mirror) else -1
            assert side == near_side(person["facing"])
    assert set(marks.confidence) == set(marks.points)


def test_a_mirrored_outline_has_mirrored_points(person: dict[str, Any]) -> None:
    marks = found(person, height(person))
    mirrored = {**person, "outline": (person["outline"] * (-1, 1) + (1000, 0))[::-1]}
    other = found(mirrored, height(person))
    for name, (x, y) in marks.points.items():
        own = feature_points()[name].mirror or name
        assert other.points[own] == pytest.approx((1000 - x, y), abs=3)


@settings(max_examples=15, deadline=None)
@given(st.sampled_from(list(PERSONS)), st.floats(-0.2, 0.2), st.floats(0.3, 4))
def test_size_and_tilt_do_not_matter(name: str, tilt: float, size: float) -> None:
    """A turned, scaled outline has its points where the outline as it was had them."""
    person = PERSONS[name]
    tall, line = height(person), np.array(person["outline"])
    c, s = np.cos(tilt), np.sin(tilt)

    def moved(points: np.ndarray) -> np.ndarray:
        return (points - 500) @ np.array([[c, s], [-s, c]]) * size + 500

    still, laid = lay(line, tall), lay(moved(line), tall * size)
    assert laid.facing == person["facing"]
    down = tilt if laid.facing == "right" else -tilt
    assert laid.tilt - still.tilt == pytest.approx(down, abs=0.03)
    away = np.linalg.norm(laid.points - moved(still.points), axis=1) / (tall * size)
    assert np.median(away) < 0.015
    assert laid.cost == pytest.approx(still.cost, abs=2)
    assert away[3:13].max() < 0.04


def test_what_is_hidden_is_less_sure() -> None:
    """Wild hair from the brow up."""
    person = {**PERSONS["person600"], "outline": np.array(PERSONS["person600"]["outline"])}
    free = found(person, height(person))
    line = person["outline"].copy()
    above = line[:, 1] < person["points"]["nasion"][1] - 30
    line[above] += np.random.default_rng(4).normal(0, 12, (above.sum(), 2))
    wild = found({**person, "outline": line}, height(person))
    for name in ("11.1", "forehead"):
        assert wild.confidence[name] < 0.7 * free.confidence[name]
    assert wild.confidence["8.2"] == pytest.approx(free.confidence["8.2"], rel=0.1)
    assert wild.points["9.3"] == pytest.approx(person["points"]["9.3"], abs=10)


def test_what_lies_outside_the_photo_is_left_out(person: dict[str, Any]) -> None:
    laid = lay(person["outline"], height(person))
    low = int(person["points"]["stomion"][1])
    marks = profile_marks(laid, (1000, low), {})
    assert "2.1" not in marks.points
    assert "9.3" in marks.points
    assert all(y <= low for _, y in marks.points.values())


def test_what_was_seen_behind_it_is_taken(person: dict[str, Any]) -> None:
    laid = lay(person["outline"], height(person))
    name = "8.3" if person["facing"] == "left" else "8.4"
    marks = profile_marks(laid, (1000, 1000), {"8.3": (321.0, 123.0, 0.4), "3.7": None})
    assert marks.points[name] == (321, 123)
    assert marks.confidence[name] == 0.4
    rest = profile_marks(laid, (1000, 1000), {})
    assert {key: at for key, at in marks.points.items() if key != name} == {
        key: at for key, at in rest.points.items() if key != name
    }


@pytest.mark.parametrize("guess", [100.0, None])
def test_a_disc_and_a_square_are_no_profiles(guess: float | None) -> None:
    y, x = np.mgrid[:300, :300]
    for field in (np.hypot(x - 150, y - 150) < 120, (abs(x - 150) < 90) & (abs(y - 150) < 120)):
        with pytest.raises(PhotoError, match="not that of a face"):
            lay(trace(field.astype(np.float32)), guess)


@pytest.mark.parametrize(
    "line",
    [
        trace(np.zeros((256, 256), np.float32)),
        trace(np.pad([[1.0]], 3).astype(np.float32)),
        np.full((500, 2), np.nan),
        np.zeros((500, 2)),
        np.column_stack([np.arange(500.0), np.zeros(500)]),
        np.random.default_rng(1).normal(0, 100, (2000, 2)),
        np.random.default_rng(2).uniform(0, 1e-9, (50, 2)),
    ],
    ids=["nothing", "a pixel", "NaN", "a point", "a line", "noise", "dust"],
)
@pytest.mark.parametrize("guess", [1e-6, 50.0, 1e9, None])
def test_what_is_no_outline_is_an_error(line: np.ndarray, guess: float | None) -> None:
    with pytest.raises(PhotoError):
        lay(line, guess)


def test_the_tables_are_those_of_a_profile() -> None:
    table = chain()
    assert table.bends.shape == (len(table.names), len(OFFSETS))
    y = dict(zip(table.names, table.places, strict=True))
    assert y["9.3"][0] > y["nasion"][0]
    down = [y[name][1] for name in ("11.1", "glabella", "nasion", "9.3", "9.15", "stomion", "sulcus", "2.1")]
    assert down == sorted(down)
    assert y["2.1"][1] - y["nasion"][1] == pytest.approx(1, abs=0.05)
    assert all("profile" in feature_points()[name].views for name in (*table.names, *behind()))
    assert all(x < y["9.3"][0] for x, _, _ in behind().values())


def test_the_square_around_a_face_has_it_in_its_middle() -> None:
    crop = crop_around(Face((100, 200, 200, 320), np.zeros((2, 2)), 1.0))
    assert crop.middle == (150, 260)
    assert crop.side > 240
