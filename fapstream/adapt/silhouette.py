"""A profile's named points on the outline of a person: the chain of them that fits best, nose to either side.

What a profile looks like is a table, outline.tsv: for each point, where it lies from the one before it, and
how the outline bends around it: its headings at OFFSETS. The cheapest course of a chain along an outline is
Viterbi's, for a few heights of the face and tilts of the head (pictorial structures, Felzenszwalb and
Huttenlocher, 2005).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from fapstream.adapt.crop import Crop
from fapstream.adapt.found import Face
from fapstream.adapt.outline import headings, resampled
from fapstream.adapt.points import Facing, Marks, feature_points
from fapstream.data import read_lines
from fapstream.errors import DataError, PhotoError

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
Seen = tuple[float, float, float]
"""x, y, confidence."""

OFFSETS = (-0.24, -0.16, -0.1, -0.06, -0.03, 0.0, 0.03, 0.06, 0.1, 0.16, 0.24)
"""Along the outline from a point, in heights of the face: those from the root of the nose to 2.1."""
COARSE, FINE = 0.02, (0.008, 0.004)
"""Between the points that an outline is looked at in, heights: to begin with, and to end."""
FARTHEST = 0.5
"""Along the outline between two points of the chain."""
BENT_MOST, MOVED_MOST = 6.0, 60.0
"""Squared sds that count at most: hair, glasses, a collar hide what they hide."""
SHARE = 0.35
"""Weight of a heading; neighbouring ones tell nearly the same."""
FACE_HEIGHT = 0.79
"""Height of the face over the size of a detected one, in profile; sd of its logarithm."""
HEIGHT_SD = 0.13
HEIGHTS = tuple(np.exp(np.linspace(-0.35, 0.25, 7)).tolist())
TILTS = (-0.25, 0.0, 0.25)
TILT_SD = 0.15
"""Radians."""
STRANGEST = 140.0
"""Cost above which an outline is no profile: those have 10 to 80, 60 more under wild hair; faces that look at
the camera have 149 to 183."""
UNKNOWN = tuple((0.12 * 1.12 ** np.arange(16)).tolist())
"""Heights of a face over that of the outline, where nothing else is known."""
SHORTEST, LONGEST = 2.0, 50.0
"""Outlines, heights of the face; what else is tried is no face."""
SHOWN = 2.4
"""Side of the square in which the outline is traced, over the size of the face."""
MOST_DOUBT = 0.8
"""What an outline that bends quite otherwise takes from the confidence of a point."""
FIRM = slice(2, 13)
"""Of the chain, what is never under hair: it tells scale and tilt."""


@dataclass(frozen=True, slots=True)
class Chain:
    """The table: `names` (n), `steps` (n, 2) from the point before, heights of the face, `spreads`, their sd;
    `bends` (n, k), headings around, radians, and `bend_spreads`; `confidence` (n,). The nose and x are
    to the right, y is down.
    """

    names: tuple[str, ...]
    steps: Floats
    spreads: Floats
    bends: Floats
    bend_spreads: Floats
    confidence: Floats

    @property
    def places(self) -> Floats:
        """(n, 2): the mean chain, from its first point."""
        return np.cumsum(self.steps, axis=0)


@dataclass(frozen=True, slots=True)
class Laid:
    """A chain laid along an outline: `points` (n, 2), pixels; `bent` (n,), 0..1, how unlike the outline is;
    `height` of the face, pixels; `tilt` of the head, radians, nose down; `cost`.
    """

    points: Floats
    bent: Floats
    facing: Facing
    height: float
    tilt: float
    cost: float


@cache
def chain() -> Chain:
    """The packaged table. Raises DataError."""
    k = len(OFFSETS)
    names, rows = [], []
    for number, line in read_lines("adapt", "outline.tsv"):
        try:
            name, *numbers = line.split("\t")
            row = [float(c) for c in numbers]
            if name not in feature_points() or len(row) != 5 + 2 * k or not np.isfinite(row).all():
                raise ValueError
        except ValueError:
            raise DataError("outline.tsv", number, f"{line[:60]!r} is not a point of an outline") from None
        names.append(name)
        rows.append(row)
    table = np.array(rows)
    return Chain(
        tuple(names), table[:, 1:3], table[:, 3:5], table[:, 5 : 5 + k], table[:, 5 + k :], table[:, 0]
    )


@cache
def behind() -> Mapping[str, tuple[float, float, float]]:
    """What lies behind the outline: x and y, heights from the chain's first point, and confidence.

    By the name that it has on the left. Raises DataError.
    """
    table = {}
    for number, line in read_lines("adapt", "behind.tsv"):
        try:
            name, confidence, x, y = line.split("\t")
            feature_points()[name]
            table[name] = (float(x), float(y), float(confidence))
        except (ValueError, KeyError):
            raise DataError("behind.tsv", number, f"{line[:60]!r} is not a point of a profile") from None
    return table


def crop_around(face: Face) -> Crop:
    """The square that has all of a profile and its hair."""
    left, top, right, bottom = face.box
    return Crop(((left + right) / 2, (top + bottom) / 2), SHOWN * face.size)


def lay(line: Floats, height: float | None) -> Laid:
    """The chain along a closed outline (k, 2), pixels, of a face about `height` pixels high, if known.

    The inside is on the right of who walks it. Raises PhotoError if it is no profile's.
    """
    if len(line) < len(OFFSETS) or not np.isfinite(line).all() or not np.ptp(line, axis=0).all():
        raise PhotoError("no outline of a person was found in the profile photo; a plain background helps")
    found = min((_first(line, facing, height) for facing in ("right", "left")), key=lambda laid: laid.cost)
    for step in FINE:
        scale, tilt = _pose(chain().places[FIRM], found.points[FIRM], found.facing)
        found = _laid(line, found.facing, scale, tilt, step)
    if not found.cost < STRANGEST:
        raise PhotoError(
            "the outline in the profile photo is not that of a face from the side; a plain background helps"
        )
    return found


def _first(line: Floats, facing: Facing, height: float | None) -> Laid:
    """Roughly, the most probable of a few heights and tilts."""
    tall = float(np.ptp(line[:, 1]))
    heights = [share * tall for share in UNKNOWN] if height is None else [share * height for share in HEIGHTS]
    tries = []
    for tried in heights:
        odd = 0.0 if height is None else (np.log(tried / height) / HEIGHT_SD) ** 2
        for tilt in TILTS:
            laid = _laid(line, facing, tried, tilt, COARSE)
            tries.append(replace(laid, cost=laid.cost + odd + (tilt / TILT_SD) ** 2))
    return min(tries, key=lambda laid: laid.cost)


def _laid(line: Floats, facing: Facing, height: float, tilt: float, step: float) -> Laid:
    table = chain()
    side = -1.0 if facing == "left" else 1.0
    length = float(np.linalg.norm(line - np.roll(line, 1, axis=0), axis=1).sum())
    height = float(np.clip(height, length / LONGEST, length / SHORTEST))
    # mirrored, a line is walked the other way, and has its inside on the right again
    walked = resampled(line[:: int(side)] * (side, 1) / height, step)
    bent = _bends(walked, tilt, step)
    level = walked @ _turn(tilt)
    cost, links = bent[0], []
    for k in range(1, len(table.names)):
        moved, link = _link(cost, level, table.steps[k], table.spreads[k], step)
        cost = moved + bent[k]
        links.append(link)
    at = [int(cost.argmin())]
    for link in reversed(links):
        at.append((at[-1] - int(link[at[-1]])) % len(walked))
    at.reverse()
    share = bent[np.arange(len(at)), at] / (SHARE * BENT_MOST * len(OFFSETS))
    return Laid(walked[at] * height * (side, 1), share, facing, height, tilt, float(cost.min()))


def _bends(line: Floats, tilt: float, step: float) -> Floats:
    """(n, k): how unlike each point of the chain the outline bends at each of its own k points."""
    table, heading = chain(), headings(line) - tilt
    around = np.stack([np.roll(heading, -round(offset / step)) for offset in OFFSETS], 1)
    off = around[None] - table.bends[:, None]
    off -= 2 * np.pi * np.round(off / (2 * np.pi))
    unlike: Floats = SHARE * np.minimum((off / table.bend_spreads[:, None]) ** 2, BENT_MOST).sum(-1)
    return unlike


def _link(cost: Floats, line: Floats, along: Floats, spread: Floats, step: float) -> tuple[Floats, Indices]:
    """By point of the line (k,): the least cost of a chain up to there, and how many points ago it was."""
    count = min(int(FARTHEST / step), len(line) - 1)
    total = np.zeros((len(line), count))
    for k in range(2):
        total += ((line[:, k, None] - _ago(line[:, k], count) - along[k]) / spread[k]) ** 2
    total = np.minimum(total, MOVED_MOST) + _ago(cost, count)
    best = total.argmin(1)
    return total[np.arange(len(line)), best], best + 1


def _ago(values: Floats, count: int) -> Floats:
    """(k, count): what the values (k,) of a closed line are at the 1, 2 ... `count` points before each."""
    rows: Floats = sliding_window_view(np.concatenate([values[-count:], values])[:-1], count)[:, ::-1]
    return rows


def _turn(angle: float) -> Floats:
    """(2, 2): takes rows from a picture, the nose to the right, to a head that is tilted by `angle`."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def _pose(places: Floats, points: Floats, facing: Facing) -> tuple[float, float]:
    """Scale and tilt from places (n, 2) beside the mean chain to points, pixels."""
    side = -1.0 if facing == "left" else 1.0
    a, b = places - places.mean(0), (points - points.mean(0)) * (side, 1)
    size = max(float((a**2).sum()), 1e-12)
    along, across = float((a * b).sum()), float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum())
    return max(float(np.hypot(along, across)) / size, 1e-6), float(np.arctan2(across, along))


