"""Squares cut out of pictures: there and back, what a pixel of them shows, and what lies beyond the edges."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.adapt.crop import Crop

reals = st.floats(-500, 500)


@given(reals, reals, st.floats(1, 2000), st.floats(-4, 4))
def test_finding_undoes_placing(x: float, y: float, side: float, angle: float) -> None:
    crop = Crop((x, y), side, angle)
    points = np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 0.8]])
    np.testing.assert_allclose(crop.find(crop.place(points)), points, atol=1e-9)


def test_a_turned_square_goes_clockwise() -> None:
    corners = Crop((100, 50), 20, np.pi / 2).place(np.array([[0.0, 0.5], [1.0, 0.5], [0.5, 1.0]]))
    np.testing.assert_allclose(corners, [[100, 40], [100, 60], [90, 50]], atol=1e-9)


@pytest.mark.parametrize("side", [40.0, 96.0, 200.0])
def test_each_pixel_shows_its_place(side: float) -> None:
    """Of a picture whose red is x and whose green is y, reduced or enlarged, turned."""
    y, x = np.mgrid[:400, :400] + 0.5
    picture = np.stack([x, y, 0 * x], -1).astype(np.float32)
    crop = Crop((200, 180), side, 0.4)
    at = (np.arange(48) + 0.5) / 48
    wanted = crop.place(np.stack(np.meshgrid(at, at), -1))
    np.testing.assert_allclose(crop.cut(picture, 48)[..., :2], wanted, atol=0.02)


def test_what_is_reduced_is_averaged() -> None:
    chequered = np.indices((64, 64)).sum(0) % 2 * 200
    picture = np.repeat(chequered[..., None], 3, axis=2).astype(np.uint8)
    assert np.ptp(Crop.whole(64, 64).cut(picture, 8)) < 1


def test_beyond_the_edges_it_is_black() -> None:
    white = np.full((30, 50, 3), 255, np.uint8)
    cut = Crop.whole(50, 30).cut(white, 50)
    assert (cut[:9] == 0).all()
    assert (cut[11:39] == 255).all()
    assert (cut[41:] == 0).all()
    assert (Crop((500, 500), 20).cut(white, 16) == 0).all()
