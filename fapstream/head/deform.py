"""FAP values to vertex positions, as protocol/HEAD.md defines it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from fapstream.fap.tables import ANGLE_UNIT_RAD
from fapstream.head.mesh import FatEntry, Head, Turn

Values = NDArray[np.int32] | NDArray[np.float64]
"""One frame: shape (68,), FAP n at n-1, FAP units."""

Positions = dict[str, NDArray[np.float64]]


def deform(head: Head, values: Values) -> Positions:
    """Positions of every part under one frame of FAPs.

    Returns float64 (n, 3) by part, metres, the caller's own.
    """
    positions: Positions = {part.name: part.positions.astype(np.float64) for part in head.parts}
    for entry in head.fat:
        value = drive_value(entry, values)
        if value:
            positions[entry.part][entry.indices] += displacement(entry, value)
    for turn in head.turns:
        if any(values[fap - 1] for fap in turn.faps):
            _turn(turn, values, positions)
    return positions


def drive_value(entry: FatEntry, values: Values) -> float:
    """Where a frame of FAPs stands between the entry's knots: the sum of coefficient * FAP."""
    return sum(coefficient * float(values[fap - 1]) for fap, coefficient in entry.drive)


def displacement(entry: FatEntry, value: float) -> NDArray[np.float64]:
    """What the entry adds to `entry.indices` at one value of its drive: float64 (n, 3), metres."""
    total = np.zeros((entry.indices.size, 3))
    for knot, share in knot_shares(entry.knots, value).items():
        total += entry.deltas[knot] * (share * entry.scale)
    return total


def knot_shares(knots: tuple[float, ...], value: float) -> Mapping[int, float]:
    """The weights of the (at most two) knots that the value of a drive lies between.

    The value 0 is a knot too, whose displacement is nothing. Beyond the ends the last segment
    goes on, so weights may be negative or larger than one.
    """
    points = sorted((*knots, 0))
    segment = int(np.clip(np.searchsorted(points, value, side="right") - 1, 0, len(points) - 2))
    low, high = points[segment], points[segment + 1]
    share = (value - low) / (high - low)
    weights = {low: 1.0 - share, high: share}
    return {knots.index(point): weight for point, weight in weights.items() if point and weight}


def rotation(turn: Turn, values: Values) -> NDArray[np.float64]:
    """The 3x3 matrix of a turn: axes[0] * axes[1] * ..."""
    matrix = np.eye(3)
    for fap, axis in zip(turn.faps, turn.axes, strict=True):
        matrix = matrix @ about_axis(np.asarray(axis, float), float(values[fap - 1]) * ANGLE_UNIT_RAD)
    return matrix


def about_axis(axis: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Right-handed rotation by `angle` radians about `axis` (3,), of any length (Rodrigues)."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    result: NDArray[np.float64] = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross)
    return result


def _turn(turn: Turn, values: Values, positions: Positions) -> None:
    moved = (rotation(turn, values) - np.eye(3)).T
    pivot = np.asarray(turn.pivot)
    for name in positions if turn.parts is None else turn.parts:
        displaced = (positions[name] - pivot) @ moved
        if name in turn.weights:
            displaced *= turn.weights[name][:, None]
        positions[name] += displaced
