"""Look into head files, take in other people's avatars, and hand heads to other programs."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from fapstream.adapters.files import read_file
from fapstream.cli.heads import opened
from fapstream.errors import DataError, InputError
from fapstream.fap import read_animation
from fapstream.head.export import export_shapes, export_talk
from fapstream.head.gltf_write import write_head
from fapstream.head.mesh import Head
from fapstream.records import N_FAPS

HELP = "show, import or export a head file"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """show HEAD | import FILE -o F.glb | export HEAD [--arkit] [--fap F] -o F.glb"""
    verbs = parser.add_subparsers(dest="verb", required=True, metavar="VERB")
    show = verbs.add_parser("show", help="what a head has: parts, feature points, FAPs, missing shapes")
    take = verbs.add_parser(
        "import", help="write an avatar with ARKit, Oculus or VRM shapes as a head of ours"
    )
    give = verbs.add_parser(
        "export", help="write a head with morph targets, for Blender, Unity and other web avatars"
    )
    for verb in (show, take, give):
        verb.add_argument(
            "head", metavar="HEAD", help="a GLB or VRM file, or the name of a head in the package"
        )
    for verb in (take, give):
        verb.add_argument("-o", "--out", type=Path, required=True, metavar="F.glb")
    give.add_argument(
        "--arkit", action="store_true", help="targets with the names of ARKit and Oculus (default)"
    )
    give.add_argument(
        "--fap",
        type=Path,
        metavar="F.fap|F.fba",
        help="animate this; targets are FAPs, or with --arkit ARKit's shapes",
    )
    give.add_argument("--keep", action="store_true", help="leave our own tables in the file as well")


def run(args: argparse.Namespace) -> int:
    """Raises OSError, InputError, DataError."""
    head = opened(args.head)
    if args.verb == "show":
        print("\n".join(described(head)))
        return 0
    what, data = ("a head of ours", write_head(head)) if args.verb == "import" else _exported(head, args)
    args.out.write_bytes(data)
    print(f"{args.out}: {head.name}, {what}, {len(data)} bytes")
    return 0


def described(head: Head) -> list[str]:
    """Lines for people."""
    moved = {fap for entry in head.fat for fap in entry.faps} | {
        fap for turn in head.turns for fap in turn.faps
    }
    still = [str(fap) for fap in range(3, N_FAPS + 1) if fap not in moved]
    lines = [f"{head.name}"]
    for part in head.parts:
        pictures = [
            name
            for name, image in (("colour", part.material.texture), ("normals", part.material.normal))
            if image
        ]
        size = f"{len(part.positions)} vertices, {len(part.triangles)} triangles"
        lines.append(f"  {part.name:<14} {size}{', ' + ' and '.join(pictures) if pictures else ''}")
    fapu = ", ".join(f"{name} {value * 1000:.1f} mm" for name, value in head.fapu.as_dict().items())
    lines += [
        f"FAPU: {fapu}",
        f"feature points: {len(head.fdp)}",
        f"low-level FAPs that move it: {len(moved)} of 66",
    ]
    return lines + ([f"without effect: {' '.join(still)}"] if still else [])


def _exported(head: Head, args: argparse.Namespace) -> tuple[str, bytes]:
    """What it is, and the file."""
    if args.fap is None:
        return "shapes of ARKit and Oculus", export_shapes(head, args.keep)
    if args.keep:
        raise InputError("--keep does not go with --fap: an animation needs no tables")
    sequence = read_animation(read_file(args.fap), str(args.fap))
    for note in sequence.notes:
        print(f"fapstream: {args.fap}: {note}", file=sys.stderr)
    frames = sequence.low_level()
    if not len(frames):
        raise DataError(str(args.fap), None, "has no frames")
    what = f"{len(frames)} frames, {len(frames) / sequence.fps:.2f} s"
    return what, export_talk(head, frames, sequence.fps, args.arkit)
