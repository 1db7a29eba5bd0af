"""Small avatars as other people make them: a bulging sheet for a face, shapes that push parts of it about."""

from __future__ import annotations

import copy
import json
import struct
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from fapstream.head.document import split_glb
from fapstream.head.glb_writer import GlbWriter
from fapstream.head.mesh import Material
from fapstream.head.shapes import arkit

SIZE = 25
MOUTH, EYES = (0.0, -0.035), 0.03
PUSHES: dict[str, tuple[tuple[float, float], tuple[float, float, float], float]] = {
    # beginning of a name: (where), (whereto), how wide; metres, left side
    "jawOpen": ((0, -0.07), (0, -0.03, -0.005), 0.03), "viseme_aa": ((0, -0.07), (0, -0.025, 0), 0.03),
    "mouthPucker": (MOUTH, (0, 0, 0.01), 0.015), "viseme_U": (MOUTH, (0, 0, 0.01), 0.015),
    "mouthSmile": ((0.025, -0.035), (0.006, 0.008, 0), 0.012), "mouth": (MOUTH, (0.002, 0.004, 0), 0.015),
    "viseme": (MOUTH, (0, -0.004, 0), 0.015), "jaw": ((0, -0.07), (0.004, 0, 0.002), 0.03),
    "eyeBlink": ((EYES, 0.035), (0, -0.01, 0), 0.01), "blink": ((EYES, 0.035), (0, -0.01, 0), 0.01),
    "eye": ((EYES, 0.035), (0, -0.003, 0), 0.01), "brow": ((EYES, 0.06), (0, 0.006, 0), 0.012),
    "cheek": ((0.04, -0.01), (0.003, 0.003, 0.003), 0.02), "nose": ((0.012, 0), (0.001, 0.003, 0), 0.01),
    "tongue": (MOUTH, (0, 0, 0.01), 0.008),
}  # fmt: skip
BOTH = ("blink", "browInnerUp", "cheekPuff")


def sheet() -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) in metres about the head's bone, and triangles (m, 3)."""
    x, y = np.meshgrid(np.linspace(-0.08, 0.08, SIZE), np.linspace(-0.11, 0.13, SIZE))
    points = np.stack([x, y, 0.1 - 4 * x * x - 2 * y * y], -1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(SIZE - 1), np.arange(SIZE - 1), indexing="ij")
    a = (i * SIZE + j).ravel()
    return points, np.concatenate(
        [np.stack([a, a + 1, a + SIZE + 1], 1), np.stack([a, a + SIZE + 1, a + SIZE], 1)]
    )


def push(name: str, points: np.ndarray) -> np.ndarray:
    """What the shape `name` does to points (n, 3)."""
    (x, y), to, wide = next(row for start, row in PUSHES.items() if name.startswith(start))
    sides = (1, -1) if name in BOTH else (-1,) if name.endswith("Right") else (1,)
    total = np.zeros_like(points)
    for side in sides:
        near = np.exp(-(((points[:, 0] - side * x) ** 2 + (points[:, 1] - y) ** 2) / wide**2))
        total += near[:, None] * (np.array(to) * (side, 1, 1))
    return np.where(np.abs(total) > 1e-5, total, 0)


def avatar(
    names: Iterable[str] | dict[str, str] = (), scale: float = 1.0, rig: bool = True, **extensions: Any
) -> bytes:
    """A face with the morph targets `names` (or file name: shape), two eyes, and a skeleton if `rig`.

    `scale`: units in a metre. It stands 1.5 m high.
    """
    shapes = names if isinstance(names, dict) else {name: name for name in (names or arkit())}
    writer = GlbWriter()
    points, triangles = sheet()
    flat = triangles.reshape(-1, 1).astype(np.uint16)
    head = writer.add("nodes", {"name": "mixamorig:Head", "translation": [0, 1.5 * scale, 0], "children": []})
    writer.document["scenes"][0]["nodes"] = [head]
    mesh = {"name": "Wolf3D_Head", "extras": {"targetNames": list(shapes)}, "primitives": [{
        "attributes": {"POSITION": writer.array((points * scale).astype(np.float32), bounds=True)},
        "indices": writer.array(flat), "material": writer.material(Material("Skin")),
        "targets": [{"POSITION": writer.sparse(np.float32(push(shape, points) * scale), moved(shape))}
                    for shape in shapes.values()],
    }]}  # fmt: skip
    children = writer.document["nodes"][head]["children"]
    children.append(writer.add("nodes", {"name": "Wolf3D_Head", "mesh": writer.add("meshes", mesh)}))
    for side, x in (("Left", EYES), ("Right", -EYES)):
        ball = writer.array((points[:75] * 0.1 * scale).astype(np.float32), bounds=True)
        eye = {"primitives": [{"attributes": {"POSITION": ball}}], "name": "Ball"}
        bone = {"name": f"{side}Eye", "translation": [x * scale, 0.035 * scale, 0.07 * scale]}
        if rig:
            bone["children"] = [writer.add("nodes", {"name": "Shell", "mesh": writer.add("meshes", eye)})]
            children.append(writer.add("nodes", bone))
    if not rig:
        writer.document["nodes"][head]["name"] = "Armature"
    if extensions:
        writer.document["extensions"] = extensions
    return writer.file()


def moved(shape: str) -> np.ndarray:
    return np.flatnonzero(push(shape, sheet()[0]).any(1))


def changed(data: bytes, change: Callable[[dict[str, Any]], Any]) -> bytes:
    """The file with its JSON changed."""
    document, binary = split_glb(data, "test")
    document = copy.deepcopy(document)
    change(document)
    return packed(document, bytes(binary))


def packed(document: Any, binary: bytes) -> bytes:
    text = document if isinstance(document, bytes) else json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = (
        struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    )
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body
