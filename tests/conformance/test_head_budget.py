"""Each packaged head within what an ordinary laptop draws and loads with ease: the budget of the README."""

from __future__ import annotations

import gzip
import io
import json
from importlib import resources
from pathlib import Path

import pytest
from PIL import Image as Picture

from fapstream.head.gltf import read_head
from fapstream.head.mesh import Head

ASSETS = Path(str(resources.files("fapstream") / "assets"))
HEADS = sorted((ASSETS / "heads").glob("*.glb"))
LOOK = json.loads((ASSETS / "look" / "look.json").read_text("utf-8"))

DRAW_CALLS = 16
"""A picture: every part once, and what casts shadows once more."""
TRIANGLES = 32_000
TEXTURE_BYTES = 20_000_000
"""Decoded to RGBA with mipmaps, each picture once; the shadow map included."""
FILE_BYTES = 1_000_000
"""gzipped, as the server sends it."""


@pytest.fixture(params=HEADS, ids=lambda path: path.stem)
def path(request: pytest.FixtureRequest) -> Path:
    return Path(request.param)


@pytest.fixture
def head(path: Path) -> Head:
    return read_head(path.read_bytes(), path.name)


def test_draw_calls(head: Head) -> None:
    casters = tuple(LOOK["shadow"]["casters"])
    shadows = sum(p.name.startswith(casters) and p.material.alpha != "BLEND" for p in head.parts)
    assert shadows, "nothing casts a shadow"
    assert len(head.parts) + shadows <= DRAW_CALLS


def test_triangles(head: Head) -> None:
    assert sum(len(part.triangles) for part in head.parts) <= TRIANGLES


def test_texture_bytes(head: Head) -> None:
    materials = [part.material for part in head.parts]
    pictures = {image.data for m in materials for image in (m.texture, m.normal) if image}
    sizes = [Picture.open(io.BytesIO(data)).size for data in pictures]
    total = sum(w * h * 4 * 4 / 3 for w, h in sizes) + 4 * LOOK["shadow"]["size"] ** 2
    assert total <= TEXTURE_BYTES


def test_file(path: Path) -> None:
    assert len(gzip.compress(path.read_bytes(), 6)) <= FILE_BYTES
