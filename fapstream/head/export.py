"""Heads for other programs: GLB files with ordinary morph targets, a skeleton, and a talk as animation."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fapstream.fap.tables import faps
from fapstream.head.deform import deform
from fapstream.head.gltf_write import HeadWriter
from fapstream.head.mesh import FatEntry, Floats, Head
from fapstream.head.shapes import arkit, oculus, strengths
from fapstream.head.skeleton import Skeleton, add_skeleton, joint_tracks, skeleton

NOTHING = 1e-6
"""Metres; what a target moves less is left out."""


@dataclass(frozen=True, slots=True)
class Target:
    """A morph target: displacements (n, 3) in metres by part."""

    name: str
    moves: Mapping[str, Floats]


@dataclass(frozen=True, slots=True)
class Track:
    """Frames of FAPs (f, 68) at `fps`, and how strong each target is in each of them (f,)."""

    fps: float
    frames: NDArray[np.float64]
    weights: Mapping[str, NDArray[np.float64]]


def export_shapes(head: Head, keep: bool = False) -> bytes:
    """A GLB with the ARKit and Oculus shapes of `head`; with our own tables as well if `keep`.

    Raises DataError for a head whose turns overlap too much for a skeleton.
    """
    return _written(head, arkit_targets(head), None, keep)


def export_talk(head: Head, frames: NDArray[np.int32], fps: float, shapes: bool = False) -> bytes:
    """A GLB that says what `frames` (f, 68) have, `fps` a second.

    With the face animation tables as targets, so that every frame is exact; or, if `shapes`, with ARKit
    ones, as near as they come. The last frame is there twice, so that it lasts as long as the others.
    Raises as `export_shapes`.
    """
    frames = np.concatenate([frames, frames[-1:]])
    values = frames.astype(np.float64)
    if shapes:
        track = Track(fps, values, strengths(frames, list(arkit())))
        return _written(head, [t for t in arkit_targets(head) if t.name in arkit()], track, False)
    targets, weights = fap_targets(head, values)
    return _written(head, targets, Track(fps, values, weights), False)


def arkit_targets(head: Head) -> list[Target]:
    """The 52 ARKit shapes, then the 15 visemes: what `deform` makes of their FAPs, less the neutral face."""
    return [_target(head, name, values) for name, values in {**arkit(), **oculus()}.items()]


def fap_targets(
    head: Head, frames: NDArray[np.float64]
) -> tuple[list[Target], dict[str, NDArray[np.float64]]]:
    """A target for each knot of each table that `frames` (f, 68) use, and its strength in each frame (f,)."""
    moves: dict[str, dict[str, Floats]] = {}
    weights: dict[str, NDArray[np.float64]] = {}
    for entry in head.fat:
        values = sum(coefficient * frames[:, fap - 1] for fap, coefficient in entry.drive)
        for knot, shares in _knot_shares(entry.knots, np.asarray(values)).items():
            name = _knot_name(entry, knot)
            move = np.zeros((len(head.part(entry.part).positions), 3), np.float32)
            move[entry.indices] = entry.deltas[knot] * np.float32(entry.scale)
            moves.setdefault(name, {})[entry.part] = move
            weights[name] = shares
    return [Target(name, rows) for name, rows in moves.items()], weights


def _knot_shares(knots: tuple[float, ...], values: NDArray[np.float64]) -> dict[int, NDArray[np.float64]]:
    """`deform.knot_shares` for many values (f,) of a drive: by knot, its weights (f,) where it has any."""
    points = np.array(sorted((*knots, 0.0)))
    segment = np.clip(np.searchsorted(points, values, side="right") - 1, 0, len(points) - 2)
    share = (values - points[segment]) / (points[segment + 1] - points[segment])
    found = {}
    for knot, value in enumerate(knots):
        at = int(np.searchsorted(points, value))
        weights = np.where(segment == at, 1 - share, np.where(segment == at - 1, share, 0.0))
        if weights.any():
            found[knot] = weights
    return found


def _target(head: Head, name: str, values: NDArray[np.float64]) -> Target:
    moved = deform(head, values)
    moves = {part.name: (moved[part.name] - part.positions).astype(np.float32) for part in head.parts}
    return Target(name, {part: move for part, move in moves.items() if (np.abs(move) > NOTHING).any()})


def _knot_name(entry: FatEntry, knot: int) -> str:
    """The FAP's name in the standard; with the knot's value, where there are several."""
    name = "+".join(faps()[fap - 1].name for fap in entry.faps)
    return name if len(entry.knots) == 1 else f"{name}@{entry.knots[knot]:g}"


def _written(head: Head, targets: Sequence[Target], track: Track | None, keep: bool) -> bytes:
    writer = HeadWriter()
    writer.document["asset"]["extras"] = {"title": head.name}
    bones = skeleton(head)
    names = {part.name: _add_part(writer, head, part.name, targets, bones) for part in head.parts}
    skin, joints = add_skeleton(writer, head, bones)
    for part in head.parts:
        writer.document["nodes"][names[part.name][0]]["skin"] = skin
    if keep:
        writer.extras(head)
    if track is not None:
        turned = zip(joints, joint_tracks(head, bones, track.frames), strict=True)
        _animate(writer, track, names.values(), turned)
    return writer.file()


def _add_part(
    writer: HeadWriter, head: Head, name: str, targets: Sequence[Target], bones: Skeleton
) -> tuple[int, list[str]]:
    """The part's node, and the names of its targets."""
    part = head.part(name)
    writer.part(replace(part, normals=_unit(part.normals)))
    mesh = writer.document["meshes"][-1]
    primitive = mesh["primitives"][0]
    joints, weights = bones.weights[name]
    primitive["attributes"] |= {"JOINTS_0": writer.array(joints), "WEIGHTS_0": writer.array(weights)}
    mine = [target for target in targets if name in target.moves]
    if mine:
        primitive["targets"] = [{"POSITION": _morph(writer, target.moves[name])} for target in mine]
        mesh["extras"] = {"targetNames": [target.name for target in mine]}
        mesh["weights"] = [0] * len(mine)
    return len(writer.document["nodes"]) - 1, [target.name for target in mine]


