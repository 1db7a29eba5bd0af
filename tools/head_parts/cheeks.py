"""Cheeks: FAPs 39-42, and how they fold and bulge when the corners of the mouth go. Decimetres.

The artist's shapes are the guides: what is left of a smile when the lips' own motions are taken away is
the cheek's rise and the nasolabial fold, and goes with the corner's FAPs.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from head_parts.fields import Motion, Unit, X, Y
from head_parts.lips import Lips
from head_parts.surface import Array

Shape = Callable[[str], Array]
"""An artist's shape by its ARKit name as displacement of the fine skin (n, 3)."""

BALLOON, HOLLOW = 0.42, 0.26
"""Radius of a cheek blown up, and of one sucked in (between the jaws, not over the teeth)."""
FOLDS = {
    # shape -> the FAPs it goes with (left), each with its share
    "mouthSmile": ((59, 0.65), (53, 0.35)),
    "mouthFrown": ((59, 1.0),),
}


def puffs(lips: Lips, points: dict[str, int], shape: Shape, unit: Unit) -> list[Motion]:
    """FAPs 39 and 40: straight out of the cheek, as far round as the artist's cheekPuff."""
    skin, blown = lips.skin, np.linalg.norm(shape("cheekPuff"), axis=1)
    out = []
    for fap, name, sign in ((39, "5.1", 1.0), (40, "5.2", -1.0)):
        at = points[name]
        gap = np.linalg.norm(skin.points - skin.points[at], axis=1)
        share = blown / blown[at] * _side(skin.points, sign) * np.exp(-((gap / BALLOON) ** 2))
        hollow = np.minimum(share, 1) * np.exp(-((gap / HOLLOW) ** 2))
        way = skin.outward(at, X * sign) * 200 * unit["ES"]
        moves = (lips.held(-hollow[:, None] * way), lips.held(share[:, None] * way))
        out.append(Motion(fap, "skin", (-200, 200), moves))
    return out


def lifts(lips: Lips, points: dict[str, int], shape: Shape, unit: Unit) -> list[Motion]:
    """FAPs 41 and 42: up, as in the artist's cheekSquint."""
    out = []
    for fap, name, side in ((41, "5.3", "Left"), (42, "5.4", "Right")):
        move = shape(f"cheekSquint{side}")
        move = lips.held(move * 300 * unit["ENS"] / (move[points[name]] @ Y))
        out.append(Motion(fap, "skin", (300,), (move,)))
    return out


def folded(lips: Lips, motions: list[Motion], shape: Shape) -> list[Motion]:
    """The corners' motions, each way with its share of the cheek that goes with it."""
    table = {motion.fap: motion for motion in motions}
    for side, step in (("Left", 0), ("Right", 1)):
        for name, rows in FOLDS.items():
            moved = shape(name + side)
            rest = lips.held(moved - _by_faps(lips, table, moved))
            for left, share in rows:
                table[left + step] = _with(table[left + step], lips, moved, share * rest)
    return list(table.values())


def _with(motion: Motion, lips: Lips, moved: Array, rest: Array) -> Motion:
    """A straight motion, bent at 0: `rest` comes in on the side to which the shape moves its point."""
    value = _value(lips, motion, moved)
    positive = motion.moves[-1] + max(value, 0) * rest / value**2 * motion.knots[-1]
    negative = motion.moves[0] if len(motion.moves) > 1 else -motion.moves[0]
    negative = negative - min(value, 0) * rest / value**2 * motion.knots[-1]
    return Motion(motion.fap, motion.part, (-motion.knots[-1], motion.knots[-1]), (negative, positive))


def _value(lips: Lips, motion: Motion, moved: Array) -> float:
    """The FAP value at which a motion takes its feature point as far along its axis as the shape does."""
    at = lips.feature(motion.fap)
    axis = np.argmax(np.abs(motion.moves[-1][at]))
    return float(moved[at, axis] / motion.moves[-1][at, axis] * motion.knots[-1])


def _by_faps(lips: Lips, table: dict[int, Motion], moved: Array) -> Array:
    """The part of a shape that the lips' FAPs make."""
    total = np.zeros_like(moved)
    for fap in lips.raises.keys() | lips.stretches.keys():
        motion = table[fap]
        total += _value(lips, motion, moved) / motion.knots[-1] * motion.moves[-1]
    return total


def _side(points: Array, sign: float) -> Array:
    t = np.clip(0.5 + points[:, 0] * sign / 0.2, 0, 1)
    return t * t * (3 - 2 * t)
