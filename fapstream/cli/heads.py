"""Which head a command means: a name in the package, or anybody's GLB or VRM file."""

from __future__ import annotations

import re
import sys
from functools import cache
from importlib.resources.abc import Traversable
from pathlib import Path
from tempfile import TemporaryDirectory

from fapstream.adapters.files import read_file
from fapstream.errors import InputError
from fapstream.head.document import MAX_FILE
from fapstream.head.foreign import is_ours, load_head
from fapstream.head.gltf_write import write_head
from fapstream.head.mesh import Head
from fapstream.server import packaged_heads

SUFFIXES = (".glb", ".vrm")
NO_NAME = re.compile(r"[^A-Za-z0-9_-]+")
"""What an address cannot have."""


def opened(wish: str) -> Head:
    """The head in a file or in the package; what it lacks is said on stderr.

    Raises OSError, DataError for a file that is no head, InputError for a name that there is not.
    """
    if is_file(wish):
        return _read(Path(wish))[0]
    return load_head(packaged(wish).read_bytes(), wish)[0]


def servable(wish: str) -> tuple[str, Traversable]:
    """The name to serve a head by, and a file of ours: what had to be converted is gone when we end.

    Raises as `opened`.
    """
    if not is_file(wish):
        return wish, packaged(wish)
    path = Path(wish)
    name = NO_NAME.sub("-", path.stem).strip("-_")[:64] or "head"
    head, ours = _read(path)
    if ours:
        return name, path
    converted = Path(_converted().name) / f"{name}.glb"
    converted.write_bytes(write_head(head))
    return name, converted


def is_file(wish: str) -> bool:
    """Whether it names a file rather than a head in the package."""
    return Path(wish).suffix.lower() in SUFFIXES


def packaged(name: str) -> Traversable:
    """A head in the package. Raises InputError for a name that there is not."""
    known = packaged_heads()
    if name not in known:
        raise InputError(f"no head called {name!r}; there are {', '.join(known)}, or a file F.glb or F.vrm")
    return known[name]


def _read(path: Path) -> tuple[Head, bool]:
    """The head in a file, and whether the file is in our own format."""
    data = read_file(path, MAX_FILE)
    head, warnings = load_head(data, str(path), path.stem)
    for warning in warnings:
        print(f"fapstream: {warning}", file=sys.stderr)
    return head, is_ours(data, str(path))


@cache
def _converted() -> TemporaryDirectory[str]:
    return TemporaryDirectory(prefix="fapstream-")
