"""Faces in a picture: what the detector's and the mesh model's numbers mean.

The detector is BlazeFace (Bazarevsky et al., 2019), short range; its anchors and scaling are those of its
published graph. The mesh is that of Kartynnik et al. (2019), 468 points.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fapstream.adapt.crop import Crop
from fapstream.errors import PhotoError

Floats = NDArray[np.float64]

DETECTOR_SIDE = 128
"""Pixels a side of the detector's input."""
MESH_SIDE = 192
MESH_POINTS = 468
GRIDS = ((16, 2), (8, 6))
"""Cells a side, and anchors in the middle of each."""
TILE = 0.5
"""Side of a tile over the longer side of the picture."""
FARTHEST = 4.0
"""Inputs of the detector that a face may be large, or off what sees it."""
SURE_ENOUGH = 0.5
SAME = 0.3
"""Boxes that share more than this part of their union are one face."""
SECOND_SIZE, SECOND_SCORE = 0.4, 0.6
"""A second face counts if it is at least so large, compared to the first, and so sure."""
APART = 0.25
"""Two persons' boxes do not share more of the smaller; what does is hair or an ear taken for a face."""
MARGIN = 1.5
"""Side of the square that the mesh model wants, over that of the face in it."""
EYES = (33, 263)
"""Outer corners of the right and the left eye in the mesh."""


@dataclass(frozen=True, slots=True)
class Face:
    """A detected face: box (left, top, right, bottom), `eyes` (2, 2) right and left, pixels; `score` 0..1."""

    box: tuple[float, float, float, float]
    eyes: Floats
    score: float

    @property
    def size(self) -> float:
        """The longer side, pixels."""
        return max(self.box[2] - self.box[0], self.box[3] - self.box[1])

    @property
    def area(self) -> float:
        return (self.box[2] - self.box[0]) * (self.box[3] - self.box[1])

    @property
    def crop(self) -> Crop:
        """The square for the mesh model, turned so that the eyes are level."""
        left, top, right, bottom = self.box
        return Crop(((left + right) / 2, (top + bottom) / 2), MARGIN * self.size, _slope(self.eyes))


@cache
def anchors() -> Floats:
    """(896, 2): middles of the detector's anchors, x and y, 0..1."""
    rows = []
    for n, copies in GRIDS:
        middle = (np.arange(n) + 0.5) / n
        cells = np.stack(np.meshgrid(middle, middle), -1).reshape(-1, 2)
        rows.append(np.repeat(cells, copies, axis=0))
    return np.concatenate(rows)


def decode(boxes: NDArray[np.float32], scores: NDArray[np.float32], crop: Crop) -> list[Face]:
    """Faces in a picture of which the detector has seen `crop`, the surest first, each once.

    `boxes` (896, 16): middle, size, then six points of the face, pixels of the input, from the anchor;
    `scores` (896,), log odds. What is not finite, or absurd, is no face.
    """
    sure = chance(scores)
    table = np.asarray(boxes, float).reshape(-1, 8, 2) / DETECTOR_SIDE
    good = (sure >= SURE_ENOUGH) & (np.abs(table) < FARTHEST).all((1, 2)) & (table[:, 1] > 0).all(1)
    picked = np.flatnonzero(good)
    faces = [_face(table[i], anchors()[i], float(sure[i]), crop) for i in picked]
    return each_once(faces)


def chance(scores: NDArray[np.float32]) -> Floats:
    """Probabilities (n,) from log odds of any shape; NaN stays NaN."""
    sure: Floats = 1 / (1 + np.exp(-np.clip(np.asarray(scores, float).ravel(), -80, 80)))
    return sure


def tiles(width: int, height: int) -> list[Crop]:
    """Overlapping squares of a picture, for faces that are small in the whole of it."""
    side = TILE * max(width, height)
    return [Crop((float(x), float(y)), side) for y in _spread(height, side) for x in _spread(width, side)]


def _spread(length: int, side: float) -> Floats:
    """Middles of squares along a length: one if they are longer."""
    if side >= length:
        return np.array([length / 2])
    return np.linspace(side / 2, length - side / 2, 3)


def _face(row: Floats, anchor: Floats, score: float, crop: Crop) -> Face:
    middle, half = row[0] + anchor, row[1] / 2
    corners = crop.place(np.array([middle - half, middle + half]))
    eyes = crop.place(row[2:4] + anchor)
    (left, top), (right, bottom) = corners.tolist()
    return Face((left, top, right, bottom), eyes, score)


def each_once(faces: list[Face]) -> list[Face]:
    """Overlapping boxes joined to their mean weighted by score, the surest first."""
    left, once = sorted(faces, key=lambda face: -face.score), []
    while left:
        same = [face for face in left if face is left[0] or _same(left[0], face)]
        left = [face for face in left if all(face is not other for other in same)]
        weights = [face.score for face in same]
        box = np.average([face.box for face in same], axis=0, weights=weights)
        eyes = np.average([face.eyes for face in same], axis=0, weights=weights)
        once.append(Face(tuple(box.tolist()), eyes, same[0].score))
    return once


def _common(a: Face, b: Face) -> float:
    """Area that two boxes share."""
    width = min(a.box[2], b.box[2]) - max(a.box[0], b.box[0])
    height = min(a.box[3], b.box[3]) - max(a.box[1], b.box[1])
    return max(width, 0.0) * max(height, 0.0)


def _same(a: Face, b: Face) -> bool:
    both = _common(a, b)
    return both > SAME * (a.area + b.area - both)


def only_face(faces: list[Face]) -> Face:
    """The face of a portrait. Raises PhotoError for none, and for a second one that may be meant as well."""
    if not faces:
        raise PhotoError("no face was found in the photo; it should show one, upright, large and well lit")
    first = max(faces, key=lambda face: face.score * face.size)
    for other in faces:
        large = other.size > SECOND_SIZE * first.size and other.score > SECOND_SCORE * first.score
        if large and _common(first, other) < APART * other.area:
            raise PhotoError("there is more than one face in the photo; cut it so that it shows only one")
    return first


def mesh_crop(mesh: Floats) -> Crop:
    """The square for another look at a mesh (n, 3), pixels."""
    slope = _slope(mesh[list(EYES), :2])
    turned = Crop((0.0, 0.0), 1.0, slope)
    flat = mesh[:, :2] @ turned.axes.T
    low, high = flat.min(0), flat.max(0)
    middle = (low + high) / 2 @ turned.axes
    return Crop((float(middle[0]), float(middle[1])), MARGIN * float((high - low).max()), slope)


def place_mesh(raw: NDArray[np.float32], crop: Crop) -> Floats:
    """The mesh model's output in pixels of the picture, (468, 3): x, y, and z away from the camera."""
    mesh = np.asarray(raw, float).reshape(-1, 3) / MESH_SIDE
    return np.column_stack([crop.place(mesh[:, :2]), mesh[:, 2] * crop.side])


def _slope(eyes: Floats) -> float:
    along = eyes[1] - eyes[0]
    return float(np.arctan2(along[1], along[0]))
