"""Look into head files, take in other people's avatars, and hand heads to other programs."""

from __future__ import annotations

import argparse
import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from fapstream.errors import DataError, InputError
from fapstream.fap import read_animation
from fapstream.head.export import export_shapes, export_talk
from fapstream.head.foreign import is_ours, load_head
from fapstream.head.gltf_write import write_head
from fapstream.head.mesh import Head
from fapstream.records import N_FAPS
from fapstream.server import packaged_heads

HELP = "show, import or export a head file"
SUFFIXES = (".glb", ".vrm")


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
    elif args.verb == "import":
        args.out.write_bytes(write_head(head))
    else:
        args.out.write_bytes(_exported(head, args))
    return 0


def opened(wish: str) -> Head:
    """The head in a file or in the package; what it lacks is said on stderr.

    Raises OSError, DataError for a file that is no head, InputError for a name that there is not.
    """
    packaged = packaged_heads()
    if Path(wish).suffix.lower() not in SUFFIXES:
        if wish not in packaged:
            raise InputError(
                f"no head called {wish!r}; there are {', '.join(packaged)}, or a file F.glb or F.vrm"
            )
        return load_head(packaged[wish].read_bytes(), wish)[0]
    head, warnings = load_head(Path(wish).read_bytes(), wish, Path(wish).stem)
    for warning in warnings:
        print(f"fapstream: {warning}", file=sys.stderr)
    return head


def servable(path: Path) -> Path:
    """The file itself if it is a head of ours; else one with what it was converted to, gone when we end.

    Raises OSError, DataError.
    """
    data = path.read_bytes()
    head, warnings = load_head(data, str(path), path.stem)
    for warning in warnings:
        print(f"fapstream: {warning}", file=sys.stderr)
    if is_ours(data, str(path)):
        return path
    converted = Path(_converted().name) / f"{path.stem}.glb"
    converted.write_bytes(write_head(head))
    return converted


@cache
def _converted() -> TemporaryDirectory[str]:
    return TemporaryDirectory(prefix="fapstream-")


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


def _exported(head: Head, args: argparse.Namespace) -> bytes:
    if args.fap is None:
        return export_shapes(head, args.keep)
    if args.keep:
        raise InputError("--keep does not go with --fap: an animation needs no tables")
    sequence = read_animation(args.fap.read_bytes(), str(args.fap))
    frames = sequence.low_level()
    if not len(frames):
        raise DataError(str(args.fap), None, "has no frames")
    return export_talk(head, frames, sequence.fps, args.arkit)
