"""Named points in a front photo, from a mesh of 468 points laid over the face."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fapstream.adapt.crop import Crop
from fapstream.adapt.found import EYES, MESH_POINTS
from fapstream.adapt.points import Marks, feature_points
from fapstream.adapt.pupils import find_pupil
from fapstream.data import read_lines
from fapstream.errors import DataError, PhotoError

Floats = NDArray[np.float64]

LIDS = {
    "3.6": (33, 246, 161, 160, 159, 158, 157, 173, 133, 155, 154, 153, 145, 144, 163, 7),
    "3.5": (263, 466, 388, 387, 386, 385, 384, 398, 362, 382, 381, 380, 374, 373, 390, 249),
}
"""The outline of each eye in the mesh, by the name of its pupil."""
PUPIL_SURE, PUPIL_UNSURE = 0.5, 0.1
CLEAR = 0.3
"""Contrast of an iris that is surely one."""
FACE_SURE, PROFILE_SURE = 0.9, 0.95
"""Least score of the mesh model for a front photo, and from which on a photo is no profile: it is 1.0 for
nearly every face up to 60 degrees, and at most 0.91 for profiles."""
MOST_TURNED_DEG = 30.0
LEAST_TURNED_DEG = 60.0
"""For a profile; turned_deg tells no more than 65."""
GLANCES = 6
SHIFTED, RESIZED, TURNED = 0.02, 0.06, 0.03


@dataclass(frozen=True, slots=True)
class Named:
    """The table: names (n), what they are a mean of, weights (n, 468), and confidence (n,)."""

    names: tuple[str, ...]
    weights: Floats
    confidence: Floats


@cache
def named() -> Named:
    """The packaged table. Raises DataError."""
    names, rows, confidence = [], [], []
    for number, line in read_lines("adapt", "mesh.tsv"):
        try:
            name, sure, *terms = line.split("\t")
            feature_points()[name]
            row = np.zeros(MESH_POINTS)
            for index, weight in (term.split(":") for term in terms):
                row[int(index)] = float(weight)
            if not abs(row.sum() - 1) < 0.01:
                raise ValueError
            confidence.append(float(sure))
        except (ValueError, KeyError, IndexError):
            raise DataError("mesh.tsv", number, f"{line[:60]!r} is not a point of the mesh") from None
        names.append(name)
        rows.append(row / row.sum())
    return Named(tuple(names), np.array(rows), np.array(confidence))


def glances(crop: Crop) -> list[Crop]:
    """Squares a little aside from one, whose meshes have a steadier mean than each is."""
    beside = []
    for k in range(GLANCES):
        way = 2 * np.pi * k / GLANCES
        middle = np.array(crop.middle) + SHIFTED * crop.side * np.array([np.cos(way), np.sin(way)])
        side = crop.side * (1 + (RESIZED if k % 2 else -RESIZED))
        turn = crop.angle + (TURNED if k % 3 == 0 else -TURNED / 2)
        beside.append(Crop((float(middle[0]), float(middle[1])), side, turn))
    return beside


def turned_deg(mesh: Floats) -> float:
    """How far the face of a mesh (468, 3) is turned to its left, degrees; too little beyond 45."""
    along = mesh[EYES[1]] - mesh[EYES[0]]
    return float(np.degrees(np.arctan2(along[2], np.hypot(along[0], along[1]))))


def check_front(mesh: Floats, score: float) -> None:
    """Raises PhotoError for a face that does not look at the camera; `score` 0..1 is the mesh model's."""
    if not np.isfinite(mesh).all() or not score >= FACE_SURE:
        raise PhotoError("the front photo shows no face from the front; is it a profile?")
    turned = abs(turned_deg(mesh))
    if turned > MOST_TURNED_DEG:
        raise PhotoError(
            f"the face in the front photo is turned by about {turned:.0f} degrees; "
            f"up to {MOST_TURNED_DEG:.0f} will do"
        )


def check_profile(mesh: Floats, score: float) -> None:
    """Raises PhotoError for a face that looks at the camera, or half so."""
    turned = abs(turned_deg(mesh))
    if score >= PROFILE_SURE and turned < LEAST_TURNED_DEG:
        raise PhotoError(
            f"the face in the profile photo is turned by only about {turned:.0f} degrees; "
            "it should look to the side"
        )


def front_marks(picture: NDArray[np.uint8], mesh: Floats, score: float) -> Marks:
    """The points of a front photo from the mesh (468, 3), pixels, that was found in it.

    What lies outside the photo is left out.
    """
    table = named()
    points = dict(zip(table.names, table.weights @ mesh[:, :2], strict=True))
    sure = dict(zip(table.names, table.confidence * score, strict=True))
    for name, lids in LIDS.items():
        points[name], contrast = find_pupil(picture, mesh[list(lids), :2])
        sure[name] = PUPIL_UNSURE + (PUPIL_SURE - PUPIL_UNSURE) * min(contrast / CLEAR, 1.0)
    h, w = picture.shape[:2]
    within = [name for name, (x, y) in points.items() if 0 <= x <= w and 0 <= y <= h]
    return Marks(
        (w, h),
        {name: (float(points[name][0]), float(points[name][1])) for name in within},
        {name: round(float(sure[name]), 3) for name in within},
    )
