"""A Head to the bytes of a GLB file (protocol/HEAD.md)."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fapstream.head.gltf import VERSION
from fapstream.head.mesh import FatEntry, Head, Image, Material, Part, Turn

_COMPONENT = {"u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
_KIND = {1: "SCALAR", 2: "VEC2", 3: "VEC3"}


def write_head(head: Head) -> bytes:
    """The file `read_head` gives `head` back from. Equal arrays are stored once."""
    return _Writer().head(head)


class _Writer:
    def __init__(self) -> None:
        self.binary = bytearray()
        self.document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "fapstream"},
            "scene": 0,
            "scenes": [{"nodes": []}],
            "nodes": [],
            "meshes": [],
            "materials": [],
            "accessors": [],
            "bufferViews": [],
        }
        self.seen: dict[Any, int] = {}

    def head(self, head: Head) -> bytes:
        for part in head.parts:
            self.part(part)
        self.document["extras"] = {
            "fapstream": {
                "version": VERSION,
                "name": head.name,
                "fapu": {name: _short(value) for name, value in head.fapu.as_dict().items()},
                "fdp": {name: _short_list(point) for name, point in head.fdp.items()},
                "mouth": {"center": _short_list(head.mouth.center), "size": _short_list(head.mouth.size)},
                "camera": {"target": _short_list(head.camera.target), "height": _short(head.camera.height)},
                "fat": [self.fat(entry) for entry in head.fat],
                "turns": [self.turn(turn) for turn in head.turns],
            }
        }
        self.document["buffers"] = [{"byteLength": len(self.binary)}]
        return _glb(self.document, bytes(self.binary))

    def part(self, part: Part) -> None:
        attributes = {
            "POSITION": self.array(part.positions, 34962, bounds=True),
            "NORMAL": self.array(part.normals, 34962),
        }
        if part.material.texture is not None:
            attributes["TEXCOORD_0"] = self.array(part.uvs, 34962)
        primitive = {
            "attributes": attributes,
            "indices": self.array(_narrow(part.triangles.reshape(-1, 1)), 34963),
            "material": self.material(part.material),
        }
        number = self.add("meshes", {"name": part.name, "primitives": [primitive]})
        self.document["scenes"][0]["nodes"].append(self.add("nodes", {"name": part.name, "mesh": number}))

    def material(self, material: Material) -> int:
        key = ("material", material)
        if key in self.seen:
            return self.seen[key]
        pbr: dict[str, Any] = {
            "baseColorFactor": _short_list(material.color),
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        }
        if material.texture is not None:
            pbr["baseColorTexture"] = {"index": self.texture(material.texture)}
        row: dict[str, Any] = {"name": material.name, "pbrMetallicRoughness": pbr}
        if material.alpha != "OPAQUE":
            row["alphaMode"] = material.alpha
        if material.alpha == "MASK":
            row["alphaCutoff"] = material.cutoff
        if material.double_sided:
            row["doubleSided"] = True
        self.seen[key] = self.add("materials", row)
        return self.seen[key]

    def texture(self, image: Image) -> int:
        key = ("image", image)
        if key not in self.seen:
            source = self.add("images", {"bufferView": self.view(image.data), "mimeType": image.mime})
            self.seen[key] = self.add("textures", {"source": source})
        return self.seen[key]

    def fat(self, entry: FatEntry) -> dict[str, Any]:
        return {
            "fap": entry.fap,
            "part": entry.part,
            "knots": list(entry.knots),
            "scale": entry.scale,
            "indices": self.array(_narrow(entry.indices[:, None])),
            "deltas": self.array(entry.deltas.reshape(-1, 3)),
        }

    def turn(self, turn: Turn) -> dict[str, Any]:
        row: dict[str, Any] = {
            "faps": list(turn.faps),
            "axes": [list(axis) for axis in turn.axes],
            "parts": "*" if turn.parts is None else list(turn.parts),
            "pivot": _short_list(turn.pivot),
        }
        if turn.weights:
            row["weights"] = {name: self.array(_levels(w)) for name, w in turn.weights.items()}
        return row

    def array(self, values: NDArray[Any], target: int | None = None, bounds: bool = False) -> int:
        values = np.ascontiguousarray(values)
        dtype = values.dtype.str[1:]
        data = values.astype("<" + dtype).tobytes()
        key = (data, dtype, values.shape, target)
        if key in self.seen:
            return self.seen[key]
        row: dict[str, Any] = {
            "bufferView": self.view(data, target),
            "componentType": _COMPONENT[dtype],
            "count": len(values),
            "type": _KIND[values.shape[1]],
        }
        if bounds:
            row["min"], row["max"] = values.min(0).tolist(), values.max(0).tolist()
        if dtype == "u1":
            row["normalized"] = True
        self.seen[key] = self.add("accessors", row)
        return self.seen[key]

    def view(self, data: bytes, target: int | None = None) -> int:
        self.binary += bytes(-len(self.binary) % 4)
        row = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)}
        if target is not None:
            row["target"] = target
        self.binary += data
        return self.add("bufferViews", row)

    def add(self, table: str, row: dict[str, Any]) -> int:
        rows = self.document.setdefault(table, [])
        rows.append(row)
        return len(rows) - 1


def _narrow(indices: NDArray[Any]) -> NDArray[Any]:
    return indices.astype(np.uint16 if indices.size == 0 or indices.max() < 65535 else np.uint32)


def _levels(weights: NDArray[np.float32]) -> NDArray[Any]:
    """uint8 where that loses nothing, float32 otherwise; shape (n, 1)."""
    levels = np.rint(weights * 255)
    exact = np.array_equal((levels / np.float32(255)).astype(np.float32), weights)
    return levels.astype(np.uint8)[:, None] if exact else weights[:, None]


def _short(value: float) -> float:
    return round(float(value), 7)


def _short_list(values: Any) -> list[float]:
    return [_short(value) for value in values]


def _glb(document: dict[str, Any], binary: bytes) -> bytes:
    text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    binary += bytes(-len(binary) % 4)
    size = 12 + 8 + len(text) + 8 + len(binary)
    header = struct.pack("<4sII", b"glTF", 2, size)
    return b"".join(
        (
            header,
            struct.pack("<I4s", len(text), b"JSON"),
            text,
            struct.pack("<I4s", len(binary), b"BIN\0"),
            binary,
        )
    )
