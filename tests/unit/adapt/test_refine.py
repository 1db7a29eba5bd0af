"""Feature points in space from points in photos."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from fapstream.adapt.points import Facing, Marks, PhotoPoints, feature_points
from fapstream.adapt.refine import Located, locate
from fapstream.adapt.rigid import Similarity
from fapstream.errors import PointsError
from tests.unit.adapt.persons import NAMES, cameras, known, made_up, photographed, places

Floats = NDArray[np.float64]


def off(found: Located, truth: Mapping[str, Floats]) -> Floats:
    """How far each point is from the truth once both are aligned, millimetres (n,)."""
    wanted = np.array([truth[name] for name in found.names])
    return 1000 * np.linalg.norm(Similarity.fit(found.points, wanted)(found.points) - wanted, axis=1)


def rms(values: Floats) -> float:
    return float(np.sqrt((values**2).mean()))


GENERIC = np.array(list(places().values()))


def start_error(truth: Mapping[str, Floats]) -> float:
    wanted = np.array([truth[name] for name in places()])
    return rms(1000 * np.linalg.norm(Similarity.fit(GENERIC, wanted)(GENERIC) - wanted, axis=1))


@pytest.mark.parametrize("facing", ["left", "right"])
@pytest.mark.parametrize("seed", range(4))
def test_exact_points_are_found_in_space(seed: int, facing: Facing) -> None:
    truth = made_up(seed)
    found = locate(photographed(truth, cameras(truth, seed, facing), facing), places())
    both = [feature_points()[name].views == ("front", "profile") for name in found.names]
    assert rms(off(found, truth)) < 0.55 * start_error(truth)
    assert rms(off(found, truth)[both]) < 0.4 * start_error(truth)
    for errors in found.errors.values():
        assert np.nanmedian(np.abs(errors)) < 0.5


@pytest.mark.parametrize("name", NAMES)
def test_real_looking_persons_are_reprojected_to_a_fraction_of_a_pixel(name: str) -> None:
    found = locate(known(name), places())
    squared = np.concatenate([(errors**2).sum(1) for errors in found.errors.values()])
    assert np.nanmean(squared) < 0.42, "the paper's Table 2 has 0.25 to 0.42"


def test_a_profile_of_another_size_and_place_in_its_photo_is_the_same() -> None:
    truth = made_up(2)
    photos = photographed(truth, cameras(truth, 2))
    assert photos.profile is not None
    small = {name: (0.5 * x + 100, 0.5 * y + 40) for name, (x, y) in photos.profile.points.items()}
    other = replace(photos, profile=Marks((600, 700), small))
    assert rms(off(locate(other, places()), truth)) < 1.15 * rms(off(locate(photos, places()), truth)) + 0.1


def test_a_front_photo_alone_will_do() -> None:
    truth = made_up(3)
    photos = photographed(truth, cameras(truth, 3))
    found = locate(replace(photos, profile=None), places())
    assert set(found.sights) == {"front"}
    assert rms(off(found, truth)) < 0.95 * start_error(truth)
    assert np.nanmedian(np.abs(found.errors["front"])) < 0.5


def test_points_of_the_hidden_side_count_for_the_side_that_is_seen() -> None:
    truth = made_up(1)
    photos = photographed(truth, cameras(truth, 1))
    assert photos.profile is not None
    table = feature_points()
    renamed = {table[name].mirror or name: at for name, at in photos.profile.points.items()}
    other = replace(photos, profile=Marks((1000, 1000), renamed))
    assert np.allclose(locate(other, places()).points, locate(photos, places()).points)


def test_one_wrong_point_does_not_pull_the_others() -> None:
    truth = made_up(2)
    photos = photographed(truth, cameras(truth, 2))
    wrong = dict(photos.front.points) | {
        "8.3": (photos.front.points["8.3"][0] + 60, photos.front.points["8.3"][1])
    }
    found = locate(replace(photos, front=Marks((1000, 1000), wrong)), places())
    i = found.names.index("8.3")
    assert np.linalg.norm(found.errors["front"][i]) > 30, "it is told, not believed"
    rest = np.delete(off(found, truth), i)
    assert rms(rest) < 1.5 * rms(off(locate(photos, places()), truth)) + 0.2


def test_unsure_points_are_believed_less() -> None:
    truth = made_up(0)
    photos = photographed(truth, cameras(truth, 0))
    moved = dict(photos.front.points) | {
        "9.3": (photos.front.points["9.3"][0] + 3, photos.front.points["9.3"][1])
    }
    gaps = []
    for sure in (1.0, 0.1):
        marks = Marks((1000, 1000), moved, {"9.3": sure})
        found = locate(replace(photos, front=marks), places())
        gaps.append(np.linalg.norm(found.errors["front"][found.names.index("9.3")]))
    assert gaps[1] > gaps[0] + 0.5


def some(points: Mapping[str, tuple[float, float]], count: int) -> dict[str, tuple[float, float]]:
    return dict(list(points.items())[:count])


def test_bad_points_are_refused_with_the_reason() -> None:
    truth = made_up(0)
    photos = photographed(truth, cameras(truth, 0))
    assert photos.profile is not None
    few = replace(photos, front=Marks((1000, 1000), some(photos.front.points, 5)))
    with pytest.raises(PointsError, match="front: 5 points are too few"):
        locate(few, places())
    line = {name: (10.0 * k, 20.0 * k) for k, name in enumerate(photos.front.points)}
    with pytest.raises(PointsError, match="one line"):
        locate(replace(photos, front=Marks((1000, 1000), line)), places())
    with pytest.raises(PointsError, match="one line"):
        locate(replace(photos, front=Marks((9, 9), dict.fromkeys(photos.front.points, (5.0, 5.0)))), places())
    rng = np.random.default_rng(0)
    noise = {name: tuple(rng.uniform(0, 1000, 2).tolist()) for name in photos.front.points}
    with pytest.raises(PointsError, match="do not make a face"):
        locate(replace(photos, front=Marks((1000, 1000), noise)), places())  # type: ignore[arg-type]
    mirrored = {feature_points()[name].mirror or name: at for name, at in photos.front.points.items()}
    with pytest.raises(PointsError, match="exchanged"):
        locate(replace(photos, front=Marks((1000, 1000), mirrored)), places())


def test_exchanged_photos_are_told() -> None:
    truth = made_up(0)
    photos = photographed(truth, cameras(truth, 0))
    assert photos.profile is not None
    names = [name for name in photos.front.points if name in photos.profile.points]
    swapped = PhotoPoints(
        Marks((1000, 1000), {name: photos.profile.points[name] for name in names}),
        Marks((1000, 1000), {name: photos.front.points[name] for name in names}),
    )
    with pytest.raises(PointsError, match="exchanged"):
        locate(swapped, places())


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 10**6), st.integers(8, 60))
def test_whatever_the_points_are_the_answer_is_finite_or_a_typed_error(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    marks = []
    for view in ("front", "profile"):
        names = [name for name, point in feature_points().items() if view in point.views][:count]
        at = rng.uniform(0, 50, (len(names), 2)) * rng.choice([1, 1e-6, 0], 2)
        marks.append(
            Marks((50, 50), {name: (float(x), float(y)) for name, (x, y) in zip(names, at, strict=True)})
        )
    try:
        found = locate(PhotoPoints(*marks), places())
    except PointsError:
        return
    assert np.isfinite(found.points).all()