def profile_marks(laid: Laid, size: tuple[int, int], seen: Mapping[str, Seen | None]) -> Marks:
    """All points of a profile in a photo of that size (width, height), pixels.

    Those behind the outline are where they were `seen`, by their names on the left, or else by proportion.
    What lies outside the photo is left out.
    """
    table = chain()
    sure = dict(zip(table.names, table.confidence * (1 - np.clip(laid.bent, 0, MOST_DOUBT)), strict=True))
    points = dict(zip(table.names, laid.points.tolist(), strict=True))
    for left, place in proportioned(laid).items():
        name = left if laid.facing == "left" else str(feature_points()[left].mirror)
        x, y, sure[name] = seen.get(left) or (*place.tolist(), behind()[left][2])
        points[name] = [x, y]
    within = [name for name, (x, y) in points.items() if 0 <= x <= size[0] and 0 <= y <= size[1]]
    return Marks(
        size,
        {name: (float(points[name][0]), float(points[name][1])) for name in within},
        {name: round(float(sure[name]), 3) for name in within},
    )


def proportioned(laid: Laid) -> dict[str, Floats]:
    """Where what lies behind the outline may be, (2,), pixels, by names on the left: as in the mean."""
    side = -1.0 if laid.facing == "left" else 1.0
    places, points = chain().places[FIRM], laid.points[FIRM]
    scale, tilt = _pose(places, points, laid.facing)
    to_picture = scale * _turn(tilt).T * (side, 1)
    return {
        name: points.mean(0) + (np.array([x, y]) - places.mean(0)) @ to_picture
        for name, (x, y, _) in behind().items()
    }
