"""Where to begin: cameras and points by the paper's linear solution, or cameras that look straight at a
head.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fapstream.adapt.points import Facing, Marks, PhotoPoints, feature_points, near_side
from fapstream.adapt.rigid import Similarity
from fapstream.adapt.views import Camera, PaperCameras, camera_of

Floats = NDArray[np.float64]

USUAL_M = 1.1
"""From how far portraits are taken."""
PORTRAIT_M = 0.36
"""What a portrait shows of the world, metres."""
MOST_TURNED = 0.6
"""Radians that a head may be turned from where the camera expects it."""
FOCAL_SHARE = 1.6
"""Focal length over the longer side of the photo, before anything is known: a portrait, cut a little."""


@dataclass(frozen=True, slots=True)
class Start:
    """Cameras by view, and feature points in space (n, 3), metres, in the generic head's frame."""

    cameras: Mapping[str, Camera]
    points: Floats


def seen_side(photos: PhotoPoints) -> dict[str, Marks]:
    """The points by view; those of the hidden side of a profile count for the side that is seen."""
    marks = {"front": photos.front}
    if photos.profile is not None:
        marks["profile"] = _of_near_side(photos.profile, near_side(photos.facing))
    return marks


def start(marks: Mapping[str, Marks], facing: Facing, names: tuple[str, ...], generic: Floats) -> Start:
    """The paper's solution, where enough points are in both photos; else the generic head and each camera
    by itself.

    `marks` by view, `generic` (n, 3) the places of the points `names` on the generic head.
    """
    paper = _paper(marks, facing, names, generic) if "profile" in marks else None
    return paper or Start(laid_over(marks, facing, names, generic), generic)


def laid_over(
    marks: Mapping[str, Marks], facing: Facing, names: tuple[str, ...], generic: Floats
) -> dict[str, Camera]:
    """Cameras that look straight and see the generic head's points (n, 3) where those of each photo are, or
    in the middle of a photo that has none.
    """
    looks = {"front": "front", "profile": facing}
    return {view: _alone(row, looks[view], names, generic) for view, row in marks.items()}


def _of_near_side(marks: Marks, side: int) -> Marks:
    """The marks with points of the hidden side taken for those of the side that is seen."""
    points, confidence = {}, {}
    for name, at in marks.points.items():
        mirror = feature_points()[name].mirror
        own = name if mirror is None or _side(name) == side else mirror
        points[own] = at
        confidence[own] = marks.confidence.get(name, 1.0)
    return Marks(marks.size, points, confidence)


def _side(name: str) -> int:
    """The sign of x: 1 on the left. The table has the left point of each pair first."""
    order = list(feature_points())
    mirror = feature_points()[name].mirror
    return 1 if mirror is not None and order.index(name) < order.index(mirror) else -1


def _paper(
    marks: Mapping[str, Marks], facing: Facing, names: tuple[str, ...], generic: Floats
) -> Start | None:
    """Sections 2.1 and 2.2: located points, and the head's pose among them. None where too few are in both
    photos.

    The profile photo is first brought to the front's scale and height, for the paper has one camera for both.
    """
    front, profile = (marks[view].array(names) for view in ("front", "profile"))
    both = np.isfinite(front[:, 0]) & np.isfinite(profile[:, 0])
    if both.sum() < 4 or np.ptp(profile[both, 1]) <= 0:
        return None
    size, drop = np.polyfit(profile[both, 1], front[both, 1], 1)
    if not size > 0:
        return None
    centre = (marks["front"].size[0] / 2, marks["front"].size[1] / 2)
    aside = (profile[both, 0].min() + profile[both, 0].max()) / 2
    scaled = np.stack([(profile[:, 0] - aside) * size + centre[0], profile[:, 1] * size + drop], 1)
    paper = PaperCameras(FOCAL_SHARE * max(marks["front"].size), centre, centre, 1.0, facing)
    found = paper.locate(front[both], scaled[both])
    if not np.isfinite(found).all():
        return None
    pose = Similarity.fit(generic[both], found)
    cameras = {view: camera_of(paper, view, pose, generic.mean(0)) for view in ("front", "profile")}
    if any(np.linalg.norm(c.turn) > MOST_TURNED or c.closeness <= 0 for c in cameras.values()):
        return None
    cameras["profile"] = _in_own_photo(
        cameras["profile"], marks["profile"].size, size, generic[both], profile[both]
    )
    points = generic.copy()
    points[both] = pose.inverse()(found)
    return Start(cameras, points)


def _in_own_photo(
    camera: Camera, photo: tuple[int, int], size: float, points: Floats, seen: Floats
) -> Camera:
    """The camera of a photo that was drawn `size` times larger: it sees `points` where they are, on the
    whole.
    """
    own = replace(camera, centre=(photo[0] / 2, photo[1] / 2), scale=camera.scale / size)
    off = np.median(seen - own.project(points), axis=0) * (1, -1)
    return replace(own, shift=own.shift + off / own.scale)


def _alone(marks: Marks, look: str, names: tuple[str, ...], generic: Floats) -> Camera:
    """A camera that looks straight, placed and scaled so that the generic head's points fall on those of the
    photo; in its middle if it has none, as large as portraits are if it has not two.
    """
    seen = marks.array(names)
    known = np.isfinite(seen[:, 0])
    centre = (marks.size[0] / 2, marks.size[1] / 2)
    straight = Camera(look, centre, generic.mean(0), 1.0, 1 / USUAL_M, np.zeros(3), np.zeros(2))
    flat, wanted = straight.project(generic[known]) - centre, seen[known] - centre
    if not known.any():
        return replace(straight, scale=min(marks.size) / PORTRAIT_M)
    a, b = flat - flat.mean(0), wanted - wanted.mean(0)
    scale = float(np.sqrt((b**2).sum() / max(float((a**2).sum()), 1e-12)))
    if not scale > 0:
        scale = min(marks.size) / PORTRAIT_M
    near = (1 / (1 - straight.closeness * straight.inside(generic[known])[:, 2])).mean()
    return replace(straight, scale=scale, shift=(wanted.mean(0) / scale - flat.mean(0)) / near * (1, -1))
