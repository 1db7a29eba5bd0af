"""The methods against one another, on faces whose shape is known between the points too."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.adapt.fit import METHODS, Task
from fapstream.adapt.rigid import Similarity
from fapstream.adapt.warp import jacobians
from tests.unit.adapt.persons import made_up, places
from tests.unit.head.packaged import packaged

PLACES = {name: np.array(at) for name, at in packaged().fdp.items()} | dict(places())
SKIN = packaged().part("skin").positions.astype(float)[::23]


def task(seed: int, without: str = "") -> Task:
    pose = Similarity(1.1, np.eye(3), np.array([0.01, -0.02, 0.03]))
    target = {name: pose(at[None])[0] for name, at in made_up(seed).items() if name != without}
    return Task(places(), target, PLACES)


@pytest.mark.parametrize("method", sorted(METHODS))
@pytest.mark.parametrize("seed", range(3))
def test_every_method_improves_on_the_rigid_fit_and_folds_nothing(method: str, seed: int) -> None:
    work = task(seed)
    source, target = work.arrays()
    warp, rigid = METHODS[method](work), METHODS["rigid"](work)
    gap, plain = (np.linalg.norm(w(source) - target, axis=1).mean() for w in (warp, rigid))
    assert gap < (1.001 if method == "rigid" else 0.35) * plain
    assert np.linalg.det(jacobians(warp, SKIN)).min() > 0


@pytest.mark.parametrize("seed", range(4))
def test_a_point_that_was_not_given_is_nearer_than_by_the_rigid_fit(seed: int) -> None:
    gaps = {"rigid": 0.0, "best": 0.0}
    for name in ("9.3", "8.3", "2.1", "zygion_l", "3.7", "glabella"):
        work = task(seed, name)
        wanted = task(seed).target[name]
        for way in gaps:
            gaps[way] += float(np.linalg.norm(METHODS[way](work)(places()[name][None])[0] - wanted))
    assert gaps["best"] < 0.75 * gaps["rigid"]
