"""One person adapting a head at a page: messages in, messages out (protocol/ADAPT.md), no I/O."""

from __future__ import annotations

import io
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray
from PIL import Image as Picture

from fapstream.adapt.fit import METHODS
from fapstream.adapt.person import DEFAULT_METHOD, fit_points, make_head
from fapstream.adapt.photos import read_photo
from fapstream.adapt.points import (
    Facing,
    Marks,
    PhotoPoints,
    View,
    facing_of,
    feature_points,
    format_points,
    generic_places,
    marks_of,
)
from fapstream.adapt.refine import FEWEST
from fapstream.adapt.start import laid_over, seen_side
from fapstream.errors import FapstreamError, InputError, PhotoError
from fapstream.head.gltf_write import write_head
from fapstream.head.mesh import Head
from fapstream.ports import Landmarker

Message = dict[str, Any]
Floats = NDArray[np.float64]

LONGEST_NAME = 80
DRAWN_M = 0.0035
"""Edges shorter than this on the generic head are not drawn over photos: lips and lids would be black with
them.
"""
DRAWN_BOX = ((-0.09, 0.09), (-0.10, 0.15), (-0.02, 0.2))
"""Metres: of the rest of the skin, what is the face."""


@dataclass(frozen=True, slots=True)
class Taken:
    """A photo of this session, and where a profile looks if that was seen."""

    pixels: NDArray[np.uint8]
    facing: Facing | None = None

    @property
    def size(self) -> tuple[int, int]:
        return self.pixels.shape[1], self.pixels.shape[0]


class Session:
    """What one page has sent so far. `clock` tells seconds, to say how long a fit took."""

    def __init__(self, generic: Head, finder: Landmarker | None, clock: Callable[[], float]) -> None:
        self._generic, self._finder, self._clock = generic, finder, clock
        self._photos: dict[str, Taken] = {}
        self._drawn, self._edges = wireframe(generic)
        self._names = tuple(feature_points())
        self._places = np.array(list(generic_places(generic.fdp).values()))

    def ready(self) -> Message:
        """The first message."""
        points = [
            {
                "name": p.name,
                "title": p.title,
                "views": list(p.views),
                **({"mirror": p.mirror} if p.mirror else {}),
            }
            for p in feature_points().values()
        ]
        edges = self._edges.astype("<u2").tobytes()
        return {
            "type": "ready", "points": points, "edges": edges, "automatic": self._finder is not None,
            "methods": list(METHODS),
        }  # fmt: skip

    def answer(self, message: Message) -> Message:
        """What to send for a message; what is wrong with it becomes an `error`, and changes nothing."""
        try:
            match message["type"]:
                case "photo":
                    return self._photo(message)
                case "points":
                    return self._points(message)
                case "head":
                    return self._head(message)
                case other:
                    raise InputError(f"there is no message {other[:40]!r}")
        except FapstreamError as e:
            return error(e, message)

    def _photo(self, message: Message) -> Message:
        view, data = str(message.get("view")), message.get("data")
        if view not in get_args(View) or not isinstance(data, bytes):
            raise InputError("a photo needs a view, front or profile, and data")
        pixels = read_photo(data, view)
        found, facing, note = self._found(view, pixels)
        taken = self._photos[view] = Taken(pixels, facing)
        width, height = taken.size
        return {
            "type": "photo", "view": view, "width": width, "height": height, "picture": _jpeg(pixels),
            "points": _rows(found) if found else {}, "facing": facing, "note": note,
        }  # fmt: skip

    def _found(self, view: str, pixels: NDArray[np.uint8]) -> tuple[Marks | None, Facing | None, str | None]:
        if self._finder is None:
            return None, None, None
        try:
            if view == "front":
                return self._finder.front(pixels), None, None
            marks, facing = self._finder.profile(pixels)
            return marks, facing, None
        except PhotoError as e:
            return None, None, f"{_plain(e, view)}. You can place the points by hand."

    def _photo_points(self, message: Message) -> PhotoPoints:
        marks: dict[str, Marks] = {}
        for view in get_args(View):
            if view in self._photos:
                row = {"size": list(self._photos[view].size), "points": message.get(view, {})}
                marks[view] = marks_of(row, view, "points")
        if "front" not in marks:
            raise InputError("there is no front photo yet")
        profile = marks.get("profile")
        if profile is None:
            return PhotoPoints(marks["front"])
        facing = facing_of(profile.points) or self._photos["profile"].facing or "right"
        return PhotoPoints(marks["front"], profile, facing)

    def _points(self, message: Message) -> Message:
        start, photos = self._clock(), self._photo_points(message)
        rows, fitted, off = self._fitted(photos, _method(message))
        views = {view: self._view(view, *row) for view, row in rows.items()}
        if "profile" in views:
            views["profile"]["facing"] = photos.facing
        took = round(1000 * (self._clock() - start), 1)
        return {
            "type": "fit", "seq": _seq(message), "fitted": fitted, "error_px": off, "ms": took, **views
        }  # fmt: skip

    def _view(self, view: str, mesh: Floats, seen: Floats) -> Message:
        points = {
            name: [float(x), float(y)]
            for name, (x, y) in zip(self._names, seen, strict=True)
            if view in feature_points()[name].views
        }
        return {"mesh": mesh.astype("<f4").tobytes(), "points": points}

    def _fitted(
        self, photos: PhotoPoints, method: str
    ) -> tuple[dict[str, tuple[Floats, Floats]], bool, float | None]:
        """By view the mesh and the feature points in pixels; whether they are fitted; the mean error."""
        if len(photos.front.points) < FEWEST or (photos.profile and 0 < len(photos.profile.points) < 2):
            cameras = laid_over(seen_side(photos), photos.facing, self._names, self._places)
            drawn = self._generic.part("skin").positions[self._drawn].astype(np.float64)
            rows = {view: (c.project(drawn), c.project(self._places)) for view, c in cameras.items()}
            return rows, False, None
        fit = fit_points(self._generic, photos, method)
        mesh, places = fit.skin[self._drawn], fit.warp(self._places)
        cameras = {view: sight.camera for view, sight in fit.located.sights.items()}
        if photos.profile and "profile" not in cameras:
            laid = laid_over(seen_side(photos), photos.facing, self._names, places)
            cameras["profile"] = laid["profile"]
        rows = {view: (camera.project(mesh), camera.project(places)) for view, camera in cameras.items()}
        gaps = [
            np.linalg.norm(rows[view][1] - sight.seen, axis=1)[sight.known]
            for view, sight in fit.located.sights.items()
        ]
        return rows, True, float(np.concatenate(gaps).mean())

    def _head(self, message: Message) -> Message:
        photos, name = self._photo_points(message), message.get("name", "")
        if not isinstance(name, str) or len(name) > LONGEST_NAME:
            raise InputError(f"a name has at most {LONGEST_NAME} characters")
        fit = fit_points(self._generic, photos, _method(message))
        pictures = {view: taken.pixels for view, taken in self._photos.items()}
        head = make_head(self._generic, fit, pictures, name or "My head")
        return {
            "type": "head", "seq": _seq(message), "head": write_head(head), "points": format_points(photos)
        }  # fmt: skip


