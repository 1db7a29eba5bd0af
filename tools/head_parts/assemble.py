"""From decimetres to a Head: parts in metres about the atlas, quantised tables, feature points."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp

from fapstream.head.deform import knot_shares
from fapstream.head.mesh import FatEntry, Material, Part
from head_parts.features import Mesh
from head_parts.fields import Motion
from head_parts.source import METRES
from head_parts.surface import Array, Ints

DROP_M = 5e-5
"""Displacements smaller than this over all knots are left out."""
STEP_M = 4e-5
"""Displacements are stored no finer than this, or than 1/300 of the largest; they pack better so."""
SHARED = 1.6
"""A table may name so many times the vertices that it moves, if another then has the same list."""
FINE_BITS, COARSE_BITS = 15, 13
"""Positions are multiples of 2**-bits metres (0.03 mm, and 0.12 mm for hair and cloth)."""
COARSE_PARTS = ("hair", "shirt")


@dataclass
class Piece:
    """A part before export. `sources` (n,) picks each exported vertex from the rows a Motion has.

    Where a vertex moves as a mixture of rows, `blend` (n, rows) has the weights and `sources` the chief one.
    """

    name: str
    points: Array
    normals: Array
    uvs: Array
    triangles: Ints
    material: Material
    sources: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    blend: sp.csr_matrix | None = None

    @classmethod
    def of(cls, name: str, mesh: Mesh, material: Material) -> Piece:
        return cls(
            name, mesh.points, mesh.normals, mesh.uvs, mesh.triangles, material, np.arange(len(mesh.points))
        )

    def moved(self, rows: Array) -> Array:
        """What a Motion's rows are on the exported vertices, (n, 3)."""
        return rows[self.sources] if self.blend is None else self.blend @ rows

    def packed(self) -> Piece:
        """The same piece with neighbouring triangles, and so vertices, one after the other: packs better."""
        triangles = self.triangles[_walk(self.triangles)]
        flat, first = np.unique(triangles.ravel(), return_index=True)
        order = flat[np.argsort(first)]
        number = np.empty(len(self.points), np.int64)
        number[order] = np.arange(len(order))
        rows = (self.points[order], self.normals[order], self.uvs[order])
        blend = None if self.blend is None else self.blend[order]
        return Piece(self.name, *rows, number[triangles], self.material, self.sources[order], blend)

    def part(self, origin: Array) -> Part:
        coarse = self.name in COARSE_PARTS
        return Part(
            self.name,
            _coarse((self.points - origin) * METRES, COARSE_BITS if coarse else FINE_BITS),
            _coarse(self.normals, 5 if coarse else 7),
            _coarse(self.uvs, 12),
            self.triangles.astype(np.uint32),
            self.material,
        )


def _walk(triangles: Ints) -> Ints:
    """An order of triangles in which each, where it can, shares an edge with the one before."""
    at_edge: dict[tuple[int, int], list[int]] = {}
    corners = triangles.tolist()
    for number, corner in enumerate(corners):
        for a, b in zip(corner, corner[1:] + corner[:1], strict=True):
            at_edge.setdefault((min(a, b), max(a, b)), []).append(number)
    done, order, waiting = [False] * len(corners), [], list(range(len(corners) - 1, -1, -1))
    while waiting:
        here = waiting.pop()
        if done[here]:
            continue
        done[here] = True
        order.append(here)
        corner = corners[here]
        for a, b in zip(corner, corner[1:] + corner[:1], strict=True):
            waiting += [n for n in at_edge[min(a, b), max(a, b)] if not done[n]]
    return np.array(order)


def attached(motions: list[Motion], name: str) -> list[Motion]:
    """The skin's motions for a part whose `sources` are vertices of the skin."""
    return [Motion(m.fap, name, m.knots, m.moves) for m in motions if m.part == "skin"]


def merged(
    pieces: dict[str, Piece], motions: list[Motion], names: tuple[str, ...], into: Piece
) -> tuple[dict[str, Piece], list[Motion]]:
    """Pieces and motions with the pieces `names` joined in one, which has `into`'s name and material."""
    parts = [pieces[name] for name in names]
    starts = np.cumsum([0] + [len(part.points) for part in parts])
    stacked = (np.concatenate([getattr(p, key) for p in parts]) for key in ("points", "normals", "uvs"))
    triangles = np.concatenate([p.triangles + start for p, start in zip(parts, starts, strict=False)])
    whole = Piece(into.name, *stacked, triangles, into.material, np.arange(starts[-1]))
    kept = [m for m in motions if m.part not in names]
    for fap in sorted({m.fap for m in motions if m.part in names}):
        rows = {m.part: m for m in motions if m.fap == fap and m.part in names}
        knots = tuple(sorted({knot for m in rows.values() for knot in m.knots}))
        moves = np.zeros((len(knots), starts[-1], 3))
        for name, start in zip(names, starts, strict=False):
            if name in rows:
                place = slice(start, start + len(pieces[name].points))
                moves[:, place] = [pieces[name].moved(_at(rows[name], knot)) for knot in knots]
        kept.append(Motion(fap, into.name, knots, tuple(moves)))
    rest = {name: piece for name, piece in pieces.items() if name not in names}
    return rest | {into.name: whole}, kept


def _at(motion: Motion, value: int) -> Array:
    """A motion at a FAP value, as protocol/HEAD.md has it between knots and beyond them."""
    shares = knot_shares(tuple(float(knot) for knot in motion.knots), float(value))
    return np.asarray(sum(share * motion.moves[k] for k, share in shares.items()))


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
    rows = []
    for motion in sorted(motions, key=lambda m: (m.fap, m.part)):
        if motion.part in pieces:
            moves = np.stack([pieces[motion.part].moved(move) for move in motion.moves]) * METRES
            moving = np.linalg.norm(moves, axis=2).max(0) > DROP_M
            if moving.any():
                rows.append((motion, moves, moving))
    regions = _regions([(motion.part, moving) for motion, _, moving in rows])
    entries = []
    for (motion, moves, moving), indices in zip(rows, regions, strict=True):
        moves = (moves * moving[:, None])[:, indices]
        most = np.abs(moves).max()
        step = min(STEP_M, float(np.format_float_positional(most / 300, 2, fractional=False)))
        scale = max(float(np.format_float_scientific(most / 32000, precision=4)), step)
        deltas = np.rint(moves / scale).astype(np.int16)
        entries.append(FatEntry.of(motion.fap, motion.part, motion.knots, indices, deltas, scale))
    return tuple(entries)


def _regions(rows: list[tuple[str, np.ndarray]]) -> list[np.ndarray]:
    """Vertex numbers for each (part, what moves): entries of a part that move much the same vertices share
    one array, which the file then has once."""
    groups: list[tuple[str, np.ndarray]] = []
    member = np.zeros(len(rows), int)
    for i in sorted(range(len(rows)), key=lambda i: -int(rows[i][1].sum())):
        part, moving = rows[i]
        for number, (owner, union) in enumerate(groups):
            if owner == part and (union | moving).sum() < SHARED * moving.sum():
                groups[number] = (part, union | moving)
                member[i] = number
                break
        else:
            member[i] = len(groups)
            groups.append((part, moving))
    return [np.flatnonzero(groups[number][1]).astype(np.uint32) for number in member]


def _coarse(values: Array, bits: int) -> np.ndarray:
    """float32 rounded to 2**-bits, which packs far better."""
    return (np.rint(values * 2.0**bits) / 2.0**bits).astype(np.float32)
