"""Feature points in photos: which there are, where a photo has them, and the file they are kept in."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any, Literal, NoReturn

import numpy as np
from numpy.typing import NDArray

from fapstream.data import read_lines
from fapstream.errors import DataError, PointsError

Floats = NDArray[np.float64]
View = Literal["front", "profile"]
Facing = Literal["left", "right"]
"""Where in the picture the nose of a profile points."""

VERSION = 1
MAX_FILE = 1 << 18
MAX_SIDE = 1 << 16
FAR = 1e9
MIRROR = np.array([-1.0, 1.0, 1.0])
_VIEWS: dict[str, View] = {"F": "front", "P": "profile"}
MIDLINE_ORDER = (
    "11.1",
    "glabella",
    "nasion",
    "9.3",
    "9.15",
    "8.1",
    "stomion",
    "8.2",
    "sulcus",
    "2.10",
    "2.1",
)
BEHIND = ("10.1", "10.2", "10.3", "10.4", "10.5", "10.6", "10.9", "10.10", "2.13", "2.14", "3.7", "3.12")
"""What lies behind the profile's outline."""


@dataclass(frozen=True, slots=True)
class FeaturePoint:
    """A point that can be found in photos.

    `mirror`: the same point on the other side of the face, None on the midline. `place`: on the generic head,
    metres; None for MPEG-4's own, which the head file has.
    """

    name: str
    mirror: str | None
    views: tuple[View, ...]
    place: tuple[float, float, float] | None
    title: str


@dataclass(frozen=True, slots=True)
class Marks:
    """Feature points in one photo of `size` (width, height): pixels from the upper left corner, x right, y
    down, the middle of the first pixel being (0.5, 0.5). `confidence` 0..1 where it is known; 1 is sure.
    """

    size: tuple[int, int]
    points: Mapping[str, tuple[float, float]]
    confidence: Mapping[str, float] = field(default_factory=dict)

    def array(self, names: tuple[str, ...]) -> Floats:
        """(n, 2), NaN where there is no such point."""
        missing = (np.nan, np.nan)
        return np.array([self.points.get(name, missing) for name in names], float).reshape(-1, 2)

    def sureness(self, names: tuple[str, ...]) -> Floats:
        """(n,): confidence by name."""
        return np.array([self.confidence.get(name, 1.0) for name in names])


@dataclass(frozen=True, slots=True)
class PhotoPoints:
    """What was found in a front photo and, if there is one, a profile photo."""

    front: Marks
    profile: Marks | None = None
    facing: Facing = "right"


@cache
def feature_points() -> Mapping[str, FeaturePoint]:
    """All that can be found, by name. Raises DataError for a broken table."""
    table = {}
    for number, line in read_lines("adapt", "points.tsv"):
        try:
            name, mirror, views, x, y, z, title = line.split("\t")
            at = None if x == "-" else (float(x) / 1000, float(y) / 1000, float(z) / 1000)
            seen = tuple(_VIEWS[v] for v in views)
            table[name] = FeaturePoint(name, None if mirror == "-" else mirror, seen, at, title)
        except (ValueError, KeyError):
            raise DataError("points.tsv", number, f"{line[:60]!r} is not a feature point") from None
    return table


def generic_places(fdp: Mapping[str, tuple[float, float, float]]) -> dict[str, Floats]:
    """Where the feature points are on the generic head, whose MPEG-4 points are `fdp`: (3,), metres, by
    name.
    """
    return {name: np.array(point.place or fdp[name]) for name, point in feature_points().items()}


def facing_of(points: Mapping[str, tuple[float, float]]) -> Facing | None:
    """Where the nose of a profile points, told by what lies before what; None if too little is known."""
    front = [points[name][0] for name in MIDLINE_ORDER if name in points]
    back = [points[name][0] for name in BEHIND if name in points]
    if not front or not back:
        return None
    return "right" if np.median(front) > np.median(back) else "left"


