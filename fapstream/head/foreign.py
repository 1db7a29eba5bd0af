"""Other people's heads: any GLB or VRM whose morph targets have ARKit, Oculus or VRM names, as a Head."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fapstream.head.document import split_glb
from fapstream.head.gltf import MAX_PARTS, read_head
from fapstream.head.landmarks import JAW, LIPS, Landmarks, find
from fapstream.head.mesh import Camera, FatEntry, Head, Mouth, Part, Turn
from fapstream.head.nodes import Array, subtree
from fapstream.head.rig import EYES, bones, kind_of
from fapstream.head.scene import Scene, Surface, Wanted, kept
from fapstream.head.shapes import Plan, known, plan
from fapstream.head.vrm import Vrm, read_vrm

PLAUSIBLE_EYES = (0.045, 0.09)
"""Eye distances in metres that are left as they are."""
EYE_DISTANCE = 0.06
BUST_BELOW = 0.35
"""What lies deeper than this under the top of the spine, in metres, is no part of a portrait."""
NECK_SHARE = 0.4
FALLOFF = (-0.16, -0.06)
"""Without bones: heights, slanting up to the back, between which the neck begins to follow the head."""
NOTHING = 2e-5
"""Metres; what a shape moves less is left out."""
HEAD_FAPS, EYE_FAPS = (48, 49, 50), {"l": (23, 25), "r": (24, 26)}
X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Imported:
    """`plan`: what drives which shape, and what is missing. `notes`: what else a person should know."""

    head: Head
    plan: Plan
    notes: tuple[str, ...]

    def warnings(self) -> tuple[str, ...]:
        """One line for all missing shapes, and the notes."""
        if not self.plan.missing:
            return self.notes
        rows = [
            f"{name} ({' + '.join(self.plan.instead[name])} instead)" if name in self.plan.instead else name
            for name in self.plan.missing
        ]
        return (f"{self.head.name}: shapes are missing: {', '.join(rows)}", *self.notes)


def load_head(data: bytes, where: str = "head", name: str = "head") -> tuple[Head, tuple[str, ...]]:
    """Our own format or a foreign head, with warnings. `name`: for heads that have none. Raises DataError."""
    if is_ours(data, where):
        return read_head(data, where), ()
    imported = read_foreign(data, where, name)
    return imported.head, imported.warnings()


def is_ours(data: bytes, where: str) -> bool:
    """Whether a GLB file is in the format of protocol/HEAD.md. Raises DataError."""
    document, _ = split_glb(data, where)
    extras = document.get("extras")
    return isinstance(extras, dict) and "fapstream" in extras


def read_foreign(data: bytes, where: str = "head", name: str = "head") -> Imported:
    """The head in any GLB or VRM file.

    Raises DataError for a file that cannot be read, or has no face shapes; never any other error.
    """
    scene = Scene(*split_glb(data, where), where)
    vrm = read_vrm(scene)
    wanted = _wanted(scene, vrm)
    surfaces = scene.surfaces(wanted)
    names = {shape for surface in surfaces for shape, move in surface.moves.items() if move.any()}
    if not names & {*LIPS, *JAW}:
        _no_face(scene)
    if vrm.backwards:
        surfaces = [_transformed(surface, np.diag([-1.0, 1.0, -1.0]), np.zeros(3)) for surface in surfaces]
    rig = bones(scene.nodes, {i for i, row in enumerate(scene.document["nodes"]) if "mesh" in row}, vrm.bones)
    turned = np.array([-1, 1, -1]) if vrm.backwards else np.ones(3)
    marks = find(surfaces, {bone: scene.nodes[i].world[:3, 3] * turned for bone, i in rig.items()})
    surfaces, marks = _normalised(surfaces, marks)
    named = _named([bust for surface in surfaces if len((bust := _bust(surface)).triangles)])
    if not 0 < len(named) <= MAX_PARTS:
        scene.fail("meshes", f"there are {len(named)} parts near the head; 1 to {MAX_PARTS} can be shown")
    subtrees = {bone: subtree(scene.nodes, i) for bone, i in rig.items()}
    turns = [turn for side in "lr" if (turn := _eye_turn(side, named, marks, subtrees))]
    looks = [shape for shape in names if shape.startswith(("eyeLook", "look"))] if turns else []
    shapes = plan(names - set(looks), without=("eyeLook",) if turns else ())
    head = Head(
        name, tuple(_part(part, surface) for part, surface in named.items()), marks.fapu(), marks.fdp(),
        Mouth(_point(marks.mouth), marks.mouth_size), _camera(marks), _fat(named, shapes),
        (*turns, _head_turn(named, marks, subtrees)),
    )  # fmt: skip
    notes = (
        []
        if turns or looks
        else ["the eyes cannot turn: there are no eye bones, eye meshes or eyeLook shapes"]
    )
    return Imported(head, shapes, tuple(dict.fromkeys(scene.notes + notes)))


def _wanted(scene: Scene, vrm: Vrm) -> Wanted:
    """Morph targets by their own names; groups of VRM for shapes that no target is named after."""
    table: dict[tuple[int, int], dict[str, float]] = {}
    direct = set()
    for mesh, names in enumerate(scene.target_names()):
        here = set()
        for k, target in enumerate(names):
            shape = known(target)
            if shape is not None and shape not in here:
                here.add(shape)
                table.setdefault((mesh, k), {})[shape] = 1.0
        direct |= here
    for shape, binds in vrm.groups.items():
        for mesh, k, strength in binds if shape not in direct else ():
            table.setdefault((mesh, k), {})[shape] = strength
    return table


def _no_face(scene: Scene) -> None:
    seen = [name for names in scene.target_names() for name in names if name]
    has = f"its morph targets are called {', '.join(seen[:6])}" if seen else "it has no named morph targets"
    why = f"no face shapes that open the mouth: {has[:140]}; looked for are ARKit's names "
    scene.fail(
        "meshes",
        f"{why}(jawOpen, mouthSmileLeft, ...), Oculus visemes (viseme_aa, ...) and VRM's presets (aa, ...)",
    )


def _transformed(surface: Surface, linear: Array, shift: Array) -> Surface:
    """By a rotation and scale (3, 3), then a shift (3,)."""
    turn = linear / np.cbrt(np.linalg.det(linear))
    return replace(
        surface,
        positions=surface.positions @ linear.T + shift,
        normals=surface.normals @ turn.T,
        moves={name: (move @ linear.T).astype(np.float32) for name, move in surface.moves.items()},
    )


def _normalised(surfaces: Sequence[Surface], marks: Landmarks) -> tuple[list[Surface], Landmarks]:
    """In metres, with the top of the spine in the origin."""
    apart = marks.eye_distance
    scale = 1.0 if PLAUSIBLE_EYES[0] <= apart <= PLAUSIBLE_EYES[1] else EYE_DISTANCE / apart
    shift = -scale * marks.pivot
    moved = [_transformed(surface, scale * np.eye(3), shift) for surface in surfaces]
    width, height = marks.mouth_size
    left, right = (scale * eye + shift for eye in marks.eyes)
    return moved, Landmarks(
        (left, right), scale * marks.mouth + shift, (scale * width, scale * height),
        scale * marks.chin + float(shift[1]), scale * marks.top + float(shift[1]), np.zeros(3),
    )  # fmt: skip


def _bust(surface: Surface) -> Surface:
    high = surface.positions[:, 1] > -BUST_BELOW
    return kept(surface, surface.triangles[high[surface.triangles].any(1)])


def _named(surfaces: Sequence[Surface]) -> dict[str, Surface]:
    """By part names; the surface of which shapes move most vertices is the skin."""
    if not surfaces:
        return {}
    face = max(
        surfaces, key=lambda surface: sum(int(move.any(axis=1).sum()) for move in surface.moves.values())
    )
    found: dict[str, Surface] = {"skin": face}
    for surface in surfaces:
        if surface is face:
            continue
        kind = kind_of(surface.names)
        if kind in ("eye", "cornea", "lashes", "brows"):
            middle = float(np.median(surface.positions[:, 0]))
            one_side = (surface.positions[:, 0] > 0).all() or (surface.positions[:, 0] < 0).all()
            kind += ("_l" if middle > 0 else "_r") if one_side else ""
        number = 2
        while (name := kind if number == 2 and kind not in found else f"{kind}_{number}") in found:
            number += 1
        found[name] = surface
    return found


def _part(name: str, surface: Surface) -> Part:
    return Part(
        name, surface.positions.astype(np.float32), surface.normals.astype(np.float32),
        surface.uvs.astype(np.float32), surface.triangles.astype(np.uint32), surface.material,
    )  # fmt: skip


def _fat(named: Mapping[str, Surface], shapes: Plan) -> tuple[FatEntry, ...]:
    """One table for each shape and part, held between 0 and 1 by its knots."""
    entries = []
    for shape, drive in shapes.drives.items():
        for part, surface in named.items():
            move = surface.moves.get(shape)
            indices = np.flatnonzero(np.abs(move).max(1) > NOTHING) if move is not None else np.zeros(0, int)
            if move is None or not len(indices):
                continue
            scale = float(np.abs(move[indices]).max()) / 32767
            full = np.rint(move[indices] / scale).astype(np.int16)
            deltas = np.stack([np.zeros_like(full), full, full])
            entries.append(FatEntry(drive, part, (-1.0, 1.0, 2.0), indices.astype(np.uint32), deltas, scale))
    return tuple(entries)


def _eye_turn(
    side: str, named: Mapping[str, Surface], marks: Landmarks, subtrees: Mapping[str, set[int]]
) -> Turn | None:
    """By what hangs on the eye's bone; without one, by the parts that are eyes on that side."""
    weights = {}
    for name, surface in named.items():
        if EYES[side] in subtrees:
            share = surface.hanging(subtrees[EYES[side]])
        else:
            ball = name.startswith(("eye", "cornea"))
            share = (surface.positions[:, 0] > 0) == (side == "l") if ball else np.zeros(1)
        if share.any():
            weights[name] = _levels(share.astype(float))
    if not weights:
        return None
    centre = _point(marks.eyes[0 if side == "l" else 1])
    partial = {name: share for name, share in weights.items() if not (share == 1).all()}
    return Turn(EYE_FAPS[side], (Y, X), tuple(weights), centre, partial)


