"""Feeds damaged files to every reader, and what is read to whatever comes after it.

python tools/fuzz.py [KIND ...] [--seconds 60] [--seed 0] [--out DIR]
KIND: fap fba fdp xfdp head avatar (default: all, one after the other).

Whatever is raised that is no DataError, or takes longer than a second or 512 MB, is printed and its file
left in DIR; the exit status says whether there was any. What is found belongs into the corpus of the
room's tests.
"""

from __future__ import annotations

import argparse
import collections
import copy
import json
import random
import re
import resource
import sys
import time
import traceback
import warnings
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fapstream.errors import DataError, InputError
from fapstream.fap import encode_fba, format_fap, read_animation
from fapstream.fap.fdp import BoundPoint, Influence, Xfdp, format_fdp, format_xfdp, read_fdp, read_xfdp
from fapstream.head.deformer import Deformer
from fapstream.head.document import split_glb
from fapstream.head.export import export_shapes
from fapstream.head.foreign import load_head
from fapstream.head.gltf import read_head
from fapstream.head.gltf_write import write_head

ROOT = Path(__file__).parents[1]
SLOW_S, MOST_BYTES = 1.0, 512 << 20
LEAVES = (None, True, -1, 0, 1, 2, 7, 255, 2**31, 2**53, 10**400, 0.5, 1e-300, 1e30, -1e6, float("nan"),
          float("inf"), "", "x", [], {}, [0], [[]], [0, 0, 0], "VEC3", "jawOpen", "skin")  # fmt: skip
WORDS = (
    b"0", b"-1", b"1e999", b"nan", b"2147483648", b"99999999999999999999", b"\n", b"\r", b"#", b"\x00",
    b"\xff", b"2.1", b"\xef\xbb\xbf", b"<!DOCTYPE a>", b"&#0;", b"\x00\x00\x01\xba", b"\x00\x00\x01\xbb",
)  # fmt: skip


@dataclass(frozen=True)
class Kind:
    """`read` does with a file what users would; `seeds` are good files."""

    name: str
    seeds: tuple[bytes, ...]
    read: Callable[[bytes], object]


def kinds() -> dict[str, Kind]:
    """By name."""
    files = ROOT / "tests/unit/fap"
    faps = _contents(files.glob("*/*.fap"))
    good = _contents(files.glob("files/*.fap"))
    fbas = tuple(encode_fba(read_animation(data, "a.fap"))[0] for data in good)
    points = read_head((ROOT / "fapstream/assets/heads/generic.glb").read_bytes()).fdp
    bound = tuple(BoundPoint(name, "skin", 5, (5, 6), (Influence(51, 0.5),)) for name in points)
    xfdp = Xfdp({"MW0": 0.05}, (("a.wrl", "vrml"),), bound[:20])
    vectors = ROOT / "protocol/vectors"
    found = (
        Kind("fap", faps, lambda data: _animation(data, "a.fap")),
        Kind("fba", fbas + _contents(files.glob("corpus/*.fba")), lambda data: _animation(data, "a.fba")),
        Kind("fdp", (format_fdp(points).encode(),), lambda data: format_fdp(read_fdp(_text(data), "a.fdp"))),
        Kind("xfdp", (format_xfdp(xfdp).encode(),),
             lambda data: format_xfdp(read_xfdp(_text(data), "a.xfdp"))),
        Kind("head", _contents([vectors / "deform/small.glb"]), _head),
        Kind("avatar", _small_avatars(), _avatar),
    )  # fmt: skip
    return {kind.name: kind for kind in found}


def _text(data: bytes) -> str:
    return data.decode("utf-8", "replace")


def _contents(paths: Any) -> tuple[bytes, ...]:
    return tuple(path.read_bytes() for path in sorted(paths))


def _small_avatars() -> tuple[bytes, ...]:
    sys.path.insert(0, str(ROOT))
    from tests.unit.head.avatars import avatar

    shapes = ["jawOpen", "mouthPucker", "eyeBlinkLeft", "eyeLookUpLeft"]
    return avatar(shapes), avatar(shapes, rig=False), avatar(["viseme_aa"], scale=100)


def _animation(data: bytes, where: str) -> None:
    sequence = read_animation(data, where)
    if 0 < sequence.length < 10_000:  # what is longer than that takes its time
        sequence.low_level()
        format_fap(sequence)
        with suppress(InputError):  # rates that FBA has not
            encode_fba(sequence)


