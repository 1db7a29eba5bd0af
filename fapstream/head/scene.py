"""The meshes of any glTF scene as they stand at rest: transforms, skins and quantisation worked in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fapstream.errors import DataError
from fapstream.head.document import MAX_SIZE, UNSIGNED
from fapstream.head.materials import Materials
from fapstream.head.mesh import Image, Material
from fapstream.head.nodes import Array, read_nodes

MAX_MESHES = 256
MAX_SURFACE = 1 << 18
"""Vertices of one primitive."""
MAX_TARGETS = 1024
MAX_JOINTS = 1024
READABLE = ("KHR_mesh_quantization", "KHR_texture_", "KHR_materials_", "VRM", "EXT_texture_webp")
"""Beginnings of extensions that a file may require."""
TRIANGLES = 4

Wanted = Mapping[tuple[int, int], Mapping[str, float]]
"""(mesh number, target number) to the shapes the target is part of, with its strength in each."""


@dataclass(frozen=True, slots=True)
class Surface:
    """One primitive at rest, in the scene's coordinates.

    positions, normals (n, 3); uvs (n, 2); triangles (m, 3). `moves`: displacements float32 (n, 3) by
    shape. Vertices hang on the nodes `joints` (n, k) with `weights` (n, k) that sum to 1.
    """

    names: tuple[str, ...]
    positions: Array
    normals: Array
    uvs: Array
    triangles: NDArray[np.int64]
    material: Material
    moves: Mapping[str, NDArray[np.float32]]
    joints: NDArray[np.int64]
    weights: Array

    def hanging(self, nodes: set[int]) -> Array:
        """How far each vertex (n,) hangs on any of those nodes, 0 to 1."""
        total: Array = (self.weights * np.isin(self.joints, list(nodes))).sum(1)
        return total


class Scene(Materials):
    """A document read as a scene. Pictures that cannot be read are left out; `notes` says which."""

    def __init__(self, document: dict[str, Any], binary: bytes, where: str) -> None:
        super().__init__(document, binary, where)
        self.notes: list[str] = []
        required = document.get("extensionsRequired", [])
        for name in required if isinstance(required, list) else ["?"]:
            if not str(name).startswith(READABLE):
                self.fail("extensionsRequired", f"{name!r:.60} is not read here; export the model without it")
        self.nodes = read_nodes(self)

    def surfaces(self, wanted: Wanted) -> list[Surface]:
        """Every triangle mesh that a node shows, one Surface a primitive."""
        found = []
        for i, row in enumerate(self.document["nodes"]):
            if "mesh" not in row:
                continue
            for k, primitive in enumerate(self.primitives(row["mesh"])):
                place = f"meshes[{row['mesh']}].primitives[{k}]"
                if primitive.get("mode", TRIANGLES) != TRIANGLES:
                    self.notes.append(f"{place} is not made of triangles and is left out")
                    continue
                found.append(self._surface(i, row, primitive, wanted))
                if len(found) > MAX_MESHES:
                    self.fail(place, f"there are more than {MAX_MESHES} primitives")
        return found

    def image(self, reference: Any, place: str) -> Image | None:
        try:
            return super().image(reference, place)
        except DataError as error:
            self.notes.append(f"a picture is left out: {error.reason}")
            return None

    def repeat(self, reference: Any, place: str) -> float:
        return 1.0

    def target_names(self) -> list[list[str]]:
        """The morph targets' names by mesh and number, "" for none; a convention in `extras`."""
        found = []
        for i, mesh in enumerate(self.sequence(self.document, "meshes", MAX_MESHES)):
            primitives = self.primitives(i)
            names: list[str] = []
            for owner in (mesh, *primitives):
                extras = owner.get("extras")
                given = extras.get("targetNames") if isinstance(extras, dict) else None
                if isinstance(given, list):
                    names += [str(name) for name in given[len(names) : MAX_TARGETS]]
            count = max((len(primitive.get("targets", [])) for primitive in primitives), default=0)
            found.append(names + [""] * (count - len(names)))
        return found

    def primitives(self, mesh: Any) -> list[dict[str, Any]]:
        """A mesh's primitives; their `targets`, where they have any, are lists of objects."""
        place = f"meshes[{mesh!r:.10}]"
        rows = self.sequence(self.item("meshes", mesh, place), "primitives", MAX_MESHES, place)
        for k, row in enumerate(rows):
            if not isinstance(row, dict):
                self.fail(f"{place}.primitives[{k}]", "is not an object")
            targets = self.sequence({"targets": [], **row}, "targets", MAX_TARGETS, place)
            if not all(isinstance(target, dict) for target in targets):
                self.fail(f"{place}.targets", "are not all objects")
        return list(rows)

    def _surface(
        self, number: int, node: dict[str, Any], primitive: dict[str, Any], wanted: Wanted
    ) -> Surface:
        mesh = self.item("meshes", node["mesh"], f"nodes[{number}]")
        place = f"meshes[{node['mesh']}]"
        attributes = self.mapping(primitive, "attributes", place + ".")
        positions = self.floats(attributes.get("POSITION"), "VEC3", place + ".POSITION")
        n = len(positions)
        if n > MAX_SURFACE:
            self.fail(place + ".POSITION", f"has {n} vertices; {MAX_SURFACE} are the limit")
        triangles = self._triangles(primitive, n, place)
        normals, uvs = (
            self.floats(attributes[name], kind, f"{place}.{name}", n)
            if name in attributes
            else np.zeros((n, width))
            for name, kind, width in (("NORMAL", "VEC3", 3), ("TEXCOORD_0", "VEC2", 2))
        )
        material = self.material(primitive.get("material"), place)
        surface = Surface(
            (material.name, str(mesh.get("name", "")), str(node.get("name", ""))), positions, normals, uvs,
            triangles, material, self._moves(primitive, wanted, node["mesh"], n),
            np.full((n, 1), number), np.ones((n, 1)),
        )  # fmt: skip
        placed = self._placed(number, node, attributes, surface)
        return kept(placed, placed.triangles)

    def _triangles(self, primitive: dict[str, Any], count: int, place: str) -> NDArray[np.int64]:
        if "indices" in primitive:
            indices = self.accessor(primitive["indices"], "SCALAR", UNSIGNED, place + ".indices")[:, 0]
        else:
            indices = np.arange(count)
        if len(indices) % 3 or int(indices.max()) >= count:
            self.fail(place + ".indices", "are not triangles of the mesh's vertices")
        return indices.reshape(-1, 3).astype(np.int64)

    def _moves(
        self, primitive: dict[str, Any], wanted: Wanted, number: int, count: int
    ) -> dict[str, NDArray[np.float32]]:
        place, moves = f"meshes[{number}].targets", dict[str, NDArray[np.float32]]()
        for k, attributes in enumerate(primitive.get("targets", [])):
            shapes = wanted.get((number, k), {})
            if not shapes or "POSITION" not in attributes:
                continue
            move = self.floats(attributes["POSITION"], "VEC3", f"{place}[{k}].POSITION", count)
            for shape, strength in shapes.items():
                moves[shape] = (moves.get(shape, 0) + strength * move).astype(np.float32)
        return moves

    def _placed(
        self, number: int, node: dict[str, Any], attributes: dict[str, Any], surface: Surface
    ) -> Surface:
        """In the scene's coordinates: by the node, or by the joints of its skin (glTF 2.0, 3.7.3.3)."""
        if "skin" not in node:
            blend = np.broadcast_to(self.nodes[number].world, (len(surface.positions), 4, 4))
            return self._moved(surface, blend, number)
        skin = self.item("skins", node["skin"], f"nodes[{number}].skin")
        place = f"skins[{node['skin']}]"
        joints, matrices = self._joints(skin, place)
        chosen, weights = self._influences(attributes, len(surface.positions), len(joints), place)
        blend = np.zeros((len(surface.positions), 4, 4))
        for k in range(weights.shape[1]):
            blend += weights[:, k, None, None] * matrices[chosen[:, k]]
        surface = replace(surface, joints=joints[chosen], weights=weights)
        return self._moved(surface, blend, number)

    def _moved(self, surface: Surface, blend: Array, number: int) -> Surface:
        """By the transforms (n, 4, 4) of its vertices; those of a mirrored mesh turn its triangles round."""
        size: Array = np.linalg.det(blend[:, :3, :3])
        if not (np.abs(size) > 1e-15).all():
            self.fail(f"nodes[{number}]", "flattens its mesh to nothing")
        moved = _transformed(surface, blend)
        if max([_most(moved.positions), *(_most(move) for move in moved.moves.values())]) > MAX_SIZE:
            self.fail(f"nodes[{number}]", f"puts its mesh more than {MAX_SIZE:g} away")
        return replace(moved, triangles=moved.triangles[:, ::-1]) if np.median(size) < 0 else moved

    def _joints(self, skin: dict[str, Any], place: str) -> tuple[NDArray[np.int64], Array]:
        """Node numbers (k,) and the matrices (k, 4, 4) from the mesh to the scene."""
        joints = [
            self.integer(joint, 0, len(self.nodes) - 1, place + ".joints")
            for joint in self.sequence(skin, "joints", MAX_JOINTS, place)
        ]
        if not joints:
            self.fail(place, "has no joints")
        matrices = np.stack([self.nodes[joint].world for joint in joints])
        if "inverseBindMatrices" in skin:
            bind = self.floats(skin["inverseBindMatrices"], "MAT4", place + ".inverseBindMatrices")
            if len(bind) < len(joints):
                self.fail(place, f"has {len(bind)} matrices for {len(joints)} joints")
            matrices = matrices @ bind[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)
        return np.array(joints), matrices

    def _influences(
        self, attributes: dict[str, Any], count: int, joints: int, place: str
    ) -> tuple[NDArray[np.int64], Array]:
        """Joint numbers and weights (n, 4 or 8), weights summing to 1."""
        sets = [k for k in (0, 1) if f"JOINTS_{k}" in attributes]
        if not sets:
            self.fail(place, "is used by a mesh without JOINTS_0")
        small = frozenset({"<u1", "<u2"})
        chosen = np.concatenate(
            [self.accessor(attributes[f"JOINTS_{k}"], "VEC4", small, place + ".JOINTS", count) for k in sets],
            1,
        ).astype(np.int64)
        weights = np.concatenate(
            [self.floats(attributes.get(f"WEIGHTS_{k}"), "VEC4", place + ".WEIGHTS", count) for k in sets], 1
        )
        if int(chosen.max()) >= joints:
            self.fail(place, f"has {joints} joints; a vertex hangs on joint {chosen.max()}")
        weights = np.clip(weights, 0, None)
        total = weights.sum(1, keepdims=True)
        weights[total[:, 0] <= 1e-9, 0] = 1.0
        return chosen, weights / weights.sum(1, keepdims=True)

    def floats(self, index: Any, kind: str, place: str, count: int | None = None) -> Array:
        """An accessor's numbers as float64, integers normalised where it says so (glTF 2.0, 3.11)."""
        types = frozenset({"<i1", "<u1", "<i2", "<u2", "<f4"})
        values = self.accessor(index, kind, types, place, count)
        normalized = self.item("accessors", index, place).get("normalized") is True
        if not normalized or values.dtype.kind == "f":
            return values.astype(np.float64)
        result: Array = np.maximum(values / np.iinfo(values.dtype).max, -1.0)
        return result


def _most(values: NDArray[Any]) -> float:
    return float(np.abs(values).max())


def _transformed(surface: Surface, blend: Array) -> Surface:
    """By the transforms (n, 4, 4) of its vertices."""
    linear = blend[:, :3, :3]
    normals = np.einsum("nji,nj->ni", np.linalg.inv(linear), surface.normals)
    return replace(
        surface,
        positions=np.einsum("nij,nj->ni", linear, surface.positions) + blend[:, :3, 3],
        normals=normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12),
        moves={
            name: np.einsum("nij,nj->ni", linear, move).astype(np.float32)
            for name, move in surface.moves.items()
        },
    )


def kept(surface: Surface, triangles: NDArray[np.int64]) -> Surface:
    """With those triangles only, and without the vertices that none of them uses."""
    used, again = np.unique(triangles, return_inverse=True)
    return replace(
        surface,
        positions=surface.positions[used], normals=surface.normals[used], uvs=surface.uvs[used],
        triangles=again.reshape(-1, 3),
        moves={name: move[used] for name, move in surface.moves.items()},
        joints=surface.joints[used], weights=surface.weights[used],
    )  # fmt: skip
