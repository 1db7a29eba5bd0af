"""What VRM says beyond glTF: which node is which bone, and expressions made of morph targets.

VRM 0.x (the extension VRM) and VRM 1.0 (VRMC_vrm).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from fapstream.head.document import Document
from fapstream.head.shapes import PRESET, known

MAX_BINDS = 4096


@dataclass(frozen=True, slots=True)
class Vrm:
    """`bones`: node numbers by VRM's bone names. `groups`: (mesh, target, strength) by face shape.

    `backwards`: the model looks along -z, as VRM 0 has it.
    """

    bones: Mapping[str, int]
    groups: Mapping[str, list[tuple[int, int, float]]]
    backwards: bool


def read_vrm(document: Document) -> Vrm:
    """Nothing where the file is no VRM. Raises DataError."""
    extensions = document.document.get("extensions")
    rows: dict[str, Any] = extensions if isinstance(extensions, dict) else {}
    new, old = rows.get("VRMC_vrm"), rows.get("VRM")
    if isinstance(new, dict):
        return Vrm(_bones(document, new), _grouped(_expressions(document, new)), False)
    if isinstance(old, dict):
        return Vrm(_bones(document, old), _grouped(_blend_shapes(document, old)), True)
    return Vrm({}, {}, False)


def _bones(document: Document, vrm: dict[str, Any]) -> dict[str, int]:
    humanoid = vrm.get("humanoid")
    bones = humanoid.get("humanBones") if isinstance(humanoid, dict) else None
    if isinstance(bones, list):
        pairs = [(row.get("bone"), row) for row in bones if isinstance(row, dict)]
    else:
        pairs = list(bones.items()) if isinstance(bones, dict) else []
    nodes = document.document.get("nodes")
    last = len(nodes) - 1 if isinstance(nodes, list) else -1
    return {
        str(name): document.integer(row.get("node"), 0, last, f"humanBones.{name}"[:60])
        for name, row in pairs
        if isinstance(row, dict)
    }


def _grouped(rows: Iterator[tuple[str, tuple[int, int, float]]]) -> dict[str, list[tuple[int, int, float]]]:
    groups: dict[str, list[tuple[int, int, float]]] = {}
    for name, bind in rows:
        shape = known(PRESET + name)
        if shape is not None:
            groups.setdefault(shape, []).append(bind)
    return groups


def _expressions(document: Document, vrm: dict[str, Any]) -> Iterator[tuple[str, tuple[int, int, float]]]:
    expressions = vrm.get("expressions")
    kinds = expressions if isinstance(expressions, dict) else {}
    for kind in ("preset", "custom"):
        rows = kinds.get(kind)
        for name, row in (rows if isinstance(rows, dict) else {}).items():
            for bind in _binds(document, row, "morphTargetBinds", name):
                node = document.item("nodes", bind.get("node"), f"expressions.{name}"[:60])
                yield name, _bind(document, node.get("mesh"), bind, 1.0, name)


def _blend_shapes(document: Document, vrm: dict[str, Any]) -> Iterator[tuple[str, tuple[int, int, float]]]:
    master = vrm.get("blendShapeMaster")
    groups = master.get("blendShapeGroups") if isinstance(master, dict) else None
    for row in groups if isinstance(groups, list) else []:
        if not isinstance(row, dict):
            continue
        preset = str(row.get("presetName", "")).lower()
        name = preset if preset not in ("", "unknown") else str(row.get("name", ""))
        for bind in _binds(document, row, "binds", name):
            yield name, _bind(document, bind.get("mesh"), bind, 100.0, name)


def _binds(document: Document, row: Any, key: str, name: str) -> Iterator[dict[str, Any]]:
    if isinstance(row, dict) and key in row:
        for bind in document.sequence(row, key, MAX_BINDS, f"expressions.{name}"[:60]):
            if isinstance(bind, dict):
                yield bind


def _bind(
    document: Document, mesh: Any, bind: dict[str, Any], full: float, name: str
) -> tuple[int, int, float]:
    place = f"expressions.{name}"[:60]
    document.item("meshes", mesh, place)
    target = document.integer(bind.get("index"), 0, MAX_BINDS, place + ".index")
    return mesh, target, document.number(bind.get("weight", full), place + ".weight") / full
