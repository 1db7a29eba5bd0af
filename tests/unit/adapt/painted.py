"""Photos of heads whose colours are known everywhere: drawn here, without light and without a graphics
card.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fapstream.adapt.layers import Photo
from fapstream.adapt.person import Fit, fit_points
from fapstream.adapt.raster import cover, nearest
from fapstream.adapt.shading import encoded
from fapstream.adapt.views import Camera
from fapstream.head.mesh import Head
from tests.unit.adapt.persons import adapted, known
from tests.unit.head.packaged import packaged

Floats = NDArray[np.float64]
Colour = Callable[[Floats], Floats]
"""Light (n, 3) by place on the generic head (n, 3)."""

BACKDROP = (0.70, 0.75, 0.80)
SIZE = 500
PERSON = "person3"


def plain(places: Floats) -> Floats:
    """Skin that is a little redder to the front and darker upwards."""
    x, y, z = places.T
    return np.stack([0.45 + 1.0 * z, 0.27 + 0 * x, 0.20 + 0 * x], 1) * (1 - 1.2 * np.abs(y))[:, None]


@cache
def fit() -> Fit:
    """Of the person."""
    return fit_points(packaged(), known(PERSON))


def small(camera: Camera) -> Camera:
    """The camera of a photo of 1000 pixels for one of `SIZE`."""
    share = SIZE / 1000
    centre = (camera.centre[0] * share, camera.centre[1] * share)
    return Camera(
        camera.look, centre, camera.pivot, camera.scale * share, camera.closeness, camera.turn, camera.shift
    )


def photographed(colour: Colour, views: tuple[str, ...] = ("front", "profile")) -> Mapping[str, Photo]:
    """The person's photos, if skin had these colours."""
    return {view: Photo(drawn(adapted(PERSON), small(fit().located.sights[view].camera), colour),
                        small(fit().located.sights[view].camera)) for view in views}  # fmt: skip


def drawn(head: Head, camera: Camera, colour: Colour) -> NDArray[np.uint8]:
    """The skin and white eyeballs before a backdrop."""
    picture = np.tile(np.array(BACKDROP), (SIZE, SIZE, 1))
    places, corners, lights, start = [], [], [], 0
    for name in ("skin", "eye_l", "eye_r"):
        part, home = head.part(name), packaged().part(name).positions.astype(float)
        places.append(part.positions.astype(float))
        corners.append(part.triangles.astype(np.int64) + start)
        lights.append(colour(home) if name == "skin" else np.full((len(home), 3), 0.8))
        start += len(home)
    points, triangles, light = np.concatenate(places), np.concatenate(corners), np.concatenate(lights)
    hits = cover(camera.project(points), triangles, (SIZE, SIZE))
    chosen, _ = nearest(hits, hits.mixed(triangles, camera.inside(points)[:, 2]), (SIZE, SIZE))
    there = chosen >= 0
    picture[there] = hits.mixed(triangles, light)[chosen[there]]
    return encoded(picture)
