"""The lower jaw: FAPs 3, 14 and 15 on the skin, the lower teeth and the tongue. Decimetres.

The bone turns about the axis through the condyles, which meanwhile slide forward and down their sockets'
slope, all in the midsagittal plane (as Reveret, Bailly and Badin 2000, section 3.3).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from head_parts.fields import Motion, Skin, Unit, X, Z
from head_parts.lips import Lips
from head_parts.surface import Array

KNOTS = (400, 800, 1200, 1600)
SLIDE = np.array([0.0, -0.20, 0.24])
"""Decimetres of the condyles per radian of opening: about 5 mm for 10 degrees."""
FULL_RAD, DROP = 0.55, np.array([0.0, -0.8, 0.1])
"""No jaw turns further; what a FAP asks beyond is a drop, decimetres per radian, so that any chin obeys."""


@dataclass(frozen=True)
class Jaw:
    """`condyles` (3,): a point of their axis, x = 0. On the skin: `weights` (n,) of the bone's motion, and
    `rest` (n, 3), what an artist's opening at `angle` has besides (soft tissue)."""

    condyles: Array
    weights: Array
    rest: Array
    angle: float

    @classmethod
    def fit(cls, condyles: Array, teeth: tuple[Array, Array], skin: Array, moved: Array) -> Jaw:
        """From an artist's opening: lower teeth (closed, open; (n, 3)) and skin displacement (n, 3)."""
        (closed, opened), centres = (row - row.mean(0) for row in teeth), [row.mean(0) for row in teeth]
        u, _, vt = np.linalg.svd(closed.T @ opened)
        turn = vt.T @ u.T
        full = (skin - centres[0]) @ turn.T + centres[1] - skin
        weights = np.clip((moved * full).sum(1) / np.maximum((full**2).sum(1), 1e-9), 0, 1.1)
        angle = float(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1)))
        return cls(condyles, weights, moved - weights[:, None] * full, angle)

    def bone(self, points: Array, angle: float) -> Array:
        """Displacement (n, 3) of points fixed to the bone, opened by `angle` radians."""
        turn = min(angle, FULL_RAD)
        c, s = np.cos(turn), np.sin(turn)
        y, z = (points - self.condyles)[:, 1], (points - self.condyles)[:, 2]
        turned = np.stack([0 * y, (c - 1) * y - s * z, s * y + (c - 1) * z], 1)
        return turned + SLIDE * turn + DROP * (angle - turn)

    def skin(self, points: Array, angle: float) -> Array:
        """Displacement (n, 3) of the skin over a jaw opened by `angle` radians."""
        return self.weights[:, None] * self.bone(points, angle) + angle / self.angle * self.rest


def jaw_motions(
    jaw: Jaw, lips: Lips, chin: int, unit: Unit, carried: dict[str, tuple[Array, Array]]
) -> list[Motion]:
    """FAPs 3, 14, 15. `chin`: the vertex of 2.1; `carried`: points and weights, by part, with the bone."""
    skin = lips.skin
    angles = [_angle(jaw, skin, chin, knot * unit["MNS"]) for knot in KNOTS]
    parts = {part: [w[:, None] * jaw.bone(p, a) for a in angles] for part, (p, w) in carried.items()}
    plans = [(3, KNOTS, [jaw.skin(skin.points, a) for a in angles], parts)]
    for fap, knot, direction, measure in ((14, 400, Z, "MNS"), (15, 200, -X, "MW")):
        move = direction * knot * unit[measure]
        field = np.clip(jaw.weights, 0, 1)[:, None] * move / min(jaw.weights[chin], 1)
        parts = {part: [w[:, None] * move] for part, (_, w) in carried.items()}
        plans.append((fap, (knot,), [field], parts))
    held = lips.held(np.concatenate([field for plan in plans for field in plan[2]], 1))
    fields = iter(np.split(held, held.shape[1] // 3, 1))
    out = []
    for fap, knots, on_skin, parts in plans:
        out.append(Motion(fap, "skin", knots, tuple(next(fields) for _ in on_skin)))
        out += [Motion(fap, part, knots, tuple(moves)) for part, moves in parts.items()]
    return out


def _angle(jaw: Jaw, skin: Skin, chin: int, drop: float) -> float:
    """The opening that lowers the chin by `drop`."""
    found: float = brentq(lambda a: jaw.skin(skin.points, a)[chin, 1] + drop, 0.0, 0.9)
    return found
