"""What a head is made of: parts, face animation tables and rotations (protocol/HEAD.md)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from fapstream.head.fapu import Fapu, Point

Floats = NDArray[np.float32]
Indices = NDArray[np.uint32]

REQUIRED_PARTS = ("skin",)


@dataclass(frozen=True, slots=True)
class Image:
    """An encoded picture, as embedded in the file."""

    data: bytes
    mime: str


@dataclass(frozen=True, slots=True)
class Material:
    """The part of glTF's pbrMetallicRoughness that heads use. Colours are linear.

    `normal` is a tangent-space normal map (glTF's normalTexture: +y up), repeated `normal_repeat` times
    along u and v where the colour picture lies once: pores tile.
    """

    name: str
    color: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    texture: Image | None = None
    normal: Image | None = None
    normal_repeat: float = 1.0
    roughness: float = 1.0
    metallic: float = 0.0
    alpha: Literal["OPAQUE", "MASK", "BLEND"] = "OPAQUE"
    cutoff: float = 0.5
    double_sided: bool = False


@dataclass(frozen=True, slots=True)
class Part:
    """One mesh. positions, normals float32 (n, 3), metres; uvs (n, 2); triangles uint32 (m, 3)."""

    name: str
    positions: Floats
    normals: Floats
    uvs: Floats
    triangles: Indices
    material: Material


@dataclass(frozen=True, slots=True)
class FatEntry:
    """How FAPs move vertices of one part: piecewise linear between knots of the drive.

    `drive`: (FAP number, coefficient) pairs; the sum of coefficient * FAP is what `knots` are values of.
    Mostly one FAP with coefficient 1. `indices` uint32 (n,); `deltas` int16 (k, n, 3), times `scale`
    metres at each of the k `knots`.
    """

    drive: tuple[tuple[int, float], ...]
    part: str
    knots: tuple[float, ...]
    indices: Indices
    deltas: NDArray[np.int16]
    scale: float

    @classmethod
    def of(
        cls,
        fap: int,
        part: str,
        knots: tuple[float, ...],
        indices: Indices,
        deltas: NDArray[np.int16],
        scale: float,
    ) -> FatEntry:
        """The table of one FAP."""
        return cls(((fap, 1.0),), part, knots, indices, deltas, scale)

    @property
    def faps(self) -> tuple[int, ...]:
        """The numbers of the FAPs that drive this table."""
        return tuple(fap for fap, _ in self.drive)


@dataclass(frozen=True, slots=True)
class Turn:
    """Rotations about one pivot, R = axes[0] * axes[1] * ..., one FAP (in AU) per axis.

    `parts` None is every part. `weights` float32 (n,) by part; a part not named turns fully.
    """

    faps: tuple[int, ...]
    axes: tuple[Point, ...]
    parts: tuple[str, ...] | None
    pivot: Point
    weights: Mapping[str, Floats] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Mouth:
    """A box round the lips at rest, metres."""

    center: Point
    size: tuple[float, float]


@dataclass(frozen=True, slots=True)
class Camera:
    """The portrait: what to look at, and the height in metres of the framed picture."""

    target: Point
    height: float


@dataclass(frozen=True, slots=True)
class Head:
    """A face and everything needed to move it. Frame: metres, +x subject's left, +y up, +z gaze."""

    name: str
    parts: tuple[Part, ...]
    fapu: Fapu
    fdp: Mapping[str, Point]
    mouth: Mouth
    camera: Camera
    fat: tuple[FatEntry, ...]
    turns: tuple[Turn, ...]

    def part(self, name: str) -> Part:
        """Raises KeyError."""
        for part in self.parts:
            if part.name == name:
                return part
        raise KeyError(name)