def _unit(normals: Floats) -> Floats:
    """Heads of ours have them rounded; glTF wants unit length."""
    length = np.linalg.norm(normals.astype(np.float64), axis=1, keepdims=True)
    unit: Floats = np.where(length > 0, normals / np.maximum(length, 1e-12), (0, 0, 1)).astype(np.float32)
    return unit


def _morph(writer: HeadWriter, move: Floats) -> int:
    return writer.sparse(move, np.flatnonzero((np.abs(move) > NOTHING).any(1)))


def _animate(
    writer: HeadWriter,
    track: Track,
    parts: Iterable[tuple[int, list[str]]],
    turned: Iterable[tuple[int, Floats | None]],
) -> None:
    """`parts`: nodes and the names of their targets; `turned`: joints' nodes and their quaternions."""
    times = (np.arange(len(track.frames)) / track.fps).astype(np.float32)[:, None]
    clock = writer.array(times, bounds=True)
    channels: list[dict[str, Any]] = []
    samplers: list[dict[str, Any]] = []

    def add(node: int, path: str, values: NDArray[Any]) -> None:
        channels.append({"sampler": len(samplers), "target": {"node": node, "path": path}})
        samplers.append({"input": clock, "output": writer.array(values), "interpolation": "LINEAR"})

    for node, targets in parts:
        if any(target in track.weights for target in targets):
            still = np.zeros(len(track.frames))
            rows = np.stack([track.weights.get(target, still) for target in targets], 1)
            add(node, "weights", rows.astype(np.float32).reshape(-1, 1))
    for node, quaternions in turned:
        if quaternions is not None:
            add(node, "rotation", quaternions)
    if channels:
        writer.add("animations", {"name": "talk", "channels": channels, "samplers": samplers})
