"""Where refinement begins."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.adapt.points import Facing, Marks
from fapstream.adapt.refine import locate
from fapstream.adapt.start import laid_over, seen_side, start
from tests.unit.adapt.persons import cameras, made_up, photographed, places

NAMES = tuple(places())
GENERIC = np.array(list(places().values()))


@pytest.mark.parametrize("facing", ["left", "right"])
@pytest.mark.parametrize("seed", range(3))
def test_it_is_the_papers_solution_and_refinement_improves_it(seed: int, facing: Facing) -> None:
    truth = made_up(seed)
    photos = photographed(truth, cameras(truth, seed, facing), facing)
    begun = start(seen_side(photos), facing, NAMES, GENERIC)
    both = [
        i for i, name in enumerate(NAMES) if name in photos.front.points and name in photos.profile.points
    ]  # type: ignore[union-attr]
    assert np.abs(begun.points[both] - GENERIC[both]).max() > 1e-3, "located, not taken from the generic head"
    found = locate(photos, places())
    for view, marks in seen_side(photos).items():
        seen = marks.array(NAMES)
        first = np.nanmedian(np.linalg.norm(begun.cameras[view].project(begun.points) - seen, axis=1))
        last = np.nanmedian(np.linalg.norm(found.errors[view], axis=1))
        assert first < 30, "the first cameras look at the head already"
        assert last < first / 5
    true = cameras(truth, seed, facing)["front"].closeness
    assert abs(np.log(found.sights["front"].camera.closeness / true)) < 0.3


def test_without_points_in_both_photos_the_head_is_laid_over_each() -> None:
    truth = made_up(0)
    photos = photographed(truth, cameras(truth, 0))
    assert photos.profile is not None
    few = {name: at for name, at in photos.profile.points.items() if name not in photos.front.points}
    begun = start({"front": photos.front, "profile": Marks((1000, 1000), few)}, "right", NAMES, GENERIC)
    assert begun.points is GENERIC
    assert not begun.cameras["front"].turn.any()
    off = begun.cameras["front"].project(GENERIC) - photos.front.array(NAMES)
    assert np.nanmedian(np.linalg.norm(off, axis=1)) < 30


def test_no_point_is_the_middle_one_point_is_met_two_set_the_size() -> None:
    def camera(points: dict[str, tuple[float, float]]) -> np.ndarray:
        found = laid_over({"front": Marks((800, 600), points)}, "right", NAMES, GENERIC)["front"]
        return found.project(GENERIC)

    assert np.abs(camera({}).mean(0) - (400, 300)).max() < 30
    np.testing.assert_allclose(camera({"9.3": (100.0, 50.0)})[NAMES.index("9.3")], (100, 50), atol=1e-6)
    eyes = camera({"3.5": (450.0, 200.0), "3.6": (350.0, 200.0)})
    gap = eyes[NAMES.index("3.5")] - eyes[NAMES.index("3.6")]
    np.testing.assert_allclose(gap, (100, 0), atol=1)
    assert np.isfinite(camera({"3.5": (5.0, 5.0), "3.6": (5.0, 5.0)})).all()


def test_points_of_the_hidden_side_are_taken_for_those_of_the_seen_one() -> None:
    photos = photographed(made_up(0), cameras(made_up(0), 0))
    marks = seen_side(photos)["profile"]
    assert "8.4" in marks.points, "a head that looks right shows its right corner of the mouth"
    assert "8.3" not in marks.points
