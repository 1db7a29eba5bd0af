"""The models at work on photos of a person who was made up, and on what is no photo of one."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from fapstream.adapt.points import Marks
from fapstream.adapters import landmarks
from fapstream.adapters.landmarks import MODELS, Landmarker, LandmarksUnavailable
from fapstream.errors import DataError, FapstreamError, PhotoError
from fapstream.ports import Landmarker as Port

FOLDER = Path(__file__).parent / "photos"
TRUTH = json.loads((FOLDER / "person601.points.json").read_text())
EYES = 85.0
"""Pixels between the pupils, nearly."""
needs_litert = pytest.mark.skipif(not landmarks.installed(), reason="the extra `landmarks` is not installed")


def photo(view: str) -> NDArray[np.uint8]:
    """uint8 (500, 500, 3)."""
    return np.asarray(Image.open(FOLDER / f"person601.{view}.jpg").convert("RGB"))


@pytest.fixture(scope="module")
def finder() -> Port:
    return Landmarker()


def errors(marks: Marks, view: str) -> dict[str, float]:
    """Distance to the truth by name, over that of the eyes."""
    truth = TRUTH[view]["points"]
    return {name: float(np.hypot(*np.subtract(at, truth[name]))) / EYES for name, at in marks.points.items()}


def test_without_the_package_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ai_edge_litert", None)
    monkeypatch.setattr(landmarks.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(LandmarksUnavailable, match=r"fapstream\[landmarks\]") as caught:
        Landmarker()
    assert isinstance(caught.value, FapstreamError)
    assert not isinstance(caught.value, PhotoError)


@needs_litert
def test_a_front_photo_has_its_points(finder: Port) -> None:
    marks = finder.front(photo("front"))
    off = errors(marks, "front")
    assert set(off) == set(TRUTH["front"]["points"])
    assert marks.size == (500, 500)
    assert np.median(list(off.values())) < 0.04
    for name in ("3.5", "3.6"):
        assert off[name] < 0.025
        assert marks.confidence[name] > 0.3
    assert max(off[name] for name in ("3.11", "3.8", "9.15", "stomion", "8.3", "8.4")) < 0.06
    assert all(0 < c <= 1 for c in marks.confidence.values())


@needs_litert
def test_a_profile_has_its_points(finder: Port) -> None:
    marks, facing = finder.profile(photo("profile"))
    off = errors(marks, "profile")
    assert facing == TRUTH["profile"]["facing"]
    assert set(off) == set(TRUTH["profile"]["points"])
    assert max(off[name] for name in ("9.15", "8.1", "stomion", "8.2", "sulcus", "2.10")) < 0.06
    assert marks.confidence["8.2"] > 0.2 > marks.confidence["10.4" if facing == "right" else "10.3"]


@needs_litert
def test_a_mirrored_profile_looks_the_other_way(finder: Port) -> None:
    marks, facing = finder.profile(photo("profile"))
    other, turned = finder.profile(photo("profile")[:, ::-1])
    assert {facing, turned} == {"left", "right"}
    for name in ("9.3", "stomion", "2.10"):
        assert other.points[name] == pytest.approx(
            (500 - marks.points[name][0], marks.points[name][1]), abs=4
        )


@needs_litert
def test_colour_does_not_matter(finder: Port) -> None:
    grey = np.asarray(Image.open(FOLDER / "person601.front.jpg").convert("L"))
    marks = finder.front(np.stack([grey, grey, grey], -1))
    assert np.median(list(errors(marks, "front").values())) < 0.04


@needs_litert
def test_a_small_face_in_a_large_photo_is_found(finder: Port) -> None:
    small = np.full((1200, 1600, 3), 200, np.uint8)
    small[300:550, 900:1150] = photo("front")[::2, ::2]
    marks = finder.front(small)
    x, y = marks.points["stomion"]
    wanted = np.array(TRUTH["front"]["points"]["stomion"]) / 2 + (900, 300)
    assert (x, y) == pytest.approx(tuple(wanted), abs=3)


@needs_litert
def test_each_photo_is_what_it_is_said_to_be(finder: Port) -> None:
    with pytest.raises(PhotoError, match="front photo"):
        finder.front(photo("profile"))
    with pytest.raises(PhotoError, match="profile photo is turned by only about"):
        finder.profile(photo("front"))


@needs_litert
@pytest.mark.parametrize("view", ["front", "profile"])
def test_two_faces_are_one_too_many(finder: Port, view: str) -> None:
    two = np.concatenate([photo(view), photo(view)], axis=1)
    with pytest.raises(PhotoError, match="more than one face"):
        getattr(finder, view)(two)


@needs_litert
@pytest.mark.parametrize("view", ["front", "profile"])
def test_where_there_is_nobody_nothing_is_found(finder: Port, view: str) -> None:
    find = getattr(finder, view)
    noise = np.random.default_rng(0).integers(0, 255, (300, 200, 3)).astype(np.uint8)
    for picture in (np.zeros((400, 300, 3), np.uint8), np.full((64, 2000, 3), 180, np.uint8), noise):
        with pytest.raises(PhotoError, match="no face" if view == "front" else "outline"):
            find(picture)


@needs_litert
@pytest.mark.parametrize("view", ["front", "profile"])
def test_what_is_no_picture_is_refused(finder: Port, view: str) -> None:
    find = getattr(finder, view)
    for picture in (
        np.zeros((100, 100), np.uint8),
        np.zeros((100, 100, 4), np.uint8),
        np.zeros((100, 100, 3)),
    ):
        with pytest.raises(PhotoError, match="uint8"):
            find(picture)
    for shape in ((0, 0, 3), (63, 500, 3), (1, 1, 3)):
        with pytest.raises(PhotoError, match="too small"):
            find(np.zeros(shape, np.uint8))


@needs_litert
def test_a_face_is_as_sure_as_the_worst_look_at_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first look at a profile can be sure of a face; the next ones stray from it."""
    finder, looks = Landmarker(), iter([0.99, 0.2, 0.6])
    mesh = np.random.default_rng(0).uniform(100, 300, (468, 3))
    monkeypatch.setattr(finder, "_look", lambda picture, crops: (mesh, next(looks)))
    assert finder.mesh(photo("profile"), finder.faces(photo("profile"))[0])[1] == 0.2


@needs_litert
def test_a_model_that_is_not_there_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(landmarks, "MODELS", str(tmp_path))
    with pytest.raises(DataError, match="face_detection_short_range"):
        Landmarker().front(photo("front"))


def test_the_models_are_in_the_package_with_their_origin() -> None:
    names = {path.name for path in Path(MODELS).iterdir()}
    text = (Path(MODELS) / "README.md").read_text()
    for model in (landmarks.DETECTOR, landmarks.MESH, landmarks.MASK):
        assert f"{model}.tflite" in names
        assert model in text
