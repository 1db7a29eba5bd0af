"""Numbers of the detector and of the mesh model, made up: each face comes out where it was put, once."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.adapt.crop import Crop
from fapstream.adapt.found import (
    DETECTOR_SIDE,
    EYES,
    MESH_POINTS,
    MESH_SIDE,
    Face,
    anchors,
    chance,
    decode,
    each_once,
    mesh_crop,
    only_face,
    place_mesh,
    tiles,
)
from fapstream.errors import PhotoError

WHOLE = Crop.whole(640, 480)


def numbers(*faces: tuple[int, tuple[float, float], float, float]) -> tuple[np.ndarray, np.ndarray]:
    """What the detector would say: (anchor, middle, size) in pixels of its input and log odds, for each."""
    boxes, scores = np.zeros((896, 16), np.float32), np.full((896, 1), -100, np.float32)
    for anchor, middle, size, odds in faces:
        own = anchors()[anchor] * DETECTOR_SIDE
        at = np.array(middle) - own
        eyes = at + [(-size / 4, 0), (size / 4, size / 10)]
        boxes[anchor] = [*at, size, size, *eyes[0], *eyes[1], *np.zeros(8)]
        scores[anchor] = odds
    return boxes, scores


def face(left: float, top: float, size: float, score: float = 0.9) -> Face:
    return Face((left, top, left + size, top + size), np.array([[0.0, 0.0], [1.0, 0.0]]), score)


def test_anchors_are_in_the_middle_of_their_cells() -> None:
    assert anchors().shape == (896, 2)
    np.testing.assert_allclose(anchors()[[0, 1, 2, 511, 512, 895]] * 16, [
        [0.5, 0.5], [0.5, 0.5], [1.5, 0.5], [15.5, 15.5], [1, 1], [15, 15]
    ])  # fmt: skip


def test_a_face_comes_out_where_it_was_put() -> None:
    """128 pixels of input are 640 of the picture, of which 80 above and below are not there."""
    (one,) = decode(*numbers((300, (60, 50), 30, 2.0)), WHOLE)
    np.testing.assert_allclose(one.box, (225, 95, 375, 245), atol=1e-3)
    np.testing.assert_allclose(one.eyes, [[262.5, 170], [337.5, 185]], atol=1e-3)
    assert one.score == pytest.approx(1 / (1 + np.exp(-2)))
    assert one.size == pytest.approx(150)
    assert one.crop.side == pytest.approx(225)
    assert one.crop.angle == pytest.approx(np.arctan2(15, 75))


def test_boxes_of_one_face_are_joined_and_of_two_are_not() -> None:
    found = decode(*numbers((300, (60, 50), 30, 2), (301, (62, 50), 30, 1), (20, (100, 90), 25, 3)), WHOLE)
    assert [round(f.score, 2) for f in found] == [0.95, 0.88]
    assert 225 < found[1].box[0] < 235


def test_the_unsure_are_not_found() -> None:
    assert decode(*numbers((300, (60, 50), 30, -0.1)), WHOLE) == []


@settings(deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([np.nan, np.inf, -np.inf, 1e30, -1e30, 0.0]))
def test_no_numbers_do_harm(seed: int, odd: float) -> None:
    rng = np.random.default_rng(seed)
    boxes = rng.normal(0, 100, (896, 16)).astype(np.float32)
    scores = rng.normal(0, 3, 896).astype(np.float32)
    boxes[rng.integers(0, 896, 300), rng.integers(0, 16, 300)] = odd
    scores[rng.integers(0, 896, 100)] = odd
    for one in decode(boxes, scores, WHOLE):
        assert np.isfinite([*one.box, one.score, one.size]).all()
        assert one.box[0] < one.box[2]


def test_no_face_is_an_error() -> None:
    with pytest.raises(PhotoError, match="no face"):
        only_face([])


def test_two_faces_are_an_error_unless_one_is_small_unsure_or_the_same() -> None:
    first = face(0, 0, 100)
    with pytest.raises(PhotoError, match="more than one face"):
        only_face([first, face(150, 0, 80)])
    assert only_face([face(150, 0, 30), first, face(300, 0, 80, 0.51), face(60, 60, 60)]) is first


def test_the_surest_of_overlapping_faces_leads() -> None:
    once = each_once([face(10, 0, 100, 0.6), face(0, 0, 100, 0.9)])
    assert [f.score for f in once] == [0.9]
    assert once[0].box[0] == pytest.approx(4)


@given(st.integers(1, 5000), st.integers(1, 5000))
def test_tiles_cover_the_picture(width: int, height: int) -> None:
    squares = tiles(width, height)
    for point in [(0, 0), (width, height), (width / 2, height / 3), (0, height)]:
        at = [crop.find(np.array(point, float)) for crop in squares]
        assert any(((a >= -1e-6) & (a <= 1 + 1e-6)).all() for a in at)


def test_the_mesh_fills_its_next_square_alike_wherever_it_was_seen() -> None:
    """Around what the square showed, level with the eyes."""
    rng = np.random.default_rng(3)
    raw = rng.uniform(0.25, 0.75, (MESH_POINTS, 3)) * MESH_SIDE
    raw[list(EYES), 1] = MESH_SIDE / 2
    raw[EYES[0], 0], raw[EYES[1], 0] = 0.3 * MESH_SIDE, 0.7 * MESH_SIDE
    for angle in (0.0, 0.7, -2.0):
        crop = Crop((300, 200), 150, angle)
        mesh = place_mesh(raw.ravel(), crop)
        again = mesh_crop(mesh)
        assert np.cos(again.angle - angle) == pytest.approx(1)
        flat = again.find(mesh[:, :2])
        np.testing.assert_allclose((flat.min(0) + flat.max(0)) / 2, 0.5, atol=1e-9)
        assert np.ptp(flat, axis=0).max() == pytest.approx(1 / 1.5)


def test_chance_is_that_of_log_odds() -> None:
    np.testing.assert_allclose(chance(np.array([[0.0], [np.log(3)], [1e9]])), [0.5, 0.75, 1.0])
