"""The whole way from points and photos to a head."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.adapt.fit import METHODS
from fapstream.adapt.person import fit_points, make_head, of_pictures, of_size
from fapstream.adapt.points import Marks, PhotoPoints
from fapstream.adapt.rigid import Similarity
from fapstream.errors import InputError, PointsError
from fapstream.head.gltf import read_head
from fapstream.head.gltf_write import write_head
from tests.unit.adapt.painted import PERSON, fit, photographed, plain
from tests.unit.adapt.persons import known
from tests.unit.head.packaged import packaged


def scaled(photos: PhotoPoints, share: float) -> PhotoPoints:
    rows = []
    for marks in (photos.front, photos.profile):
        assert marks is not None
        size = (round(marks.size[0] * share), round(marks.size[1] * share))
        rows.append(Marks(size, {name: (x * share, y * share) for name, (x, y) in marks.points.items()}))
    return PhotoPoints(*rows, photos.facing)


def test_photos_and_points_make_a_head_in_so_many_steps() -> None:
    pictures = {view: photo.pixels for view, photo in photographed(plain).items()}
    steps: list[tuple[int, int]] = []
    found = fit_points(packaged(), scaled(known(PERSON), 0.5))
    head = make_head(packaged(), found, pictures, "Somebody", lambda done, total: steps.append((done, total)))
    assert steps[0][0] == 0
    assert steps[-1][0] == steps[-1][1]
    assert [done for done, _ in steps] == sorted(done for done, _ in steps)
    assert read_head(write_head(head), "x").name == "Somebody"
    skin, old = (h.part("skin").material.texture for h in (head, packaged()))
    assert skin is not None
    assert old is not None
    assert skin.data != old.data


def test_points_alone_make_a_head_in_the_generic_colours() -> None:
    head = make_head(packaged(), fit(), {}, "Plain")
    assert head.part("skin").material == packaged().part("skin").material
    assert np.abs(head.part("skin").positions - packaged().part("skin").positions).max() > 1e-3


def test_the_mesh_is_seen_where_the_points_are() -> None:
    names = fit().located.names
    places = np.array([packaged().fdp[name] for name in names if name in packaged().fdp])
    for view, pixels in fit().mesh(places).items():
        seen = fit().located.sights[view].seen[[name in packaged().fdp for name in names]]
        gaps = np.linalg.norm(pixels - seen, axis=1)
        assert np.nanmedian(gaps) < 1.5


@pytest.mark.parametrize("method", sorted(METHODS))
@pytest.mark.parametrize("seed", range(4))
def test_points_that_are_badly_off_fold_no_face(method: str, seed: int) -> None:
    """Or they are refused."""
    rng, good = np.random.default_rng(seed), known(PERSON)
    noisy = {
        name: tuple(np.clip(at + rng.normal(0, 15, 2), 0, 1000).tolist())
        for name, at in good.front.points.items()
    }
    try:
        found = fit_points(
            packaged(), PhotoPoints(Marks((1000, 1000), noisy), good.profile, good.facing), method
        )  # type: ignore[arg-type]
    except PointsError:
        return
    skin = packaged().part("skin")
    rest = skin.positions.astype(float)
    moved = found.warp(rest)
    before, after = (np.cross(p[skin.triangles[:, 1]] - p[skin.triangles[:, 0]],
                              p[skin.triangles[:, 2]] - p[skin.triangles[:, 0]])
                     for p in (Similarity.fit(rest, moved)(rest), moved))  # fmt: skip
    large = (before**2).sum(1) > 1e-16
    assert ((before * after).sum(1)[large] > 0).all()


def test_an_unknown_method_is_named() -> None:
    with pytest.raises(InputError, match="magic"):
        fit_points(packaged(), known(PERSON), "magic")


def test_points_of_the_same_photo_at_another_size_are_scaled() -> None:
    marks = Marks((100, 80), {"9.3": (50.0, 40.0)}, {"9.3": 0.5})
    assert of_size(marks, (200, 160), "front").points == {"9.3": (100.0, 80.0)}
    assert of_size(marks, (200, 160), "front").confidence == {"9.3": 0.5}
    assert of_size(marks, (100, 80), "front") is marks
    with pytest.raises(PointsError, match="front: the points are of a photo of 100 x 80"):
        of_size(marks, (200, 100), "front")


def test_points_of_a_photo_that_is_not_there_are_left_out() -> None:
    points = known(PERSON)
    pictures = {"front": np.zeros((500, 500, 3), np.uint8)}
    found = of_pictures(points, pictures)
    assert found.profile is None
    assert found.front.size == (500, 500)
    both = of_pictures(points, pictures | {"profile": np.zeros((500, 500, 3), np.uint8)})
    assert both.facing == points.facing
    assert both.profile is not None
