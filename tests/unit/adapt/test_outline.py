"""Outlines of discs: how large they come out, which way round, and what the photo adds to a coarse mask."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.adapt.outline import headings, largest, resampled, sharpened, trace


def disc(n: int, at: tuple[float, float], radius: float, soft: float = 1.0) -> np.ndarray:
    """float32 (n, n): 1 in a disc, with an edge `soft` pixels wide."""
    y, x = np.mgrid[:n, :n] + 0.5
    off = radius - np.hypot(x - at[0], y - at[1])
    return np.clip(off / soft + 0.5, 0, 1).astype(np.float32)


def area(line: np.ndarray) -> float:
    """With the sign of its direction: positive if, with y down, it goes clockwise to the eye."""
    x, y = line.T
    return float((x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2)


@settings(max_examples=30, deadline=None)
@given(st.floats(20, 40), st.floats(20, 40), st.floats(4, 15))
def test_a_disc_is_traced_to_a_tenth_of_a_pixel(x: float, y: float, radius: float) -> None:
    line = trace(disc(60, (x, y), radius))
    np.testing.assert_allclose(np.hypot(*(line - (x, y)).T), radius, atol=0.1)
    assert abs(area(line)) == pytest.approx(np.pi * radius**2, rel=0.03)


def test_the_inside_is_on_the_right() -> None:
    """Clockwise to the eye."""
    line = trace(disc(60, (30, 30), 12))
    assert area(line) > 0
    assert np.ptp(headings(resampled(line, 1.0))) == pytest.approx(2 * np.pi, rel=0.1)


def test_all_cells_are_walked_even_where_corners_touch() -> None:
    """Every pattern of two by two pixels stands in a random field; each line closes."""
    field = np.random.default_rng(5).random((40, 40)).astype(np.float32)
    line = trace(field)
    gaps = np.linalg.norm(line - np.roll(line, 1, axis=0), axis=1)
    assert len(line) > 40
    assert gaps.max() < 1.5


@pytest.mark.parametrize("value", [0.0, 0.5])
def test_nothing_has_no_outline(value: float) -> None:
    assert trace(np.full((20, 30), value, np.float32)).shape == (0, 2)


def test_what_fills_the_picture_has_its_edge() -> None:
    line = trace(np.ones((20, 20), np.float32))
    assert abs(area(line)) == pytest.approx(20**2, rel=0.01)


def test_only_the_largest_piece_stays_and_its_holes_are_filled() -> None:
    field = np.maximum(disc(60, (20, 20), 12), disc(60, (50, 50), 6))
    field[18:22, 18:22] = 0
    cleaned = largest(field)
    assert cleaned[20, 20] == 1
    assert cleaned[50, 50] == 0
    assert cleaned[2, 50] == 0


def test_the_photo_corrects_a_coarse_mask() -> None:
    """A mask of 32 cells, off by most of one, over a photo of 256 pixels: from six pixels to one half."""
    true, radius = (130.0, 128.0), 70.0
    mask = disc(32, (true[0] / 8 + 0.6, true[1] / 8), radius / 8 - 0.3)
    share = disc(256, true, radius)[..., None]
    picture = share * np.float32([190, 140, 120]) + (1 - share) * np.float32([200, 205, 215])
    assert np.abs(np.hypot(*(trace(mask) * 8 - true).T) - radius).max() > 5
    off = np.abs(np.hypot(*(trace(sharpened(mask, picture.astype(np.float32))) - true).T) - radius)
    assert np.median(off) < 0.3
    assert off.max() < 1.5


def test_a_photo_that_tells_nothing_leaves_the_mask() -> None:
    mask = disc(32, (16, 16), 9)
    line = trace(sharpened(mask, np.full((128, 128, 3), 77, np.float32)))
    np.testing.assert_allclose(np.hypot(*(line - 64).T), 36, atol=1.0)


@pytest.mark.parametrize("value", [np.nan, 0.0, 1.0, np.inf])
def test_no_mask_does_harm(value: float) -> None:
    picture = np.random.default_rng(0).uniform(0, 255, (64, 64, 3)).astype(np.float32)
    alpha = sharpened(np.full((16, 16), value, np.float32), picture)
    assert np.isfinite(alpha).all()
    assert alpha.shape == (64, 64)


def test_points_are_evenly_spread() -> None:
    line = resampled(np.array([[0.0, 0], [10, 0], [10, 1], [10, 10], [0, 10]]), 0.5)
    gaps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    assert len(line) == 80
    assert gaps.min() > 0.3
    assert gaps.max() < 0.51
