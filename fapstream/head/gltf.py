"""Head files: GLB (glTF 2.0) bytes to a Head, everything checked. The other way is in gltf_write."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fapstream.fap.fdp import FAPU_NAMES
from fapstream.head.document import UNSIGNED, WIDTHS, split_glb
from fapstream.head.fapu import Fapu
from fapstream.head.materials import Materials
from fapstream.head.mesh import (
    REQUIRED_PARTS,
    Camera,
    FatEntry,
    Head,
    Mouth,
    Part,
    Turn,
)
from fapstream.records import N_FAPS

VERSION = 1
MAX_ENTRIES = 4096
MAX_PARTS = 64
KNOT_GAP = 1e-6
"""What knots are apart, of each other and of 0, at the least: a table has no steps."""
_FLOAT = frozenset({"<f4"})


def read_head(data: bytes, where: str = "head") -> Head:
    """The head in a GLB file.

    Raises DataError, naming `where` and the place in the file, for anything protocol/HEAD.md
    does not allow; never any other error, whatever the bytes.
    """
    document, binary = split_glb(data, where)
    return _Reader(document, binary, where).head()


class _Reader(Materials):
    def __init__(self, document: dict[str, Any], binary: bytes, where: str) -> None:
        super().__init__(document, binary, where)
        self.counts: dict[str, int] = {}

    def head(self) -> Head:
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
        positions = self.accessor(attributes.get("POSITION"), "VEC3", _FLOAT, place + ".POSITION")
        triangles = self.accessor(primitive["indices"], "SCALAR", UNSIGNED, place + ".indices")
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
        values = self.accessor(attributes[name], kind, _FLOAT, f"{place}.{name}")
        if len(values) != count:
            self.fail(f"{place}.{name}", f"has {len(values)} values for {count} vertices")
        return values

    def fapu(self, row: dict[str, Any]) -> Fapu:
        return Fapu(*(self.positive(row.get(name), f"fapu.{name}") for name in FAPU_NAMES))

    def fat(self, row: Any, place: str) -> FatEntry:
        if not isinstance(row, dict):
            self.fail(place, "is not an object")
        part = self.part_name(row.get("part"), place)
        knots = row.get("knots")
        if not isinstance(knots, list) or not 0 < len(knots) <= 64:
            self.fail(place, "knots are not a list of 1 to 64 FAP values")
        steps = [self.number(knot, place + ".knots") for knot in knots]
        if min(map(abs, steps)) < KNOT_GAP or any(high - low < KNOT_GAP for low, high in pairwise(steps)):
            self.fail(place, f"knots {steps[:8]} must ascend, {KNOT_GAP} apart, and leave out 0")
        indices = self.accessor(row.get("indices"), "SCALAR", UNSIGNED, place + ".indices")[:, 0]
        if indices.size and int(indices.max()) >= self.counts[part]:
            self.fail(place, f"moves vertex {indices.max()}; {part} has {self.counts[part]}")
        named = np.zeros(self.counts[part], bool)
        named[indices] = True
        if np.count_nonzero(named) != len(indices):
            self.fail(place, "names a vertex twice")
        deltas = self.accessor(row.get("deltas"), "VEC3", frozenset({"<i2"}), place + ".deltas")
        if len(deltas) != len(steps) * len(indices):
            self.fail(place, f"has {len(deltas)} deltas for {len(steps)} knots of {len(indices)} vertices")
        return FatEntry(
            drive=self.drive(row, place),
            part=part,
            knots=tuple(steps),
            indices=indices.astype(np.uint32),
            deltas=deltas.reshape(len(steps), len(indices), 3),
            scale=self.positive(row.get("scale"), place + ".scale"),
        )

    def drive(self, row: dict[str, Any], place: str) -> tuple[tuple[int, float], ...]:
        if "drive" not in row:
            return ((self.integer(row.get("fap"), 3, N_FAPS, place + ".fap"), 1.0),)
        rows = self.mapping(row, "drive", place + ".")
        faps = [int(fap) if fap.isdecimal() and len(fap) < 3 else 0 for fap in rows]
        if not faps or not all(3 <= fap <= N_FAPS for fap in faps) or len(set(faps)) < len(faps):
            self.fail(place + ".drive", f"{list(rows)[:8]} are not FAPs from 3 to {N_FAPS}")
        return tuple(
            (fap, self.number(value, place + ".drive"))
            for fap, value in zip(faps, rows.values(), strict=True)
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
        values = self.accessor(index, "SCALAR", frozenset({"<f4", "<u1"}), place)[:, 0]
        if len(values) != self.counts.get(part):
            self.fail(place, "does not have one weight for each vertex")
        if values.dtype == np.uint8:
            return (values / np.float32(255)).astype(np.float32)
        return values.astype(np.float32)

    def part_name(self, name: Any, place: str) -> str:
        if not isinstance(name, str) or name not in self.counts:
            self.fail(place, f"there is no part {name!r}")
        return name

    def size(self, value: Any) -> tuple[float, float]:
        width, height = self.vector(value, 2, "mouth.size")
        return self.positive(width, "mouth.size"), self.positive(height, "mouth.size")
