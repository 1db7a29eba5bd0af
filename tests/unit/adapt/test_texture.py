"""The skin's picture from photos."""

from __future__ import annotations

import io
from functools import cache

import numpy as np
import pytest
from PIL import Image as Picture

from fapstream.adapt.layers import SIZE, Canvas, Photo
from fapstream.adapt.shading import linear, unrendered
from fapstream.adapt.texture import paint_skin
from tests.unit.adapt.painted import PERSON, photographed, plain
from tests.unit.adapt.persons import adapted
from tests.unit.head.packaged import packaged


@cache
def canvas() -> Canvas:
    return Canvas.of(adapted(PERSON).part("skin"), packaged().part("skin"))


@cache
def painted(*views: str) -> np.ndarray:
    """Light of the texels."""
    return light_of(paint_skin(adapted(PERSON), packaged(), photographed(plain, views)).data)


def light_of(data: bytes) -> np.ndarray:
    picture = Picture.open(io.BytesIO(data))
    assert picture.size == (SIZE, SIZE)
    return canvas().texels(linear(np.asarray(picture)))


def near(x: float, y: float, z: float, reach: float = 0.01) -> np.ndarray:
    return np.linalg.norm(canvas().home - (x, y, z), axis=1) < reach


PLACES = {"left cheek": (0.04, 0.0, 0.08), "right cheek": (-0.04, 0.0, 0.08), "chin": (0.0, -0.055, 0.095),
          "forehead": (0.0, 0.07, 0.095)}  # fmt: skip


@pytest.mark.parametrize("place", PLACES)
def test_the_face_has_the_colours_of_the_photos(place: str) -> None:
    """As the clients will show it: the picture is what lamps make the photo's light of."""
    found, wanted = (np.median(rows[near(*PLACES[place])], axis=0) for rows in (
        painted("front", "profile"), unrendered(plain(canvas().home))))  # fmt: skip
    assert np.abs(np.log(found / wanted)).max() < 0.22


def test_both_sides_are_there_from_one_profile() -> None:
    left, right = (
        np.median(painted("front", "profile")[near(x, 0.02, 0.02, 0.012)], axis=0) for x in (0.072, -0.072)
    )
    assert np.abs(np.log(left / right)).max() < 0.1


def test_what_nothing_saw_is_skin_of_the_same_kind() -> None:
    found = painted("front")
    nape = (canvas().home[:, 2] < -0.02) & (canvas().home[:, 1] < -0.06)
    cheek = np.median(found[near(0.04, 0.0, 0.08)], axis=0)
    ratio = np.median(found[nape], axis=0) / cheek
    assert (ratio > 0.3).all()
    assert (ratio < 2.0).all()
    assert not (found.max(1) < 0.004).mean() > 0.3, "no large holes"


def test_a_darker_profile_photo_leaves_no_seam() -> None:
    """Equations 15 and 16: the profile is calibrated to the front."""
    photos = dict(photographed(plain))
    dark = (photos["profile"].pixels * 0.6).astype(np.uint8)
    photos["profile"] = Photo(dark, photos["profile"].camera)
    found = light_of(paint_skin(adapted(PERSON), packaged(), photos).data)
    middle, side = (np.median(found[near(*at)], axis=0) for at in ((0.05, -0.01, 0.07), (0.068, 0.0, 0.03)))
    plainly, aside = (np.median(painted("front", "profile")[near(*at)], axis=0)
                      for at in ((0.05, -0.01, 0.07), (0.068, 0.0, 0.03)))  # fmt: skip
    assert np.abs(np.log(middle / side) - np.log(plainly / aside)).max() < 0.15


def test_extreme_photos_give_a_picture() -> None:
    for value in (0, 255):
        photos = {view: Photo(np.full_like(photo.pixels, value), photo.camera)
                  for view, photo in photographed(plain).items()}  # fmt: skip
        assert np.isfinite(light_of(paint_skin(adapted(PERSON), packaged(), photos).data)).all()
