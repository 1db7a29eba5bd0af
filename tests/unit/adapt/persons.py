"""Persons to adapt the generic head to: three from the generator, and any number that are made up here.

`persons/*.points.json` are the first files of `tools/identities.py` for the seeds 0, 3 and 8: true feature
points.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fapstream.adapt.carry import carry
from fapstream.adapt.fit import METHODS, Task
from fapstream.adapt.points import (
    Facing,
    Marks,
    PhotoPoints,
    feature_points,
    generic_places,
    near_side,
    read_points,
)
from fapstream.adapt.refine import locate
from fapstream.adapt.views import Camera
from fapstream.head.mesh import Head
from tests.unit.head.packaged import packaged

Floats = NDArray[np.float64]

FOLDER = Path(__file__).parent / "persons"
NAMES = sorted(path.name.removesuffix(".points.json") for path in FOLDER.glob("*.points.json"))


@cache
def places() -> Mapping[str, Floats]:
    """Feature points of the generic head by name."""
    return generic_places(packaged().fdp)


def known(name: str) -> PhotoPoints:
    """The feature points of a person of the generator."""
    return read_points((FOLDER / f"{name}.points.json").read_text(), name)


@cache
def adapted(name: str, method: str = "best") -> Head:
    """The head of a person of the generator."""
    head = packaged()
    task = Task.of(locate(known(name), places()), places(), head.fdp)
    return carry(head, METHODS[method](task), name)


def made_up(seed: int) -> dict[str, Floats]:
    """Feature points of a face that differs from the generic one smoothly, by name: (3,), metres."""
    rng = np.random.default_rng(seed)
    waves, phases, heights = rng.normal(0, 14, (4, 3)), rng.uniform(0, 6, 4), rng.normal(0, 0.0015, (4, 3))
    stretch = np.eye(3) + np.diag(rng.normal(0, 0.03, 3))
    found = {}
    for name, place in places().items():
        x = np.array([abs(place[0]), *place[1:]])
        moved = stretch @ x + np.sin(waves @ x + phases) @ heights
        side = np.sign(place[0])
        found[name] = np.array([moved[0] * side, *moved[1:]])
    return found


def cameras(
    points: Mapping[str, Floats], seed: int, facing: Facing = "right", size: int = 1000
) -> dict[str, Camera]:
    """Two cameras that look at a face, nearly straight."""
    rng = np.random.default_rng(seed)
    middle = np.mean(list(points.values()), axis=0)
    return {
        view: Camera(
            look, (size / 2, size / 2), middle, size / 0.36, 1 / rng.uniform(0.8, 1.6), rng.normal(0, 0.03,
            3), rng.normal(0, 0.006, 2),
        )
        for view, look in (("front", "front"), ("profile", facing))
    }  # fmt: skip


def photographed(
    points: Mapping[str, Floats], seen_by: Mapping[str, Camera], facing: Facing = "right"
) -> PhotoPoints:
    """What the cameras see of a face."""
    marks = {}
    for view, camera in seen_by.items():
        found = {}
        for name, point in feature_points().items():
            far = (
                view == "profile"
                and point.mirror is not None
                and np.sign(places()[name][0]) != near_side(facing)
            )
            if view in point.views and not far:
                x, y = camera.project(points[name][None])[0]
                found[name] = (float(x), float(y))
        marks[view] = Marks((1000, 1000), found)
    return PhotoPoints(marks["front"], marks.get("profile"), facing)
