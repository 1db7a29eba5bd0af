"""The rotations of a head as a glTF skeleton: linear blend skinning does exactly what turns do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fapstream.errors import DataError
from fapstream.head.deform import rotation
from fapstream.head.fapu import Point
from fapstream.head.glb_writer import GlbWriter, short_list
from fapstream.head.mesh import Floats, Head, Turn

Combination = tuple[int, ...]
"""Numbers of the turns a vertex takes part in, the first applied first; a joint does them all."""

INFLUENCES = 4
MAX_JOINTS = 64
"""Eight turns that overlap with others' weights would need hundreds; heads have three."""
NAMES = {48: "Head", 23: "LeftEye", 24: "RightEye"}
"""Of joints, by the first FAP of their turn."""


@dataclass(frozen=True, slots=True)
class Skeleton:
    """Joint k does combination k; `weights`: by part, joint numbers and weights, both (n, 4)."""

    combinations: tuple[Combination, ...]
    weights: dict[str, tuple[NDArray[np.uint8], Floats]]


def skeleton(head: Head) -> Skeleton:
    """A turn moves a vertex by its weight's share; so two make four joints, most of them idle.

    Raises DataError for turns that overlap so much that more than MAX_JOINTS were needed.
    """
    shares = {part.name: _shares(head, part.name, len(part.positions)) for part in head.parts}
    needed: set[Combination] = {()}
    for table in shares.values():
        needed |= {combination[k:] for combination in table for k in range(len(combination))}
    _check(head, len(needed))
    combinations = tuple(sorted(needed, key=lambda c: (len(c), c)))
    weights = {}
    for name, table in shares.items():
        all_weights = np.zeros((len(next(iter(table.values()))), max(len(combinations), INFLUENCES)))
        for combination, share in table.items():
            all_weights[:, combinations.index(combination)] = share
        joints = np.argsort(-all_weights, axis=1, kind="stable")[:, :INFLUENCES]
        kept = np.take_along_axis(all_weights, joints, 1)
        joints[kept == 0] = 0
        weights[name] = (joints.astype(np.uint8), (kept / kept.sum(1, keepdims=True)).astype(np.float32))
    return Skeleton(combinations, weights)


def add_skeleton(writer: GlbWriter, head: Head, bones: Skeleton) -> tuple[int, list[int]]:
    """Writes joints and skin; the skin's number, and the node of each joint."""
    nodes: dict[Combination, int] = {}
    for combination in bones.combinations:
        pivot, parent = _pivot(head, combination), combination[1:]
        at = np.subtract(pivot, _pivot(head, parent))
        row: dict[str, Any] = {"name": _name(head, combination), "translation": short_list(at)}
        nodes[combination] = writer.add("nodes", row)
        if combination:
            writer.document["nodes"][nodes[parent]].setdefault("children", []).append(nodes[combination])
    bind = np.tile(np.eye(4, dtype=np.float32), (len(nodes), 1, 1))
    bind[:, 3, :3] = [np.negative(short_list(_pivot(head, combination))) for combination in nodes]
    joints = list(nodes.values())
    skin = {
        "joints": joints,
        "skeleton": joints[0],
        "inverseBindMatrices": writer.array(bind.reshape(-1, 16)),
    }
    writer.document["scenes"][0]["nodes"].append(joints[0])
    return writer.add("skins", skin), joints


def joint_tracks(head: Head, bones: Skeleton, frames: NDArray[np.float64]) -> list[Floats | None]:
    """For each joint its own rotation under frames of FAPs (f, 68): quaternions xyzw (f, 4); None at rest."""
    tracks: list[Floats | None] = []
    for combination in bones.combinations:
        turn = head.turns[combination[0]] if combination else None
        if turn is None or not frames[:, [fap - 1 for fap in turn.faps]].any():
            tracks.append(None)
        else:
            tracks.append(_smooth([_quaternion(turn, row) for row in frames]))
    return tracks


def _shares(head: Head, part: str, count: int) -> dict[Combination, NDArray[np.float64]]:
    """By combination, how much of each vertex (n,) it moves; together 1."""
    shares: dict[Combination, NDArray[np.float64]] = {(): np.ones(count)}
    for number, turn in enumerate(head.turns):
        if turn.parts is not None and part not in turn.parts:
            continue
        turned = turn.weights.get(part, np.ones(count, np.float32)).astype(np.float64)
        rows: dict[Combination, NDArray[np.float64]] = {}
        for combination, share in shares.items():
            rows[combination] = share * (1 - turned)
            rows[(*combination, number)] = share * turned
        shares = {combination: share for combination, share in rows.items() if share.any()}
        _check(head, len(shares))
    return shares


def _check(head: Head, joints: int) -> None:
    if joints > MAX_JOINTS:
        reason = f"its turns overlap so much that a skeleton would need more than {MAX_JOINTS} joints"
        raise DataError(head.name or "head", None, reason)


def _pivot(head: Head, combination: Combination) -> Point:
    return head.turns[combination[0]].pivot if combination else (0.0, 0.0, 0.0)


def _name(head: Head, combination: Combination) -> str:
    if not combination:
        return "Root"
    fap = head.turns[combination[0]].faps[0]
    return NAMES.get(fap, f"Turn{fap}")


def _quaternion(turn: Turn, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """xyzw of the turn's rotation. The largest component is worked out first, so none is lost to rounding."""
    m = rotation(turn, values)
    xx, yy, zz = np.diag(m)
    squares = np.array([1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz, 1 + xx + yy + zz])
    products = np.array([
        [squares[0], m[1, 0] + m[0, 1], m[0, 2] + m[2, 0], m[2, 1] - m[1, 2]],
        [m[1, 0] + m[0, 1], squares[1], m[2, 1] + m[1, 2], m[0, 2] - m[2, 0]],
        [m[0, 2] + m[2, 0], m[2, 1] + m[1, 2], squares[2], m[1, 0] - m[0, 1]],
        [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], squares[3]],
    ])  # fmt: skip
    row: NDArray[np.float64] = products[int(np.argmax(squares))]
    return row / np.linalg.norm(row)


def _smooth(rows: Sequence[NDArray[np.float64]]) -> Floats:
    """Of the two quaternions of each rotation the one nearer to its forerunner."""
    out = [rows[0] if rows[0][3] >= 0 else -rows[0]]
    for row in rows[1:]:
        out.append(row if row @ out[-1] >= 0 else -row)
    return np.array(out, np.float32)