def near_side(facing: Facing) -> int:
    """The sign of x on the side of the head that a profile shows: its right one, x < 0, if it looks right."""
    return -1 if facing == "right" else 1


def read_points(text: str, where: str = "points") -> PhotoPoints:
    """The points of a JSON file.

    {"version": 1, "front": {"size": [w, h], "points": {"9.3": [x, y]}}, "profile": {..., "facing": "left"}}
    A point may have a confidence as a third number. Raises PointsError, naming `where` and the place,
    for anything else: unknown or unfitting points, what lies outside its photo, numbers that are not finite.
    """
    if len(text) > MAX_FILE:
        _fail(where, "", f"has {len(text)} characters; {MAX_FILE} are the limit")
    try:
        data = json.loads(text)
    except (ValueError, RecursionError) as e:
        _fail(where, "", f"is not JSON: {e}")
    if not isinstance(data, dict) or data.get("version") != VERSION:
        _fail(where, "version", f"is not {VERSION}: not a file of feature points")
    front = marks_of(data.get("front"), "front", where)
    if data.get("profile") is None:
        return PhotoPoints(front)
    profile = marks_of(data["profile"], "profile", where)
    facing = data["profile"].get("facing") or facing_of(profile.points) or "right"
    if facing not in ("left", "right"):
        _fail(where, "profile.facing", "is neither left nor right")
    return PhotoPoints(front, profile, facing)


def format_points(points: PhotoPoints) -> str:
    """The text of a file that `read_points` reads."""
    data: dict[str, Any] = {"version": VERSION, "front": _row(points.front)}
    if points.profile is not None:
        data["profile"] = {"facing": points.facing, **_row(points.profile)}
    return json.dumps(data, indent=1) + "\n"


def _row(marks: Marks) -> dict[str, Any]:
    rows = {}
    for name, (x, y) in marks.points.items():
        sure = marks.confidence.get(name)
        rows[name] = [round(x, 2), round(y, 2), *([] if sure is None else [round(sure, 3)])]
    return {"size": list(marks.size), "points": rows}


def marks_of(row: Any, view: View, where: str) -> Marks:
    """The points of one photo as `read_points` has them: {"size": [w, h], "points": {...}}. Raises
    PointsError.
    """
    if not isinstance(row, dict):
        _fail(where, view, "is missing or not an object")
    size = row.get("size")
    if (
        not isinstance(size, list)
        or len(size) != 2
        or not all(type(s) is int and 0 < s <= MAX_SIDE for s in size)
    ):
        _fail(where, f"{view}.size", f"is not a width and a height from 1 to {MAX_SIDE}")
    rows = row.get("points")
    if not isinstance(rows, dict):
        _fail(where, f"{view}.points", "is missing or not an object")
    points, confidence = {}, {}
    for name, value in rows.items():
        place = f"{view}.points.{name[:40]}"
        known = feature_points().get(name)
        if known is None or view not in known.views:
            _fail(where, place, f"is no feature point of a {view} photo")
        x, y, *sure = _numbers(value, where, place)
        if not (0 <= x <= size[0] and 0 <= y <= size[1]):
            _fail(where, place, f"({x:g}, {y:g}) lies outside the photo of {size[0]} x {size[1]} pixels")
        points[name] = (x, y)
        if sure:
            confidence[name] = min(max(sure[0], 0.0), 1.0)
    return Marks((size[0], size[1]), points, confidence)


def _numbers(value: Any, where: str, place: str) -> list[float]:
    if not isinstance(value, list) or len(value) not in (2, 3):
        _fail(where, place, "is not [x, y] or [x, y, confidence]")
    if not all(type(c) in (int, float) and abs(c) < FAR for c in value):
        _fail(where, place, "has numbers that are not finite")
    return [float(c) for c in value]


def _fail(where: str, place: str, reason: str) -> NoReturn:
    raise PointsError(f"{where}: {f'{place}: ' if place else ''}{reason}"[:400])
