"""Convert face animation between .fap text and .fba streams, and feature points of heads and files.

Animation: .fap to .fap or .fba, and back; `-` is .fap or .fba from standard input, .fap to standard output.

Feature points: a head's (its name, .glb or .vrm) to .fdp or .xfdp; .fdp to .fdp and .xfdp to .xfdp, checked
and made tidy.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fapstream.adapters.files import MAX_BYTES, read_file
from fapstream.cli.arguments import between
from fapstream.cli.heads import is_file, opened
from fapstream.errors import InputError
from fapstream.fap import FapSequence, FbaOptions, encode_fba, faps, format_fap, read_animation
from fapstream.fap.fdp import BoundPoint, Influence, Xfdp, format_fdp, format_xfdp, read_fdp, read_xfdp
from fapstream.fap.files import DEFAULT_FPS, MAX_FPS, VERSIONS
from fapstream.head.mesh import Head, Part
from fapstream.records import N_FAPS
from fapstream.server import packaged_heads

HELP = "convert .fap, .fba and feature point files"

ANIMATION = (".fap", ".fba")
POINTS = (".glb", ".fdp", ".xfdp")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """IN, OUT, --fap-quant, --intra-every, --low-level-only, --version, --fps, --mask."""
    parser.add_argument("source", metavar="IN", help="in.fap, in.fba, -, or a head, in.fdp, in.xfdp")
    parser.add_argument("target", metavar="OUT", help="out.fap, out.fba, -, or out.fdp, out.xfdp")
    parser.add_argument(
        "--fap-quant", type=int, default=3, metavar="N", help=".fba: coarseness, 1 to 31 (default 3)"
    )
    parser.add_argument(
        "--intra-every", type=int, default=0, metavar="N",
        help=".fba: an I frame every N frames, where decoding may begin (default: only the first)",
    )  # fmt: skip
    parser.add_argument(
        "--low-level-only", action="store_true",
        help="visemes and expressions as the FAPs 3-68 that they stand for",
    )  # fmt: skip
    parser.add_argument(
        "--version", choices=VERSIONS, default=VERSIONS[-1], help=".fap: version of the header (default 2.1)"
    )
    parser.add_argument(
        "--fps",
        type=between(0.01, MAX_FPS),
        default=DEFAULT_FPS,
        help="frames a second of a .fap without a header (default 25)",
    )
    parser.add_argument(
        "--mask",
        type=_faps,
        metavar="FAPS",
        help="keep only these FAPs, such as 3-18,51-60; the rest is masked",
    )


def run(args: argparse.Namespace) -> int:
    """Write OUT and print what it is; oddities of IN go to stderr."""
    if is_file(args.source) or args.source in packaged_heads():
        print(_extract_points(opened(args.source), args.source, args.target))
        return 0
    source, target = _kind(args.source), _kind(args.target)
    data = _read(args.source)
    if source == ".fdp" and data.lstrip()[:1] == b"<":
        source = ".xfdp"  # some call their XML so
    if source in POINTS:
        print(_convert_points(data, args.source, source, args.target, target))
    elif target in ANIMATION:
        _convert_animation(args, data, target)
    else:
        raise InputError(f"{args.source} is an animation, which {target} does not hold; write .fap or .fba")
    return 0


def _convert_animation(args: argparse.Namespace, data: bytes, target: str) -> None:
    sequence = read_animation(data, args.source, args.fps)
    _tell(args.source, sequence.notes)
    if args.mask is not None:
        sequence = sequence.only(args.mask)
    if target == ".fba":
        if args.low_level_only:
            sequence = FapSequence.of_values(sequence.low_level(), sequence.name, sequence.fps)
        written, notes = encode_fba(sequence, FbaOptions(args.fap_quant, args.intra_every))
        _tell(args.target, notes)
    else:
        written = format_fap(sequence, args.version, args.low_level_only).encode("ascii", "replace")
        if sequence.fps != int(sequence.fps):
            _tell(
                args.target, [f"many players cannot read {sequence.fps:g} frames a second, no whole number"]
            )
    _write(args.target, written)
    report = sys.stderr if args.target == "-" else sys.stdout
    print(_described(args.target, sequence, len(written)), file=report)


def _described(target: str, sequence: FapSequence, size: int) -> str:
    seconds = sequence.length / sequence.fps
    rate = f", {8 * size / seconds / 1000:.2f} kbit/s" if seconds else ""
    length = f"{sequence.length} frames, {seconds:.2f} s at {sequence.fps:g} frames a second"
    return f"{target}: {length}, {size} bytes{rate}"


def _extract_points(head: Head, source: str, target: str) -> str:
    """Write a head's feature points; returns what was written."""
    kind = _kind(target)
    if kind == ".fdp":
        _write(target, format_fdp(head.fdp).encode())
        return f"{target}: {len(head.fdp)} feature points"
    if kind == ".xfdp":
        return _write_xfdp(
            target, bound_points(head, Path(source).name if is_file(source) else f"{source}.glb")
        )
    raise InputError(f"{source} is a head, which has feature points for .fdp and .xfdp, not for {kind}")


