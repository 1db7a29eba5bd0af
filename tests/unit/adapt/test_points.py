"""The table of feature points, and the files that photos' points are kept in."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.adapt.points import (
    Marks,
    PhotoPoints,
    facing_of,
    feature_points,
    format_points,
    generic_places,
    near_side,
    read_points,
)
from fapstream.errors import PointsError
from tests.unit.adapt.persons import NAMES, known
from tests.unit.head.packaged import packaged


def test_points_come_in_pairs_left_first() -> None:
    table, places = feature_points(), generic_places(packaged().fdp)
    seen = set()
    for name, point in table.items():
        if point.mirror is None:
            assert abs(places[name][0]) < 1e-3, name
            continue
        other = table[point.mirror]
        assert other.mirror == name
        assert other.views == point.views
        assert np.abs(places[name] * (-1, 1, 1) - places[other.name]).max() < 1e-3, name
        if other.name not in seen:
            assert places[name][0] > 0, f"{name} is a left point"
        seen.add(name)
    assert len(table) > 50


def test_points_lie_on_the_generic_head() -> None:
    head = packaged()
    points = np.concatenate([head.part(name).positions for name in ("skin", "eye_l", "eye_r")])
    for name, place in generic_places(head.fdp).items():
        assert np.linalg.norm(points - place, axis=1).min() < 2e-4, name


@pytest.mark.parametrize("name", NAMES)
def test_a_file_comes_back_as_it_was(name: str) -> None:
    points = known(name)
    again = read_points(format_points(points))
    assert again.facing == points.facing
    assert again.front == points.front
    assert again.profile == points.profile


def test_confidence_is_kept_and_a_profile_may_be_missing() -> None:
    points = PhotoPoints(Marks((10, 20), {"9.3": (4.0, 5.5)}, {"9.3": 0.25}))
    again = read_points(format_points(points))
    assert again == points
    assert again.front.sureness(("9.3", "8.1")).tolist() == [0.25, 1.0]
    assert np.isnan(again.front.array(("8.1",))).all()


GOOD = {"version": 1, "front": {"size": [100, 80], "points": {"9.3": [50, 40]}}}


def broken(**changes: object) -> str:
    front = GOOD["front"] | changes  # type: ignore[operator]
    return json.dumps({"version": 1, "front": front})


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("{", "not JSON"),
        ("[]", "version"),
        ('{"version": 2}', "version"),
        ('{"version": 1}', "front"),
        ("[" * 100000, "JSON"),
        ("x" * 300000, "limit"),
        (broken(size=[0, 5]), "size"),
        (broken(size=[100.5, 5]), "size"),
        (broken(points=[]), "points"),
        (broken(points={"9.99": [1, 2]}), "no feature point"),
        (broken(points={"glabella": [1, 2]}), "no feature point of a front"),
        (broken(points={"9.3": [101, 2]}), "outside"),
        (broken(points={"9.3": [-1, 2]}), "outside"),
        (broken(points={"9.3": [1]}), "confidence"),
        (broken(points={"9.3": ["1", 2]}), "finite"),
        (broken(points={"9.3": [True, 2]}), "finite"),
        (broken(points={"9.3": [float("nan"), 2]}), "finite"),
        (broken(points={"9.3": [float("inf"), 2]}), "finite"),
        (broken(points={"9.3": [10**400, 2]}), "finite"),
        (json.dumps(GOOD | {"profile": 3}), "profile"),
        (json.dumps(GOOD | {"profile": {"size": [5, 5], "points": {}, "facing": "up"}}), "facing"),
        (json.dumps(GOOD | {"profile": {"size": [5, 5], "points": {}, "facing": ["left"]}}), "facing"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_with_its_place(text: str, says: str) -> None:
    with pytest.raises(PointsError, match=r"p\.json") as e:
        read_points(text, "p.json")
    assert says in str(e.value)
    assert len(str(e.value)) <= 400


JSON = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4),
)


@given(JSON, JSON)
def test_no_file_raises_anything_else(front: object, profile: object) -> None:
    with pytest.raises(PointsError):
        read_points(
            json.dumps({"version": 1, "front": {"size": [9, 9], "points": {"x": front}}, "profile": profile})
        )


def test_the_nose_tells_where_a_profile_looks() -> None:
    assert facing_of({"9.3": (90, 0), "9.15": (85, 0), "10.1": (20, 0)}) == "right"
    assert facing_of({"9.3": (10, 0), "2.13": (60, 0)}) == "left"
    assert facing_of({"9.3": (10, 0)}) is None
    assert near_side("right") == -1, "a head that looks right shows its right side, x < 0"
    assert near_side("left") == 1
