"""A filmed face as points of a mesh, and the same face with the motion of the head taken out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fapstream.data import read_lines
from fapstream.errors import ClipError, DataError

Floats = NDArray[np.float64]

OUTER_EYES = (263, 33)
"""The outer corners of the left and the right eye."""
OUTER_EYES_MM = 90.0
"""Their distance in the space in which motion is measured, whatever the person's own."""
CROWN, BASE = 10, 2
"""The middle of the hairline and the base of the nose: one is upright over the other."""
PARTS = ("bone", "base", "eyes", "brows", "jaw", "lips", "face")
LEAST_SIZE = 8.0
"""Pixels: no face is smaller."""
SETTLED = 1e-4
"""The mean shape of the bones is found when it moves by less, as a part of its size."""
FLAT = 1e-3
"""Sine of the least angle between the line of the eyes and what is upright."""


@dataclass(frozen=True, slots=True)
class Landmarks:
    """Points of the face mesh of 478, tracked through a clip.

    `points`: shape (n, k, 3), pixels, x to the right, y down, z away from the camera, NaN where the face is
    lost; `ids`: the k points' numbers in the mesh. `fps`: frames a second, the first at 0 s.
    """

    points: Floats
    ids: tuple[int, ...]
    fps: float = 25.0

    def __post_init__(self) -> None:
        if self.points.ndim != 3 or self.points.shape[1:] != (len(self.ids), 3):
            raise ClipError(
                f"expected points of shape (frames, {len(self.ids)}, 3), found {self.points.shape}"
            )


@dataclass(frozen=True, slots=True)
class Row:
    """What the table says of one point."""

    point: int
    mirror: int
    part: str
    fdp: str | None


@cache
def table() -> tuple[Row, ...]:
    """data/landmarks.tsv. Raises DataError."""
    name, rows = "landmarks.tsv", []
    for number, line in read_lines("learn", name):
        try:
            point, mirror, part, fdp = line.split("\t")
            if part not in PARTS:
                raise ValueError(f"{part!r} is none of {', '.join(PARTS)}")
            rows.append(Row(int(point), int(mirror), part, None if fdp == "-" else fdp))
        except ValueError as e:
            raise DataError(name, number, str(e)) from None
    return tuple(rows)


def points_of(*parts: str) -> tuple[int, ...]:
    """The points of those parts, in the table's order."""
    return tuple(row.point for row in table() if row.part in parts)


def columns(ids: tuple[int, ...], wanted: tuple[int, ...]) -> NDArray[np.int64]:
    """Where the wanted points are. Raises ClipError if one is not tracked."""
    at = {point: column for column, point in enumerate(ids)}
    absent = [point for point in wanted if point not in at]
    if absent:
        raise ClipError(f"points of the mesh that are not in the file: {', '.join(map(str, absent))}")
    return np.array([at[point] for point in wanted])


def still(landmarks: Landmarks) -> Floats:
    """The points with the head held still and upright, millimetres as if the outer corners of the eyes were
    90 mm apart: shape (n, k, 3), x to the subject's left, y up, z forwards; lost frames stay NaN.

    Each frame is fitted to the clip's own mean by a similarity, on the points that move with the skull alone.
    A frame that misses a point is lost, and so is one whose points are all in one place. Raises ClipError: no
    face in any frame, points missing, points on a line.
    """
    points = landmarks.points * np.array([1.0, -1.0, -1.0])
    bone = points[:, columns(landmarks.ids, points_of("bone"))]
    seen = np.isfinite(points).all(axis=(1, 2)) & (np.ptp(bone, axis=1).max(axis=1) > 0)
    if not seen.any():
        raise ClipError("there is no face in the clip")
    if np.ptp(bone[seen], axis=1).max() < LEAST_SIZE:
        raise ClipError("the points lie in one place: they are no face")
    mean = _mean_shape(bone[seen])
    upright = np.full_like(points, np.nan)
    upright[seen] = _move(points[seen], _similarities(bone[seen], mean))
    return _stand(upright, landmarks.ids)


def _mean_shape(shapes: Floats) -> Floats:
    """Of shapes (n, p, 3), by generalised Procrustes analysis."""
    first = shapes[len(shapes) // 2]
    mean: Floats = first - first.mean(axis=0)
    size = np.linalg.norm(mean)
    for _ in range(20):
        new = _move(shapes, _similarities(shapes, mean)).mean(axis=0)
        new *= size / np.linalg.norm(new)
        change = float(np.linalg.norm(new - mean))
        mean = new
        if change < SETTLED * size:
            break
    return mean


@dataclass(frozen=True, slots=True)
class _Similarity:
    """y = scale (x - centre) rotation, one for each frame."""

    rotation: Floats
    scale: Floats
    centre: Floats


def _similarities(shapes: Floats, to: Floats) -> _Similarity:
    """The best ones that take shapes (n, p, 3) to one (p, 3) whose middle is 0 (Umeyama 1991)."""
    centre = shapes.mean(axis=1, keepdims=True)
    centred = shapes - centre
    u, s, vt = np.linalg.svd(np.einsum("npi,pj->nij", centred, to))
    sign = np.ones((len(shapes), 3))
    sign[:, 2] = np.sign(np.linalg.det(u @ vt))
    rotation = np.einsum("nij,nj,njk->nik", u, sign, vt)
    scale = (s * sign).sum(axis=1) / (centred**2).sum(axis=(1, 2))
    return _Similarity(rotation, scale, centre)


def _move(points: Floats, by: _Similarity) -> Floats:
    moved: Floats = by.scale[:, None, None] * np.einsum("npi,nij->npj", points - by.centre, by.rotation)
    return moved


def _stand(points: Floats, ids: tuple[int, ...]) -> Floats:
    """Turn and scale the whole clip so that the eyes are level and the face upright."""
    left, right, crown, base = np.nanmean(points[:, columns(ids, (*OUTER_EYES, CROWN, BASE))], axis=0)
    x = left - right
    width = np.linalg.norm(x)
    y = crown - base
    if np.linalg.norm(np.cross(x, y)) < FLAT * width * np.linalg.norm(y) or not width:
        raise ClipError("the points are no face: eyes, hairline and nose are on one line")
    x = x / width
    y = y - (y @ x) * x
    y = y / np.linalg.norm(y)
    axes = np.stack([x, y, np.cross(x, y)])
    stood: Floats = (points - (left + right) / 2) @ axes.T * (OUTER_EYES_MM / width)
    return stood
