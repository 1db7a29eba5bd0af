"""Pupils of drawn eyes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.adapt.pupils import SIDE, find_pupil, inside

WIDTH = 60.0
MIDDLE = np.array([100.0, 80.0])


def lids(opening: float = 0.4) -> np.ndarray:
    """(16, 2): an almond."""
    turn = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    return MIDDLE + WIDTH / 2 * np.column_stack([np.cos(turn), opening * np.sin(turn)])


def eye(at: np.ndarray, iris: int, skin: int = 150, radius: float = 0.2) -> np.ndarray:
    """uint8 (160, 200, 3): an iris at `at` in a white eye in skin; lids hide what is beyond them."""
    y, x = np.mgrid[:160, :200] + 0.5
    off = (np.stack([x, y], -1) - MIDDLE) / (WIDTH / 2 * np.array([1, 0.4]))
    white = np.clip((1 - np.linalg.norm(off, axis=-1)) * 12 + 0.5, 0, 1)
    disc = np.clip(radius * WIDTH - np.hypot(x - at[0], y - at[1]) + 0.5, 0, 1)
    grey = skin * (1 - white) + white * (220 * (1 - disc) + iris * disc)
    return np.repeat(grey[..., None], 3, axis=2).astype(np.uint8)


@settings(max_examples=25, deadline=None)
@given(st.floats(-6, 6), st.floats(-1.5, 1.5), st.integers(20, 120), st.floats(0.17, 0.23))
def test_the_iris_is_found_to_a_pixel(dx: float, dy: float, iris: int, radius: float) -> None:
    at = MIDDLE + (dx, dy)
    found, contrast = find_pupil(eye(at, iris, radius=radius), lids())
    assert found == pytest.approx(at, abs=1.2)
    assert contrast > 0.3


def test_a_highlight_does_not_lead_astray() -> None:
    at = MIDDLE + (4, 0)
    picture = eye(at, 40)
    picture[74:78, 106:110] = 255
    found, _ = find_pupil(picture, lids())
    assert found == pytest.approx(at, abs=1.5)


def test_where_nothing_is_to_be_seen_it_is_the_middle() -> None:
    grey = np.full((160, 200, 3), 90, np.uint8)
    found, contrast = find_pupil(grey, lids())
    assert contrast == 0
    assert found == pytest.approx(MIDDLE, abs=1e-6)


@pytest.mark.parametrize("outline", [np.zeros((16, 2)), np.full((16, 2), 1e6), lids(0.0)])
def test_strange_lids_do_no_harm(outline: np.ndarray) -> None:
    found, contrast = find_pupil(eye(MIDDLE, 40), outline)
    assert np.isfinite(found).all()
    assert 0 <= contrast <= 1


def test_a_polygon_has_its_area() -> None:
    square = np.array([[10.0, 10], [30, 10], [30, 40], [10, 40]])
    assert inside(square).sum() == 600
    assert inside(square)[20, 20]
    assert not inside(square)[20, 40]
    assert inside(np.zeros((3, 2))).sum() == 0
    assert inside(square * 100).shape == (SIDE, SIDE)