def _convert_points(data: bytes, where: str, source: str, to: str, target: str) -> str:
    if source != target:
        raise InputError(
            f"feature points cannot go from {source} to {target}; a head's can go to .fdp and .xfdp"
        )
    if target == ".xfdp":
        return _write_xfdp(to, read_xfdp(_text(data, where), where))
    points = read_fdp(_text(data, where), where)
    _write(to, format_fdp(points).encode())
    return f"{to}: {len(points)} feature points"


def _write_xfdp(to: str, xfdp: Xfdp) -> str:
    _write(to, format_xfdp(xfdp).encode())
    return f"{to}: {len(xfdp.points)} feature points, {sum(len(p.indices) for p in xfdp.points)} vertices"


def bound_points(head: Head, file: str) -> Xfdp:
    """A head's feature points bound to its mesh as in xfdp: the nearest vertex, and what its FAPs move."""
    moved = {name: [f.fap for f in faps() if name in f.fdp] for name in head.fdp}
    points = []
    for name, at in sorted(head.fdp.items(), key=lambda item: tuple(map(int, item[0].split(".")))):
        part, index = _nearest(head.parts, np.array(at))
        indices = {
            int(k)
            for entry in head.fat
            if entry.part == part.name and set(entry.faps) & set(moved[name])
            for k in entry.indices
        }
        influences = tuple(Influence(fap, 0.5) for fap in moved[name])
        points.append(BoundPoint(name, part.name, index, tuple(sorted(indices)), influences))
    return Xfdp(head.fapu.as_dict(), ((file, "glb"),), tuple(points))


def _nearest(parts: tuple[Part, ...], at: NDArray[np.float64]) -> tuple[Part, int]:
    def distances(part: Part) -> NDArray[np.float64]:
        away: NDArray[np.float64] = np.linalg.norm(part.positions - at, axis=1)
        return away

    nearest = min(parts, key=lambda part: float(distances(part).min()))
    return nearest, int(distances(nearest).argmin())


def _kind(name: str) -> str:
    if name == "-":
        return ".fap"
    suffix = Path(name).suffix.lower()
    if suffix not in ANIMATION + POINTS:
        raise InputError(
            f"{name}: no kind of file that can be converted; there are {' '.join(ANIMATION + POINTS)}"
        )
    return suffix


def _read(name: str) -> bytes:
    if name != "-":
        return read_file(Path(name))
    data = sys.stdin.buffer.read(MAX_BYTES + 1)
    if len(data) > MAX_BYTES:
        raise InputError(f"standard input: more than {MAX_BYTES >> 20} MB")
    return data


def _write(name: str, data: bytes) -> None:
    if name == "-":
        sys.stdout.buffer.write(data)
        sys.stdout.buffer.flush()
    else:
        Path(name).write_bytes(data)


def _text(data: bytes, where: str) -> str:
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as e:
        raise InputError(f"{where} is no UTF-8 text: byte {e.start}") from None


def _tell(name: str, notes: Iterable[object]) -> None:
    for note in notes:
        print(f"{name}: {note}", file=sys.stderr)


def _faps(text: str) -> NDArray[np.bool_]:
    """`3-18,51` as bool of shape (68,)."""
    kept = np.zeros(N_FAPS, np.bool_)
    for piece in text.split(","):
        first, _, last = piece.partition("-")
        if not (first.isdecimal() and (last or first).isdecimal()):
            raise argparse.ArgumentTypeError(f"{piece!r} is neither a FAP nor two with a - between")
        low, high = int(first), int(last or first)
        if not 1 <= low <= high <= N_FAPS:
            raise argparse.ArgumentTypeError(f"{piece!r} does not go up from 1 to {N_FAPS} at most")
        kept[low - 1 : high] = True
    return kept
