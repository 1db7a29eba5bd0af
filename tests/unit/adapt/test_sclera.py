"""Drawn eyes beside a drawn nose: the corner and the lids are where they were drawn, or nowhere."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.adapt.points import Facing
from fapstream.adapt.sclera import BESIDE, profile_eye
from fapstream.adapt.silhouette import Laid, chain, proportioned

HEIGHT = 300.0
SKIN, WHITE = (200, 150, 120), (200, 200, 205)


def laid(facing: Facing = "right") -> Laid:
    """The mean chain in a photo of 600 pixels."""
    points = chain().places * HEIGHT + (400, 100)
    if facing == "left":
        points = points * (-1, 1) + (600, 0)
    return Laid(points, np.zeros(len(points)), facing, HEIGHT, 0.0, 0.0)


EXPECTED = {name: at for name, at in proportioned(laid()).items() if name in BESIDE}


def eye(shift: tuple[float, float], white: tuple[int, int, int] = WHITE) -> np.ndarray:
    """uint8 (600, 600, 3): the triangle of the corner and the lids, the points moved by `shift`, in skin."""
    corner, upper, lower = (
        EXPECTED[name] - np.array(BESIDE[name]) * HEIGHT + shift for name in ("3.7", "3.1", "3.3")
    )
    y, x = np.mgrid[:600, :600] + 0.5
    inside = np.ones((600, 600), bool)
    for a, b in ((corner, upper), (upper, lower), (lower, corner)):
        inside &= (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]) > 0
    return np.where(inside[..., None], np.array(white), np.array(SKIN)).astype(np.uint8)


@settings(max_examples=20, deadline=None)
@given(st.floats(-12, 12), st.floats(-12, 12), st.sampled_from(["left", "right"]))
def test_the_points_are_where_they_were_drawn(dx: float, dy: float, facing: Facing) -> None:
    picture = eye((dx, dy))
    seen = profile_eye(picture if facing == "right" else picture[:, ::-1], laid(facing))
    assert set(seen) == set(EXPECTED)
    for name, (x, y, confidence) in seen.items():
        at = np.array([x if facing == "right" else 600 - x, y])
        np.testing.assert_allclose(at, EXPECTED[name] + (dx, dy), atol=5)
        assert 0 < confidence <= 0.5


def test_background_beyond_the_nose_is_no_eye() -> None:
    picture = eye((0, 0), SKIN)
    root = laid().points[chain().names.index("nasion")]
    picture[:, int(root[0]) :] = WHITE
    assert profile_eye(picture, laid()) == {}


def test_hair_is_no_eye() -> None:
    """A long grey strand: too high."""
    picture = eye((0, 0), SKIN)
    x = int(EXPECTED["3.7"][0])
    picture[:, x : x + 10] = (90, 90, 90)
    assert profile_eye(picture, laid()) == {}


@pytest.mark.parametrize("value", [0, 128, 255])
def test_without_colour_nothing_is_said(value: int) -> None:
    assert profile_eye(np.full((600, 600, 3), value, np.uint8), laid()) == {}
    assert profile_eye(eye((0, 0), (230, 230, 230))[..., :1].repeat(3, axis=2), laid()) == {}


def test_an_eye_outside_the_photo_does_no_harm() -> None:
    assert profile_eye(np.full((80, 80, 3), 128, np.uint8), laid()) == {}
