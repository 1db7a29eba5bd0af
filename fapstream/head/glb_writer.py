"""GLB (glTF 2.0) files, piece by piece: what both our heads and exports are made of."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fapstream.head.materials import TRANSFORM
from fapstream.head.mesh import Image, Material, Part

COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}
VERTICES, INDICES = 34962, 34963
"""Targets of buffer views."""


class GlbWriter:
    """A document that grows; equal arrays, pictures and materials are stored once."""

    def __init__(self) -> None:
        self.binary = bytearray()
        self.document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "fapstream"},
            "scene": 0,
            "scenes": [{"nodes": []}],
            **{table: [] for table in ("nodes", "meshes", "materials", "accessors", "bufferViews")},
        }
        self.seen: dict[Any, int] = {}

    def file(self) -> bytes:
        self.document["buffers"] = [{"byteLength": len(self.binary)}]
        return _glb(self.document, bytes(self.binary))

    def primitive(self, part: Part) -> dict[str, Any]:
        """The part's geometry and material."""
        attributes = {
            "POSITION": self.array(part.positions, VERTICES, bounds=True),
            "NORMAL": self.array(part.normals, VERTICES),
        }
        if part.material.texture is not None or part.material.normal is not None:
            attributes["TEXCOORD_0"] = self.array(part.uvs, VERTICES)
        return {
            "attributes": attributes,
            "indices": self.array(narrow(part.triangles.reshape(-1, 1)), INDICES),
            "material": self.material(part.material),
        }

    def material(self, material: Material) -> int:
        key = ("material", material)
        if key in self.seen:
            return self.seen[key]
        pbr: dict[str, Any] = {
            "baseColorFactor": short_list(material.color),
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        }
        if material.texture is not None:
            pbr["baseColorTexture"] = {"index": self.texture(material.texture)}
        row: dict[str, Any] = {"name": material.name, "pbrMetallicRoughness": pbr}
        if material.normal is not None:
            row["normalTexture"] = self.normal_map(material.normal, material.normal_repeat)
        if material.alpha != "OPAQUE":
            row["alphaMode"] = material.alpha
        if material.alpha == "MASK":
            row["alphaCutoff"] = material.cutoff
        if material.double_sided:
            row["doubleSided"] = True
        self.seen[key] = self.add("materials", row)
        return self.seen[key]

    def normal_map(self, image: Image, repeat: float) -> dict[str, Any]:
        row: dict[str, Any] = {"index": self.texture(image)}
        if repeat != 1:
            self.document["extensionsUsed"] = [TRANSFORM]
            row["extensions"] = {TRANSFORM: {"scale": [repeat, repeat]}}
        return row

    def texture(self, image: Image) -> int:
        key = ("image", image)
        if key not in self.seen:
            source = self.add("images", {"bufferView": self.view(image.data), "mimeType": image.mime})
            self.seen[key] = self.add("textures", {"source": source})
        return self.seen[key]

    def array(self, values: NDArray[Any], target: int | None = None, bounds: bool = False) -> int:
        """An accessor of (n, width) numbers; single uint8 ones, which are weights, are normalised."""
        values = np.ascontiguousarray(values)
        dtype = values.dtype.str[1:]
        data = values.astype("<" + dtype).tobytes()
        key = (data, dtype, values.shape, target)
        if key in self.seen:
            return self.seen[key]
        row: dict[str, Any] = {
            "bufferView": self.view(data, target),
            "componentType": COMPONENTS[dtype],
            "count": len(values),
            "type": KINDS[values.shape[1]],
        }
        if bounds:
            row["min"], row["max"] = values.min(0).tolist(), values.max(0).tolist()
        if dtype == "u1" and values.shape[1] == 1:
            row["normalized"] = True
        self.seen[key] = self.add("accessors", row)
        return self.seen[key]

    def sparse(self, values: NDArray[np.float32], rows: NDArray[Any]) -> int:
        """A sparse accessor (glTF 2.0, 3.6.2.3) of (n, 3) numbers that are 0 but for some rows."""
        rows = rows if rows.size else np.zeros(1, np.uint32)
        kept = np.ascontiguousarray(values[rows], "<f4")
        indices = narrow(rows)
        kind = COMPONENTS[indices.dtype.str[1:]]
        full = np.zeros((1, 3), np.float32) if len(rows) < len(values) else kept[:0]
        bounds = np.concatenate([kept, full])
        return self.add("accessors", {
            "componentType": COMPONENTS["f4"], "count": len(values), "type": "VEC3",
            "min": bounds.min(0).tolist(), "max": bounds.max(0).tolist(),
            "sparse": {
                "count": len(rows),
                "indices": {"bufferView": self.view(_little(indices)), "componentType": kind},
                "values": {"bufferView": self.view(kept.tobytes())},
            },
        })  # fmt: skip

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


def _little(values: NDArray[Any]) -> bytes:
    return values.astype(values.dtype.newbyteorder("<")).tobytes()


def narrow(indices: NDArray[Any]) -> NDArray[Any]:
    """As uint16 where they fit, else uint32."""
    return indices.astype(np.uint16 if indices.size == 0 or indices.max() < 65535 else np.uint32)


def short(value: float) -> float:
    """To a tenth of a micrometre."""
    return round(float(value), 7)


def short_list(values: Any) -> list[float]:
    return [short(value) for value in values]


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
