"""The heads of the package, each read once for all tests."""

from __future__ import annotations

from functools import cache
from importlib import resources

from fapstream.head.gltf import read_head
from fapstream.head.mesh import Head

FOLDER = resources.files("fapstream").joinpath("assets", "heads")
NAMES = sorted(file.name.removesuffix(".glb") for file in FOLDER.iterdir() if file.name.endswith(".glb"))


@cache
def packaged_data(name: str = "generic") -> bytes:
    """The file."""
    return FOLDER.joinpath(f"{name}.glb").read_bytes()


@cache
def packaged(name: str = "generic") -> Head:
    """The head."""
    return read_head(packaged_data(name), name)