def error(e: FapstreamError, message: Mapping[str, Any]) -> Message:
    """An error as a message, about `message`."""
    row: Message = {"type": "error", "code": e.code, "message": _plain(e, str(message.get("view")))}
    if type(message.get("seq")) is int:
        row["seq"] = message["seq"]
    if message.get("view") in get_args(View):
        row["view"] = message["view"]
    return row


def _plain(e: FapstreamError, view: str) -> str:
    """What is wrong, without the name of the photo: it is said beside the photo."""
    text = str(e).removeprefix(f"{view}: ").rstrip(".")
    return text[:1].upper() + text[1:]


def wireframe(generic: Head) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Vertices (n,) of the generic skin, and the edges (m, 2) between them that are drawn over photos."""
    skin = generic.part("skin")
    points = skin.positions.astype(np.float64)
    sides = np.concatenate([skin.triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))]).astype(np.int64)
    edges = np.unique(np.sort(sides, axis=1), axis=0)
    inside = np.all(
        [(points[:, k] > low) & (points[:, k] < high) for k, (low, high) in enumerate(DRAWN_BOX)], axis=0
    )
    long = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1) > DRAWN_M
    edges = edges[long & inside[edges].all(1)]
    used, flat = np.unique(edges, return_inverse=True)
    return used, flat.reshape(-1, 2)


def _rows(marks: Marks) -> dict[str, list[float]]:
    sure = marks.confidence
    return {name: [float(x), float(y), float(sure.get(name, 1.0))] for name, (x, y) in marks.points.items()}


def _seq(message: Message) -> int:
    seq = message.get("seq")
    if type(seq) is not int:
        raise InputError("a seq is missing")
    return seq


def _method(message: Message) -> str:
    method = message.get("method", DEFAULT_METHOD)
    if not isinstance(method, str) or method not in METHODS:
        raise InputError(f"there is no method {method!r:.40}; there are: {', '.join(METHODS)}")
    return method


def _jpeg(pixels: NDArray[np.uint8]) -> bytes:
    out = io.BytesIO()
    Picture.fromarray(pixels).save(out, "JPEG", quality=92)
    return out.getvalue()
