"""Head files: GLB (glTF 2.0) bytes to a Head, everything checked. The other way is in gltf_write."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from fapstream.errors import DataError
from fapstream.head.fapu import Fapu, Point
from fapstream.head.mesh import (
    REQUIRED_PARTS,
    Camera,
    FatEntry,
    Head,
    Image,
    Material,
    Mouth,
    Part,
    Turn,
)
from fapstream.records import N_FAPS

VERSION = 1
MAX_FILE = 64 << 20
MAX_VERTICES = 1 << 20
MAX_ENTRIES = 4096
MAX_PARTS = 64
COMPONENTS: Mapping[int, str] = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS: Mapping[str, int] = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
FAPU_NAMES = ("IRISD0", "ES0", "ENS0", "MNS0", "MW0")
_UNSIGNED = {"<u1", "<u2", "<u4"}


def read_head(data: bytes, where: str = "head") -> Head:
    """The head in a GLB file.

    Raises DataError, naming `where` and the place in the file, for anything protocol/HEAD.md
    does not allow; never any other error, whatever the bytes.
    """
    document, binary = split_glb(data, where)
    return _Reader(document, binary, where).head()


def split_glb(data: bytes, where: str) -> tuple[dict[str, Any], bytes]:
    """The JSON object and the binary chunk of a GLB container. Raises DataError."""
    if len(data) > MAX_FILE:
        raise DataError(where, None, f"{len(data)} bytes; a head has at most {MAX_FILE}")
    if len(data) < 20 or data[:4] != b"glTF":
        raise DataError(where, None, "not a GLB file")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2 or length != len(data):
        raise DataError(where, None, f"GLB header says version {version}, {length} of {len(data)} bytes")
    chunks: list[tuple[bytes, bytes]] = []
    offset = 12
    while offset + 8 <= length and len(chunks) < 2:
        size, kind = struct.unpack_from("<I4s", data, offset)
        if offset + 8 + size > length:
            raise DataError(where, None, f"the chunk at byte {offset} runs past the end of the file")
        chunks.append((kind, data[offset + 8 : offset + 8 + size]))
        offset += 8 + size
    if not chunks or chunks[0][0] != b"JSON":
        raise DataError(where, None, "the first chunk is not JSON")
    try:
        document = json.loads(chunks[0][1])
    except (ValueError, RecursionError) as error:
        raise DataError(where, None, f"JSON chunk: {error}") from None
    if not isinstance(document, dict):
        raise DataError(where, None, "the JSON chunk is not an object")
    binary = chunks[1][1] if len(chunks) == 2 and chunks[1][0] == b"BIN\0" else b""
    return document, binary


class _Reader:
    """One document being read; every method says where it stopped."""

    def __init__(self, document: dict[str, Any], binary: bytes, where: str) -> None:
        self.document, self.binary, self.where = document, binary, where
        self.counts: dict[str, int] = {}

    def head(self) -> Head:
        asset = self.mapping(self.document, "asset", "")
        if asset.get("version") != "2.0":
            self.fail("asset.version", "is not 2.0")
        extras = self.mapping(self.mapping(self.document, "extras", ""), "fapstream", "extras.")
        if extras.get("version") != VERSION:
            self.fail(
                "extras.fapstream.version", f"is {extras.get('version')!r}; this reader knows {VERSION}"
            )
        parts = self.parts()
        self.counts = {part.name: len(part.positions) for part in parts}
        for name in REQUIRED_PARTS:
            if name not in self.counts:
                self.fail("nodes", f"the part {name!r} is missing")
        mouth, camera = (self.mapping(extras, key, "extras.fapstream.") for key in ("mouth", "camera"))
        fdp = self.mapping(extras, "fdp", "extras.fapstream.")
        return Head(
            name=str(extras.get("name", "")),
            parts=parts,
            fapu=self.fapu(self.mapping(extras, "fapu", "extras.fapstream.")),
            fdp={str(name): self.point(point, f"fdp[{name}]") for name, point in fdp.items()},
            mouth=Mouth(self.point(mouth.get("center"), "mouth.center"), self.size(mouth.get("size"))),
            camera=Camera(
                self.point(camera.get("target"), "camera.target"),
                self.positive(camera.get("height"), "camera.height"),
            ),
            fat=tuple(
                self.fat(row, f"fat[{i}]") for i, row in enumerate(self.sequence(extras, "fat", MAX_ENTRIES))
            ),
            turns=tuple(
                self.turn(row, f"turns[{i}]") for i, row in enumerate(self.sequence(extras, "turns", 64))
            ),
        )

    def parts(self) -> tuple[Part, ...]:
        parts: dict[str, Part] = {}
        for i, node in enumerate(self.sequence(self.document, "nodes", MAX_PARTS)):
            place = f"nodes[{i}]"
            if not isinstance(node, dict):
                self.fail(place, "is not an object")
            if "mesh" not in node:
                continue
            if any(key in node for key in ("matrix", "translation", "rotation", "scale")):
                self.fail(place, "has a transform; parts are in head coordinates")
            name = node.get("name")
            if not isinstance(name, str) or not name or name in parts:
                self.fail(place, f"needs a name of its own, not {name!r}")
            parts[name] = self.part(name, self.item("meshes", node["mesh"], place), place)
        return tuple(parts.values())

    def part(self, name: str, mesh: dict[str, Any], place: str) -> Part:
        primitives = mesh.get("primitives")
        if not isinstance(primitives, list) or len(primitives) != 1 or not isinstance(primitives[0], dict):
            self.fail(place, "needs a mesh of exactly one primitive")
        primitive = primitives[0]
        if primitive.get("mode", 4) != 4 or "indices" not in primitive:
            self.fail(place, "is not made of indexed triangles")
        attributes = self.mapping(primitive, "attributes", place + ".")
        positions = self.accessor(attributes.get("POSITION"), "VEC3", {"<f4"}, place + ".POSITION")
        triangles = self.accessor(primitive["indices"], "SCALAR", _UNSIGNED, place + ".indices")
        if len(triangles) % 3 or (triangles.size and triangles.max() >= len(positions)):
            self.fail(place + ".indices", "are not triangles of the part's vertices")
        return Part(
            name=name,
            positions=positions,
            normals=self.attribute(attributes, "NORMAL", "VEC3", len(positions), place),
            uvs=self.attribute(attributes, "TEXCOORD_0", "VEC2", len(positions), place),
            triangles=triangles.reshape(-1, 3).astype(np.uint32),
            material=self.material(primitive.get("material"), place),
        )

    def attribute(
        self, attributes: dict[str, Any], name: str, kind: str, count: int, place: str
    ) -> NDArray[np.float32]:
        if name not in attributes:
            return np.zeros((count, WIDTHS[kind]), np.float32)
        values = self.accessor(attributes[name], kind, {"<f4"}, f"{place}.{name}")
        if len(values) != count:
            self.fail(f"{place}.{name}", f"has {len(values)} values for {count} vertices")
        return values

    def material(self, index: Any, place: str) -> Material:
        if index is None:
            return Material("plain")
        row = self.item("materials", index, place)
        pbr = row.get("pbrMetallicRoughness", {})
        if not isinstance(pbr, dict):
            self.fail(place, "has a material without pbrMetallicRoughness")
        color = pbr.get("baseColorFactor", [1.0, 1.0, 1.0, 1.0])
        if not isinstance(color, list) or len(color) != 4:
            self.fail(place, "baseColorFactor is not four numbers")
        red, green, blue, opacity = (self.number(value, place + ".baseColorFactor") for value in color)
        alpha = row.get("alphaMode", "OPAQUE")
        if alpha not in ("OPAQUE", "MASK", "BLEND"):
            self.fail(place, f"alphaMode is {alpha!r}")
        return Material(
            name=str(row.get("name", "")),
            color=(red, green, blue, opacity),
            texture=self.image(pbr.get("baseColorTexture"), place),
            roughness=self.number(pbr.get("roughnessFactor", 1.0), place + ".roughnessFactor"),
            metallic=self.number(pbr.get("metallicFactor", 1.0), place + ".metallicFactor"),
            alpha=alpha,
            cutoff=self.number(row.get("alphaCutoff", 0.5), place + ".alphaCutoff"),
            double_sided=bool(row.get("doubleSided", False)),
        )

    def image(self, reference: Any, place: str) -> Image | None:
        if reference is None:
            return None
        if not isinstance(reference, dict):
            self.fail(place, "baseColorTexture is not an object")
        texture = self.item("textures", reference.get("index"), place)
        image = self.item("images", texture.get("source"), place)
        if "bufferView" not in image:
            self.fail(place, "its image is not embedded")
        return Image(self.view(image["bufferView"], place), str(image.get("mimeType", "")))

    def fapu(self, row: dict[str, Any]) -> Fapu:
        return Fapu(*(self.positive(row.get(name), f"fapu.{name}") for name in FAPU_NAMES))

    def fat(self, row: Any, place: str) -> FatEntry:
        if not isinstance(row, dict):
            self.fail(place, "is not an object")
        part = self.part_name(row.get("part"), place)
        knots = row.get("knots")
        if not isinstance(knots, list) or not 0 < len(knots) <= 64:
            self.fail(place, "knots are not a list of 1 to 64 FAP values")
        steps = [self.integer(knot, -32768, 32767, place + ".knots") for knot in knots]
        if 0 in steps or any(low >= high for low, high in pairwise(steps)):
            self.fail(place, f"knots {steps[:8]} must ascend and leave out 0")
        indices = self.accessor(row.get("indices"), "SCALAR", _UNSIGNED, place + ".indices")[:, 0]
        if indices.size and int(indices.max()) >= self.counts[part]:
            self.fail(place, f"moves vertex {indices.max()}; {part} has {self.counts[part]}")
        if len(np.unique(indices)) != len(indices):
            self.fail(place, "names a vertex twice")
        deltas = self.accessor(row.get("deltas"), "VEC3", {"<i2"}, place + ".deltas")
        if len(deltas) != len(steps) * len(indices):
            self.fail(place, f"has {len(deltas)} deltas for {len(steps)} knots of {len(indices)} vertices")
        return FatEntry(
            fap=self.integer(row.get("fap"), 3, N_FAPS, place + ".fap"),
            part=part,
            knots=tuple(steps),
            indices=indices.astype(np.uint32),
            deltas=deltas.reshape(len(steps), len(indices), 3),
            scale=self.positive(row.get("scale"), place + ".scale"),
        )

    def turn(self, row: Any, place: str) -> Turn:
        if not isinstance(row, dict):
            self.fail(place, "is not an object")
        faps = tuple(
            self.integer(fap, 3, N_FAPS, place + ".faps") for fap in self.sequence(row, "faps", 3, place)
        )
        axes = tuple(self.point(axis, place + ".axes") for axis in self.sequence(row, "axes", 3, place))
        if len(faps) != len(axes) or any(not any(axis) for axis in axes):
            self.fail(place, "needs one axis that is not zero for each FAP")
        names: tuple[str, ...] | None = None
        if row.get("parts") != "*":
            names = tuple(
                self.part_name(name, place) for name in self.sequence(row, "parts", MAX_PARTS, place)
            )
        rows = row.get("weights", {})
        if not isinstance(rows, dict):
            self.fail(place + ".weights", "is not an object")
        weights = {self.part_name(name, place): self.weights(name, i, place) for name, i in rows.items()}
        return Turn(faps, axes, names, self.point(row.get("pivot"), place + ".pivot"), weights)

    def weights(self, part: str, index: Any, place: str) -> NDArray[np.float32]:
        place = f"{place}.weights.{part}"
        values = self.accessor(index, "SCALAR", {"<f4", "<u1"}, place)[:, 0]
        if len(values) != self.counts.get(part):
            self.fail(place, "does not have one weight for each vertex")
        if values.dtype == np.uint8:
            return (values / np.float32(255)).astype(np.float32)
        return values.astype(np.float32)

    def accessor(self, index: Any, kind: str, types: set[str], place: str) -> NDArray[Any]:
        row = self.item("accessors", index, place)
        dtype = COMPONENTS.get(row.get("componentType", 0), "")
        if row.get("type") != kind or dtype not in types or "sparse" in row:
            self.fail(place, f"accessor is not a plain {kind} of {' or '.join(sorted(types))}")
        width = WIDTHS[kind]
        count = self.integer(row.get("count"), 1, 8 * MAX_VERTICES, place + ".count")
        start = self.integer(row.get("byteOffset", 0), 0, MAX_FILE, place + ".byteOffset")
        data = self.view(row.get("bufferView"), place, np.dtype(dtype).itemsize * width)
        need = count * width * np.dtype(dtype).itemsize
        if start + need > len(data):
            self.fail(place, f"needs {start + need} bytes of a view of {len(data)}")
        values = np.frombuffer(data, dtype, count * width, start).reshape(count, width)
        if dtype == "<f4" and not np.isfinite(values).all():
            self.fail(place, "has values that are not finite")
        return values

    def view(self, index: Any, place: str, stride: int | None = None) -> bytes:
        row = self.item("bufferViews", index, place)
        if row.get("buffer") != 0 or row.get("byteStride", stride) != stride:
            self.fail(place, "its buffer view is interleaved or not in the binary chunk")
        start = self.integer(row.get("byteOffset", 0), 0, MAX_FILE, place)
        size = self.integer(row.get("byteLength"), 1, MAX_FILE, place)
        if start + size > len(self.binary):
            self.fail(place, f"its buffer view ends at {start + size} of {len(self.binary)} bytes")
        return self.binary[start : start + size]

    def item(self, table: str, index: Any, place: str) -> dict[str, Any]:
        rows = self.document.get(table)
        if not isinstance(rows, list) or type(index) is not int or not 0 <= index < len(rows):
            self.fail(place, f"{table}[{index!r}] does not exist")
        row = rows[index]
        if not isinstance(row, dict):
            self.fail(place, f"{table}[{index}] is not an object")
        return row

    def part_name(self, name: Any, place: str) -> str:
        if not isinstance(name, str) or name not in self.counts:
            self.fail(place, f"there is no part {name!r}")
        return name

    def mapping(self, row: dict[str, Any], key: str, place: str) -> dict[str, Any]:
        value = row.get(key)
        if not isinstance(value, dict):
            self.fail(place + key, "is missing or not an object")
        return value

    def sequence(self, row: dict[str, Any], key: str, limit: int, place: str = "") -> Sequence[Any]:
        value = row.get(key)
        if not isinstance(value, list) or len(value) > limit:
            self.fail(f"{place}.{key}", f"is not a list of at most {limit}")
        return value

    def size(self, value: Any) -> tuple[float, float]:
        if not isinstance(value, list) or len(value) != 2:
            self.fail("mouth.size", "is not two numbers")
        return self.positive(value[0], "mouth.size"), self.positive(value[1], "mouth.size")

    def point(self, value: Any, place: str) -> Point:
        if not isinstance(value, list) or len(value) != 3:
            self.fail(place, "is not three numbers")
        x, y, z = (self.number(number, place) for number in value)
        return x, y, z

    def positive(self, value: Any, place: str) -> float:
        number = self.number(value, place)
        if number <= 0:
            self.fail(place, f"is {number}, not positive")
        return number

    def number(self, value: Any, place: str) -> float:
        if type(value) not in (int, float) or not math.isfinite(value) or abs(value) > 1e6:
            self.fail(place, f"{value!r} is not a number")
        return float(value)

    def integer(self, value: Any, low: int, high: int, place: str) -> int:
        if type(value) is not int or not low <= value <= high:
            self.fail(place, f"{value!r} is not an integer from {low} to {high}")
        return value

    def fail(self, place: str, reason: str) -> NoReturn:
        raise DataError(self.where, None, f"{place}: {reason}"[:400])