def _head(data: bytes) -> None:
    head = read_head(data, "a.glb")
    for value in (-32768, 0, 1024):
        Deformer(head).apply(np.full(68, value, np.int16))
    write_head(head)


def _avatar(data: bytes) -> None:
    head, _ = load_head(data, "a.glb")
    Deformer(head).apply(np.full(68, 500, np.int16))
    read_head(write_head(head), "again.glb")
    export_shapes(head)


def damaged(data: bytes, other: bytes, dice: random.Random) -> bytes:
    """One to six changes: in the JSON of a GLB file or in the bytes of any."""
    if data[:4] == b"glTF" and dice.random() < 0.7:
        return _other_json(data, dice)
    out = bytearray(data)
    for _ in range(dice.choice((1, 1, 1, 2, 3, 6))):
        at = dice.randrange(len(out) + 1)
        end = at + dice.choice((0, 1, 1, 2, 4, 8, 64, len(out)))
        way = dice.randrange(5)
        if way == 0:
            out[at : at + 1] = bytes([dice.randrange(256)])
        elif way == 1:
            out[at:at] = dice.choice(WORDS)
        elif way == 2:
            del out[at:end]
        elif way == 3:
            out[at:at] = out[at:end][: 1 << 16]
        else:
            start = dice.randrange(len(other) + 1)
            out[at:end] = other[start : start + 64]
    return bytes(out)


def _other_json(data: bytes, dice: random.Random) -> bytes:
    document, binary = split_glb(data, "seed")
    document = json.loads(json.dumps(document))
    for _ in range(dice.randint(1, 3)):
        at: Any = document
        for _ in range(12):
            keys = list(at) if isinstance(at, dict) else list(range(len(at)))
            if not keys:
                break
            key = dice.choice(keys)
            if not isinstance(at[key], dict | list) or dice.random() < 0.12:
                at[key] = copy.deepcopy(dice.choice((*LEAVES, dice.randrange(64))))
                break
            at = at[key]
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    size, chunk = 28 + len(text) + len(binary), len(text).to_bytes(4, "little") + b"JSON" + text
    return (
        b"glTF\2\0\0\0" + size.to_bytes(4, "little") + chunk
        + len(binary).to_bytes(4, "little") + b"BIN\0" + binary
    )  # fmt: skip


def fuzz(kind: Kind, seconds: float, seed: int, out: Path) -> int:
    """Prints what was found; returns how many different faults."""
    dice = random.Random(f"{kind.name} {seed}")
    refusals: collections.Counter[str] = collections.Counter()
    faults: dict[str, bytes] = {}
    runs, slowest, until = 0, 0.0, time.monotonic() + seconds
    while time.monotonic() < until:
        data = damaged(dice.choice(kind.seeds), dice.choice(kind.seeds), dice)
        began = time.thread_time()
        try:
            kind.read(data)
        except DataError as e:
            refusals[re.sub(r"'[^']*'|[\d.]+", "_", str(e))[:80]] += 1
        except Exception:
            faults.setdefault("".join(traceback.format_exc().splitlines(keepends=True)[-5:]), data)
        took = time.thread_time() - began
        slowest = max(slowest, took)
        if took > SLOW_S:
            faults.setdefault("more than a second", data)
        runs += 1
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss << 10
    if memory > MOST_BYTES:
        faults.setdefault("the memory", b"")
    print(f"{kind.name}: {runs} files, {runs - refusals.total()} read, {refusals.total()} refused for "
          f"{len(refusals)} reasons, slowest {slowest * 1000:.0f} ms, {memory >> 20} MB at most")  # fmt: skip
    for k, (text, data) in enumerate(faults.items()):
        out.mkdir(parents=True, exist_ok=True)
        (out / f"{kind.name}{k}").write_bytes(data)
        print(f"FAULT, in {out / f'{kind.name}{k}'}:\n{text}")
    return len(faults)


def main(argv: Sequence[str] | None = None) -> int:
    """0 if nothing was found."""
    known = kinds()
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("kinds", nargs="*", metavar="KIND", choices=[*known, []], help=" ".join(known))
    parser.add_argument("--seconds", type=float, default=60, help="for each kind (default 60)")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("faults"))
    args = parser.parse_args(argv)
    warnings.simplefilter("error", RuntimeWarning)
    faults = sum(fuzz(known[name], args.seconds, args.seed, args.out) for name in args.kinds or known)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
