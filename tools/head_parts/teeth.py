"""Teeth and gums, made for the jaws of one head. Decimetres.

A row has seven teeth a side but the wisdom and last molars, each a closed body of its own with crown outline,
belly and neck, and one gum whose rim follows the necks: deepest over a tooth, highest between two.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from head_parts.features import Mesh, facing, grid, joined
from head_parts.surface import Array

CROWNS = {
    # width, height of the crown, thickness, how pointed its edge is; from the middle outwards
    "upper": (
        (0.086, 0.104, 0.034, 0.00), (0.067, 0.093, 0.032, 0.06), (0.076, 0.100, 0.040, 0.22),
        (0.070, 0.084, 0.050, 0.12), (0.067, 0.077, 0.052, 0.08), (0.098, 0.072, 0.062, 0.05),
    ),
    "lower": (
        (0.053, 0.086, 0.030, 0.00), (0.058, 0.087, 0.031, 0.03), (0.067, 0.095, 0.038, 0.18),
        (0.069, 0.082, 0.046, 0.10), (0.071, 0.074, 0.050, 0.06), (0.106, 0.068, 0.062, 0.04),
    ),
}  # fmt: skip
"""Means of adult teeth (Ash and Nelson, Wheeler's Dental Anatomy), decimetres."""
RISE = np.array([0.0, 0.2, 0.6, 0.93, 1.0])
"""Rows of a tooth, from the neck under the gum to the edge."""
AROUND = 10, 6
"""Columns of a front tooth and of a molar."""
GUM_STEPS, GUM_ROOT = (6, 6, 6, 4, 2, 2), 0.185
"""Columns of the gum per tooth, and how far from the teeth's edge it ends."""
LIP_ROOM, OVERJET = 0.030, 0.064
"""From the lining of the upper lip to the upper arch, from the upper arch to the lower."""
SQUARE = 0.8
"""Exponent of the arch's superellipse; 1 would be an ellipse, less is squarer."""
OVERBITE, EDGE_BELOW_LIP = 0.016, 0.026


@dataclass(frozen=True)
class Arch:
    """The line on which teeth stand, half a superellipse seen from above."""

    front: float
    half_width: float
    depth: float

    def at(self, along: Array) -> tuple[Array, Array]:
        """Points (n, 3) at y = 0 and outward directions, by arc length from the middle, + to the left."""
        angle = np.linspace(0, 1.5, 500) ** 1.25 / 1.5**0.25
        x, z = np.sin(angle) ** SQUARE, np.cos(angle) ** SQUARE
        x, z = self.half_width * x, self.front - self.depth * (1 - z)
        length = np.r_[0, np.cumsum(np.hypot(np.diff(x), np.diff(z)))]
        sign, zero = np.where(along < 0, -1.0, 1.0), np.zeros_like(along, float)
        at_x, at_z = (np.interp(np.abs(along), length, row) for row in (x, z))
        slope_x, slope_z = (np.interp(np.abs(along), length, np.gradient(row, length)) for row in (x, z))
        points = np.stack([sign * at_x, zero, at_z], -1)
        out = np.stack([-sign * slope_z, zero, slope_x], -1)
        return points, out / np.linalg.norm(out, axis=-1, keepdims=True)


@dataclass(frozen=True)
class Bite:
    """Where the teeth of one face stand: its two arches and the heights of their edges."""

    upper: Arch
    lower: Arch
    upper_edge: float
    lower_edge: float

    @classmethod
    def of(cls, cage: Array, lining: float, lip_line: float) -> Bite:
        """From the source's upper teeth (n, 3), the z of the upper lip's lining and the lips' height."""
        half, front = float(cage[:, 0].max()), min(float(cage[:, 2].max()) + 0.005, lining - LIP_ROOM)
        depth = float(cage[:, 2].max() - cage[:, 2].min())
        upper = Arch(front, 0.93 * half, 0.99 * depth)
        lower = Arch(front - OVERJET, 0.862 * half, 0.90 * depth)
        edge = lip_line - EDGE_BELOW_LIP
        return cls(upper, lower, edge, edge + OVERBITE)


def teeth(which: str, bite: Bite) -> Mesh:
    """One row with its gum. Texture: u 0.02-0.46 teeth from front to back, 0.75 gum; v 0 neck, 1 edge."""
    upper = which == "upper"
    up, arch, edge = (1.0, bite.upper, bite.upper_edge) if upper else (-1.0, bite.lower, bite.lower_edge)
    meshes, start, borders = [], 0.0, [0.0]
    for crown in CROWNS[which]:
        centre = start + crown[0] / 2
        start += crown[0]
        borders.append(start)
        for side in (1.0, -1.0):
            meshes.append(_tooth(arch, side * centre, crown, edge, up))
    return joined([*meshes, _gum(arch, which, np.array(borders), edge, up)])


def _tooth(arch: Arch, along: float, crown: tuple[float, ...], edge: float, up: float) -> Mesh:
    width, height, thick, point = crown
    around = AROUND[0] if abs(along) < 0.24 else AROUND[1]
    turn = np.linspace(0, 2 * np.pi, around, endpoint=False)
    rise, turn = np.meshgrid(RISE, turn, indexing="ij")
    # the outline narrows to the neck and rounds off at the edge; the belly is a third up from the neck
    breadth = (0.80 + 0.20 * np.sin(np.pi / 2 * np.clip(rise * 1.4, 0, 1))) * _round(rise, 0.93, 0.55)
    belly = (0.95 - 0.62 * rise**1.3) * _round(rise, 0.97, 0.5)
    across = _power(np.cos(turn), 0.62) * breadth * width * 0.505
    outward = _power(np.sin(turn), 0.8) * belly * thick
    tip = np.clip(1 - np.abs(across) / (width * 0.5), 0, 1) - 0.5
    down = rise * height * 1.12 + point * 0.09 * tip * rise**4
    place, out = arch.at(np.array(along))
    sideways = np.cross([0.0, 1.0, 0.0], out)
    lean = 0.10 * (rise - 0.5) * height
    points = place + across[..., None] * sideways + (outward - 0.018 + lean)[..., None] * out
    points[..., 1] = edge + up * (height * 1.12 - down)
    shade = np.full_like(rise, 0.02 + 0.44 * min(abs(along) / 0.45, 1.0))
    mesh = grid(points, np.stack([shade, 0.05 + 0.93 * rise], -1), closed=True)
    cap = np.arange(around) + (len(RISE) - 1) * around
    lid = np.stack([np.full(around - 2, cap[0]), cap[1:-1], cap[2:]], 1)
    solid = Mesh(mesh.points, mesh.uvs, mesh.triangles)
    solid = facing(solid, solid.points - solid.points.mean(0))
    top = Mesh(solid.points, solid.uvs, lid)
    top = facing(top, np.tile([0.0, -up, 0.0], (len(solid.points), 1)))
    return Mesh(solid.points, solid.uvs, np.concatenate([solid.triangles, top.triangles]))


def _round(rise: Array, start: float, least: float) -> Array:
    """1 up to `start`, falling to `least` at 1 like the corner of a rounded box."""
    t = np.clip((rise - start) / (1 - start), 0, 1)
    return 1 - (1 - least) * t**2


def _power(value: Array, exponent: float) -> Array:
    return np.sign(value) * np.abs(value) ** exponent


def _gum(arch: Arch, which: str, borders: Array, edge: float, up: float) -> Mesh:
    """A ridge round the roots; its rim is high between teeth (the papillae) and low over each."""
    heights = np.array([crown[1] for crown in CROWNS[which]])
    half = np.concatenate(
        [np.linspace(a, b, n + 1)[:-1] for (a, b), n in zip(pairwise(borders), GUM_STEPS, strict=True)]
    )
    half = np.r_[half, borders[-1], borders[-1] + 0.05]
    along = np.r_[-half[:0:-1], half]
    phase = np.interp(np.abs(along), borders, np.arange(len(borders)))
    between = np.abs(2 * (phase % 1.0) - 1) ** 2.5
    neck = np.interp(np.abs(along), (borders[1:] + borders[:-1]) / 2, heights)
    # (out of the arch, from the rim 0 to the root 1): from the inside of the mouth to the vestibule
    profile = np.array([(-0.070, 1), (-0.052, 0.10), (-0.010, 0), (0.021, 0.06), (0.028, 0.35), (0.012, 1)])
    points, out = arch.at(along[:, None] + np.zeros(len(profile)))
    points = points + out * profile[:, 0][None, :, None]
    rim = (neck * (0.97 - 0.30 * between))[:, None]
    points[..., 1] = edge + up * (rim + (GUM_ROOT - rim) * profile[:, 1])
    v = np.broadcast_to(np.linspace(0.9, 0.1, len(profile)), points.shape[:2])
    mesh = grid(points, np.stack([np.full_like(v, 0.75), v], -1))
    centre, _ = arch.at(along[:, None] + np.zeros(len(profile)))
    centre[..., 1] = edge + up * 0.2
    return facing(mesh, mesh.points - centre.reshape(-1, 3) + out.reshape(-1, 3) * 0.02)
