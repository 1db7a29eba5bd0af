"""The whole way: feature points, and photos, to a head."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fapstream.adapt.carry import carry
from fapstream.adapt.dress import dressed
from fapstream.adapt.fit import METHODS, Task, rigid
from fapstream.adapt.layers import Photo
from fapstream.adapt.points import Marks, PhotoPoints, generic_places
from fapstream.adapt.refine import Located, locate
from fapstream.adapt.texture import paint_skin
from fapstream.adapt.warp import Warp, unfolded
from fapstream.errors import InputError, PointsError
from fapstream.head.mesh import Head

Floats = NDArray[np.float64]
Pixels = NDArray[np.uint8]
Progress = Callable[[int, int], None]

DEFAULT_METHOD = next(iter(METHODS))
SAME_SHAPE = 0.01
"""Relative difference of width over height up to which points are of the same photo at another size."""


@dataclass(frozen=True, slots=True)
class Fit:
    """The generic head fitted to feature points: where these are in space, the warp that takes the head
    there, and the vertices (n, 3) of its skin there, metres.
    """

    located: Located
    warp: Warp
    skin: Floats

    def mesh(self, points: Floats) -> dict[str, Floats]:
        """Where points (n, 3) of the generic head are seen, by view: (n, 2) pixels."""
        moved = self.warp(points)
        return {view: sight.camera.project(moved) for view, sight in self.located.sights.items()}


def fit_points(generic: Head, photos: PhotoPoints, method: str = DEFAULT_METHOD) -> Fit:
    """The fit; where the points would fold the face, as much of it as does not.

    Raises PointsError for points that make no face, InputError for a method that there is not.
    """
    if method not in METHODS:
        raise InputError(f"there is no method {method[:40]!r}; there are: {', '.join(METHODS)}")
    places = generic_places(generic.fdp)
    located = locate(photos, places)
    task, skin = Task.of(located, places, generic.fdp), generic.part("skin")
    points = skin.positions.astype(np.float64)
    return Fit(located, *unfolded(METHODS[method](task), rigid(task), points, skin.triangles))


def make_head(
    generic: Head, fit: Fit, pictures: Mapping[str, Pixels], name: str, progress: Progress | None = None
) -> Head:
    """The head of the person in the photos: `pictures` by view, (h, w, 3) sRGB, those that the points are
    of. Without pictures it keeps the generic head's colours. `progress` is told (steps done, steps).
    """
    tell = progress or (lambda done, total: None)
    tell(0, 3)
    head = carry(generic, fit.warp, name)
    tell(1, 3)
    photos = {
        view: Photo(pictures[view], sight.camera)
        for view, sight in fit.located.sights.items()
        if view in pictures
    }
    if not photos:
        return head
    skin = paint_skin(head, generic, photos)
    tell(2, 3)
    parts = tuple(
        replace(part, material=replace(part.material, texture=skin, color=(1.0, 1.0, 1.0, 1.0)))
        if part.name == "skin"
        else part
        for part in head.parts
    )
    finished = dressed(replace(head, parts=parts), generic, photos)
    tell(3, 3)
    return finished


def of_pictures(photos: PhotoPoints, pictures: Mapping[str, Pixels]) -> PhotoPoints:
    """The points at the size of the photos; those of a photo that is not there are left out. Raises
    PointsError.
    """
    front, profile = photos.front, photos.profile
    if "front" in pictures:
        front = of_size(front, _size(pictures["front"]), "front")
    if profile is None or "profile" not in pictures:
        return PhotoPoints(front)
    return PhotoPoints(front, of_size(profile, _size(pictures["profile"]), "profile"), photos.facing)


def _size(picture: Pixels) -> tuple[int, int]:
    return picture.shape[1], picture.shape[0]


def of_size(marks: Marks, size: tuple[int, int], where: str) -> Marks:
    """The points of a photo that is now `size` (width, height). Raises PointsError if it cannot be the same
    photo.
    """
    if marks.size == size:
        return marks
    across, down = size[0] / marks.size[0], size[1] / marks.size[1]
    if abs(across / down - 1) > SAME_SHAPE:
        raise PointsError(
            f"{where}: the points are of a photo of {marks.size[0]} x {marks.size[1]} pixels, this one has "
            f"{size[0]} x {size[1]}"
        )
    points = {name: (x * across, y * down) for name, (x, y) in marks.points.items()}
    return replace(marks, size=size, points=points)
