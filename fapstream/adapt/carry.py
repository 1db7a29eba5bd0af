"""A head through a warp: its skin and hair, its eyes, teeth and tongue, and everything that makes it move.

Displacements of face animation tables are vectors on the old surface; on the new one they are those times
the warp's Jacobian there (D. Bitouk, S. K. Nayar, Creating a speech enabled avatar from a single
photograph, section 3.2, equation 2). Lids go far round a ball, where a linear map is not enough: they move
by f(x + d) - f(x). Afterwards each FAP is brought to what ISO/IEC 14496-2 says of its feature point: FAP
times FAPU of the new face.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fapstream.adapt.bite import bitten
from fapstream.adapt.eyes import EyeWarp, keeping_eyes
from fapstream.adapt.norms import normed, part_of, stored
from fapstream.adapt.rigid import Similarity
from fapstream.adapt.warp import Warp, jacobians
from fapstream.head.fapu import Point, measure
from fapstream.head.mesh import FatEntry, Head, Mouth, Part, Turn

Floats = NDArray[np.float64]

ARTICULATORS = ("teeth", "tongue")
"""How the names of parts begin that are not bent."""
LID_FAPS = frozenset({19, 20, 21, 22})
SAME_PLACE_M = 1e-4
"""A feature point nearer to a vertex than this lies on it."""
PLACE_BITS = 17
"""Positions are multiples of 2^-17 metres."""


@dataclass(frozen=True, slots=True)
class Carrier:
    """What becomes of each part: `skin` for all that bends, `stiff` for the others by part."""

    skin: EyeWarp
    stiff: Mapping[str, Similarity]

    @classmethod
    def of(cls, warp: Warp, head: Head) -> Carrier:
        """Eyeballs by their lids and pupils; teeth and tongue, together, as the warp takes the teeth."""
        skin, balls = keeping_eyes(warp, head)
        stiff: dict[str, Similarity] = {}
        inside = [part for part in head.parts if part.name.startswith(ARTICULATORS)]
        if inside:
            jaws = _jaws(skin, head, inside)
            stiff |= {part.name: jaws for part in inside}
        for part in head.parts:
            for side, ball in balls.items():
                if part.name.startswith("eye") and part.name.endswith(f"_{side}"):
                    stiff[part.name] = ball.moved
        return cls(skin, stiff)

    def places(self, part: Part) -> Floats:
        """Where the vertices of a part come to lie: float64 (n, 3)."""
        points = part.positions.astype(np.float64)
        stiff = self.stiff.get(part.name)
        return stiff(points) if stiff else self.skin(points)

    def slopes(self, part: Part) -> Floats:
        """(n, 3, 3): what displacements are multiplied by."""
        stiff = self.stiff.get(part.name)
        if stiff:
            return np.broadcast_to(stiff.scale * stiff.rotation, (len(part.positions), 3, 3))
        return jacobians(self.skin, part.positions.astype(np.float64))

    def point(self, name: str, place: Point) -> Point:
        """Where a feature point comes to lie."""
        where = part_of(name)
        return _point(self.stiff.get(where, self.skin)(np.array([place]))[0])


def _jaws(skin: EyeWarp, head: Head, inside: Sequence[Part]) -> Similarity:
    """As large as the warp makes teeth, and upright."""
    teeth = [part for part in inside if part.name.startswith("teeth")] or list(inside)
    points = np.concatenate([part.positions for part in teeth]).astype(np.float64)
    moved = skin(points)
    scale = float(np.sqrt(((moved - moved.mean(0)) ** 2).sum() / ((points - points.mean(0)) ** 2).sum()))
    place = moved.mean(0) - scale * points.mean(0)
    return Similarity(scale, np.eye(3), place)


def carry(head: Head, warp: Warp, name: str = "") -> Head:
    """`head` as the warp takes it: a head of its own that every FAP moves as it should.

    The warp maps points of the head's frame to points of the new head's, metres.
    """
    carrier = Carrier.of(warp, head)
    slopes = {part.name: carrier.slopes(part) for part in head.parts}
    parts = tuple(_part(part, carrier.places(part), slopes[part.name]) for part in head.parts)
    fdp = {point: _feature_point(point, place, carrier, head, parts) for point, place in head.fdp.items()}
    olds = {part.name: part for part in head.parts}
    fat = tuple(_entry(entry, carrier, olds[entry.part], slopes[entry.part]) for entry in head.fat)
    fapu = measure(fdp, "the adapted head")
    turns = tuple(replace(turn, pivot=_pivot(turn, carrier)) for turn in head.turns)
    carried = Head(name or head.name, parts, fapu, fdp, _mouth(head, carrier), head.camera, fat, turns)
    jaws = next((stiff.scale for name, stiff in carrier.stiff.items() if name.startswith(ARTICULATORS)), 1.0)
    return bitten(normed(carried, head), head, jaws)


def _feature_point(name: str, place: Point, carrier: Carrier, head: Head, parts: Sequence[Part]) -> Point:
    """With its vertex, where it is one."""
    for old, new in zip(head.parts, parts, strict=True):
        if old.name == part_of(name):
            gaps = ((old.positions - np.array(place)) ** 2).sum(1)
            if gaps.min() < SAME_PLACE_M**2:
                return _point(new.positions[int(gaps.argmin())])
    return carrier.point(name, place)


def _part(part: Part, places: Floats, slopes: Floats) -> Part:
    """Normals go with the inverse transpose of the slopes; lengths stay."""
    bent = np.linalg.solve(np.swapaxes(slopes, 1, 2), part.normals.astype(np.float64)[..., None])[..., 0]
    length = np.linalg.norm(part.normals, axis=1, keepdims=True)
    bent *= length / np.maximum(np.linalg.norm(bent, axis=1, keepdims=True), 1e-12)
    grid = 2.0**PLACE_BITS
    return replace(
        part, positions=(np.rint(places * grid) / grid).astype(np.float32), normals=bent.astype(np.float32)
    )


def _entry(entry: FatEntry, carrier: Carrier, part: Part, slopes: Floats) -> FatEntry:
    moves = entry.deltas.astype(np.float64) * entry.scale
    if LID_FAPS.intersection(entry.faps) and part.name not in carrier.stiff:
        start = part.positions[entry.indices].astype(np.float64)
        here = carrier.skin(start)
        moved = np.stack([carrier.skin(start + move) - here for move in moves])
    else:
        moved = np.einsum("nij,knj->kni", slopes[entry.indices], moves)
    return stored(entry, moved)


def _pivot(turn: Turn, carrier: Carrier) -> Point:
    """Eyes turn about their own centres, wherever these come to lie; the head about the top of the spine."""
    names = turn.parts or ()
    stiff = [carrier.stiff[name] for name in names if name in carrier.stiff]
    return _point((stiff[0] if stiff else carrier.skin)(np.array([turn.pivot]))[0])


def _mouth(head: Head, carrier: Carrier) -> Mouth:
    (x, y, z), (width, height) = head.mouth.center, head.mouth.size
    ends = np.array(
        [(x - width / 2, y, z), (x + width / 2, y, z), (x, y - height / 2, z), (x, y + height / 2, z)]
    )
    left, right, low, high = carrier.skin(ends)
    middle = carrier.skin(np.array([(x, y, z)]))[0]
    return Mouth(_point(middle), (float(right[0] - left[0]), float(high[1] - low[1])))


def _point(place: NDArray[np.floating[Any]]) -> Point:
    return float(place[0]), float(place[1]), float(place[2])