def _head_turn(named: Mapping[str, Surface], marks: Landmarks, subtrees: Mapping[str, set[int]]) -> Turn:
    weights = {}
    for name, surface in named.items():
        if "head" in subtrees:
            share = surface.hanging(subtrees["head"])
            if "neck" in subtrees:
                share = share + NECK_SHARE * surface.hanging(subtrees["neck"] - subtrees["head"])
        else:
            slant = surface.positions[:, 1] + 0.6 * surface.positions[:, 2]
            rise = np.clip((slant - FALLOFF[0]) / (FALLOFF[1] - FALLOFF[0]), 0, 1)
            share = rise * rise * (3 - 2 * rise)
        if not (share == 1).all():
            weights[name] = _levels(share)
    return Turn(HEAD_FAPS, (X, Y, Z), None, _point(marks.pivot), weights)


def _levels(share: Array) -> np.ndarray[tuple[int], np.dtype[np.float32]]:
    """In steps of 1/255, as they are stored."""
    steps: np.ndarray[tuple[int], np.dtype[np.float32]] = np.rint(np.clip(share, 0, 1) * 255).astype(
        np.float32
    )
    return steps / np.float32(255)


def _camera(marks: Landmarks) -> Camera:
    """As the average adult's portrait is framed, from the chin to the top of the hair."""
    height = marks.top - marks.chin
    middle = (marks.eyes[0] + marks.eyes[1]) / 2
    return Camera((float(middle[0]), marks.chin + 0.32 * height, 0.03), 1.565 * height)


def _point(values: Array) -> tuple[float, float, float]:
    x, y, z = values
    return float(x), float(y), float(z)
