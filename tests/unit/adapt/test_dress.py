"""Eyes, hair and brows after the photos."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image as Picture

from fapstream.adapt.dress import colour_under, dressed, iris_colour
from fapstream.adapt.layers import Photo
from fapstream.adapt.shading import LUMINANCE, encoded, linear
from tests.unit.adapt.painted import PERSON, SIZE, photographed, plain
from tests.unit.adapt.persons import adapted
from tests.unit.head.packaged import packaged

BLUE, RED = np.array([0.03, 0.06, 0.14]), np.array([0.16, 0.05, 0.02])


def with_eyes_and_hair(hair: np.ndarray) -> dict[str, Photo]:
    """The painted photos with blue irises, and hair above the hairline and behind."""
    head, photos = adapted(PERSON), {}
    for view, photo in photographed(plain).items():
        pixels = photo.pixels.copy()
        rows, columns = np.mgrid[:SIZE, :SIZE] + 0.5
        if view == "front":
            for name in ("3.5", "3.6"):
                x, y = photo.camera.project(np.array([head.fdp[name]]))[0]
                iris = np.hypot(columns - x, rows - y) < 0.006 * photo.camera.scale
                pixels[iris] = encoded(BLUE)
                pixels[np.hypot(columns - x - 3, rows - y + 3) < 2] = 255  # the lamp in it
        top = photo.camera.project(np.array([head.fdp["11.1"]]))[0, 1]
        crown = photo.camera.project(np.array([head.fdp["11.4"]]))[0]
        dome = np.hypot(columns - crown[0], rows - crown[1] - 60) < 0.09 * photo.camera.scale
        pixels[dome & (rows < top)] = encoded(hair)
        photos[view] = Photo(pixels, photo.camera)
    return photos


def test_irises_are_found_and_painted() -> None:
    photos = with_eyes_and_hair(RED)
    for side in "lr":
        colour = iris_colour(adapted(PERSON), side, photos["front"])
        assert colour is not None
        np.testing.assert_allclose(colour, BLUE, rtol=0.1)
    head = dressed(adapted(PERSON), packaged(), photos)
    for name in ("eye_l", "eye_r"):
        picture = linear(picture_of(head, name)[..., :3])
        n = len(picture)
        iris = picture[n // 2, int(n * (0.5 + 0.5 * 0.38))]
        assert iris[2] > iris[1] > iris[0], "blue"
        before = linear(picture_of(adapted(PERSON), name)[..., :3])
        np.testing.assert_allclose(picture[n // 2, -3], before[n // 2, -3], atol=0.02), "the white stays"
        assert (picture[n // 2, n // 2] < 0.04).all(), "and the pupil is black"


def picture_of(head: object, name: str) -> np.ndarray:
    texture = head.part(name).material.texture  # type: ignore[attr-defined]
    return np.asarray(Picture.open(io.BytesIO(texture.data)).convert("RGBA"))


@pytest.mark.parametrize("hair", [RED, np.array([0.030, 0.025, 0.020])])
def test_hair_takes_the_colour_of_the_photos(hair: np.ndarray) -> None:
    photos, head = with_eyes_and_hair(hair), adapted(PERSON)
    found = colour_under(head, head.part("hair"), photos)
    assert found is not None
    np.testing.assert_allclose(found, hair, rtol=0.15)
    new, old = (picture_of(h, "hair") for h in (dressed(head, packaged(), photos), head))
    assert np.array_equal(new[..., 3] > 127, old[..., 3] > 127), "the strands stay"
    shown = linear(new[..., :3])[new[..., 3] > 127]
    middle = np.median(shown, axis=0)
    np.testing.assert_allclose(middle / (middle @ LUMINANCE), hair / (hair @ LUMINANCE), rtol=0.15)


def test_clothes_take_the_colour_of_the_front_photo() -> None:
    head, green = adapted(PERSON), np.array([0.05, 0.30, 0.10])
    photos = dict(photographed(plain))
    pixels = photos["front"].pixels.copy()
    pixels[400:, 60:440] = encoded(green)
    photos["front"] = Photo(pixels, photos["front"].camera)
    found = colour_under(head, head.part("shirt"), {"front": photos["front"]})
    assert found is not None
    np.testing.assert_allclose(found, green, rtol=0.2)
    shirt = linear(picture_of(dressed(head, packaged(), photos), "shirt")[..., :3]).mean((0, 1))
    assert shirt[1] > 2 * shirt[0]
    assert shirt[1] > 2 * shirt[2]


def test_photos_without_hair_leave_it() -> None:
    head = adapted(PERSON)
    bare = {view: Photo(np.full_like(p.pixels, 180), p.camera) for view, p in photographed(plain).items()}
    assert colour_under(head, head.part("hair"), bare) is None
    assert np.array_equal(picture_of(dressed(head, packaged(), bare), "hair"), picture_of(head, "hair"))


def test_brows_are_the_photos_own_and_lashes_stay() -> None:
    head = dressed(adapted(PERSON), packaged(), photographed(plain))
    before, after = adapted(PERSON).part("lashes"), head.part("lashes")
    assert 0.1 * len(before.triangles) < len(after.triangles) < 0.9 * len(before.triangles)
    high = packaged().part("lashes").positions[after.triangles.ravel(), 1]
    assert high.max() < packaged().fdp["4.1"][1]
    assert len(after.positions) == len(before.positions), "tables still fit"
