"""Drawn mouths: the dark line ends where it was drawn to end."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.adapt.points import Facing
from fapstream.adapt.seam import CORNER, mouth_corner
from fapstream.adapt.silhouette import Laid, chain

HEIGHT = 300.0
STOMION = np.array([420.0, 300.0])


def laid(facing: Facing = "right", tilt: float = 0.0) -> Laid:
    """The mean chain with its stomion at STOMION, mirrored in a photo of 600 pixels if it looks left."""
    table = chain()
    points = (table.places - table.places[table.names.index("stomion")]) * HEIGHT
    c, s = np.cos(tilt), np.sin(tilt)
    points = points @ np.array([[c, s], [-s, c]]) + STOMION
    if facing == "left":
        points = points * (-1, 1) + (600, 0)
    return Laid(points, np.zeros(len(points)), facing, HEIGHT, tilt, 0.0)


def mouth(length: float, drop: float, skin: int = 180, line: int = 90) -> np.ndarray:
    """uint8 (600, 600, 3): a line from the stomion backward, `drop` lower at its end, which is pointed.

    A faint fold goes on from there.
    """
    y, x = np.mgrid[:600, :600] + 0.5
    along = (STOMION[0] - x) / length
    across = np.abs(y - STOMION[1] - drop * along)
    dark = np.clip((1 - along) * length / 4, 0.1 * (along * length < length + 40), 1)
    share = np.clip(2.5 - across, 0, 1) * (along > -0.2) * dark
    grey = skin + (line - skin) * share
    return np.repeat(grey[..., None], 3, axis=2).astype(np.uint8)


@settings(max_examples=20, deadline=None)
@given(st.floats(25, 70), st.floats(-10, 15), st.sampled_from(["left", "right"]), st.floats(-0.2, 0.2))
def test_the_corner_is_where_the_line_ends(length: float, drop: float, facing: Facing, tilt: float) -> None:
    picture = mouth(length, drop)
    found = mouth_corner(picture if facing == "right" else picture[:, ::-1], laid(facing, tilt))
    assert found is not None
    x, y, confidence = found
    c, s = np.cos(tilt), np.sin(tilt)
    beyond = np.array(CORNER) * HEIGHT @ np.array([[c, s], [-s, c]])
    wanted = STOMION + (-length, drop) + beyond
    at = np.array([x if facing == "right" else 600 - x, y])
    np.testing.assert_allclose(at, wanted, atol=4)
    assert 0 < confidence <= 0.5


@pytest.mark.parametrize("value", [0, 128, 255])
def test_where_there_is_no_line_there_is_no_corner(value: int) -> None:
    assert mouth_corner(np.full((600, 600, 3), value, np.uint8), laid()) is None


def test_a_mouth_outside_the_photo_does_no_harm() -> None:
    assert mouth_corner(np.full((100, 100, 3), 128, np.uint8), laid()) is None


def test_noise_does_no_harm() -> None:
    noise = np.random.default_rng(1).integers(0, 255, (600, 600, 3)).astype(np.uint8)
    found = mouth_corner(noise, laid())
    assert found is None or np.isfinite(found).all()
