"""From decimetres to a Head: parts in metres about the atlas, quantised tables, feature points."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fapstream.head.mesh import FatEntry, Material, Part
from head_parts.features import Mesh
from head_parts.fields import Motion
from head_parts.source import METRES
from head_parts.surface import Array, Ints

DROP_M = 2e-5
"""Displacements smaller than this over all knots are left out."""
STEP_M = 4e-6
"""Displacements are stored no finer than this; they pack better so."""


@dataclass
class Piece:
    """A part before export. `sources` (n,) picks each exported vertex from the rows a Motion has."""

    name: str
    points: Array
    normals: Array
    uvs: Array
    triangles: Ints
    material: Material
    sources: Ints = field(default_factory=lambda: np.zeros(0, np.int64))

    @classmethod
    def of(cls, name: str, mesh: Mesh, material: Material) -> Piece:
        return cls(
            name, mesh.points, mesh.normals, mesh.uvs, mesh.triangles, material, np.arange(len(mesh.points))
        )

    def part(self, origin: Array) -> Part:
        return Part(
            self.name,
            _coarse((self.points - origin) * METRES, 16),
            _coarse(self.normals, 7),
            _coarse(self.uvs, 12),
            self.triangles.astype(np.uint32),
            self.material,
        )


def seamed(
    points: Array, normals: Array, uvs: Array, triangles: Ints
) -> tuple[Array, Array, Array, Ints, Ints]:
    """Only the used vertices, those of triangles across u = 0|1 doubled; last, each one's source."""
    u = uvs[triangles][..., 0]
    across = np.ptp(u, axis=1) > 0.5
    shift = across[:, None] & (u < 0.5)
    keys = np.stack([triangles.ravel(), shift.ravel().astype(np.int64)], 1)
    pairs, inverse = np.unique(keys, axis=0, return_inverse=True)
    sources = pairs[:, 0]
    moved = uvs[sources] + pairs[:, 1:] * np.array([[1.0, 0.0]])
    return points[sources], normals[sources], moved, inverse.reshape(-1, 3), sources


def fat_entries(motions: list[Motion], pieces: dict[str, Piece]) -> tuple[FatEntry, ...]:
    """Motions of the exported vertices, int16, without those that hardly move."""
    entries = []
    for motion in sorted(motions, key=lambda m: (m.fap, m.part)):
        if motion.part not in pieces:
            continue
        moves = np.stack(motion.moves)[:, pieces[motion.part].sources] * METRES
        reach = np.linalg.norm(moves, axis=2).max(0)
        indices = np.flatnonzero(reach > DROP_M)
        if not indices.size:
            continue
        moves = moves[:, indices]
        scale = max(float(np.format_float_scientific(np.abs(moves).max() / 32000, precision=4)), STEP_M)
        deltas = np.rint(moves / scale).astype(np.int16)
        entries.append(
            FatEntry(motion.fap, motion.part, motion.knots, indices.astype(np.uint32), deltas, scale)
        )
    return tuple(entries)


def _coarse(values: Array, bits: int) -> np.ndarray:
    """float32 rounded to 2**-bits, which packs far better."""
    return (np.rint(values * 2.0**bits) / 2.0**bits).astype(np.float32)
