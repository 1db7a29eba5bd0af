"""The nodes of a glTF scene: who hangs on whom, and where they stand at rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fapstream.head.document import Document

MAX_NODES = 1 << 12

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Node:
    """`world` (4, 4) takes the node's own coordinates to the scene's, at rest; `parent` is a number."""

    name: str
    parent: int | None
    world: Array


def read_nodes(document: Document) -> list[Node]:
    """All nodes with their transforms; a node has one parent at most, and none is its own ancestor."""
    rows = document.sequence(document.document, "nodes", MAX_NODES)
    parents: dict[int, int] = {}
    for i, row in enumerate(rows):
        if not isinstance(row, dict):
            document.fail(f"nodes[{i}]", "is not an object")
        children = row.get("children", [])
        if not isinstance(children, list):
            document.fail(f"nodes[{i}].children", "is not a list")
        for child in children:
            child = document.integer(child, 0, len(rows) - 1, f"nodes[{i}].children")
            if child in parents:
                document.fail(f"nodes[{child}]", f"is a child of nodes[{parents[child]}] and of nodes[{i}]")
            parents[child] = i
    worlds: dict[int, Array] = {}
    queue = [i for i in range(len(rows)) if i not in parents]
    for i in queue:
        own = _local(document, rows[i], f"nodes[{i}]")
        with np.errstate(all="ignore"):
            worlds[i] = worlds[parents[i]] @ own if i in parents else own
        queue += rows[i].get("children", [])
    if len(worlds) < len(rows):
        document.fail("nodes", f"nodes[{min(set(range(len(rows))) - set(worlds))}] is its own ancestor")
    if not all(np.abs(world).max() < 1e9 for world in worlds.values()):
        document.fail("nodes", "their transforms grow without bounds")
    return [Node(str(row.get("name", "")), parents.get(i), worlds[i]) for i, row in enumerate(rows)]


def _local(document: Document, node: dict[str, Any], place: str) -> Array:
    if "matrix" in node:
        return np.array(document.vector(node["matrix"], 16, place + ".matrix")).reshape(4, 4).T
    x, y, z, w = document.vector(node.get("rotation", [0, 0, 0, 1]), 4, place + ".rotation")
    size = float(np.sqrt(x * x + y * y + z * z + w * w))
    if size < 1e-9:
        document.fail(place + ".rotation", "is no quaternion")
    x, y, z, w = x / size, y / size, z / size, w / size
    matrix = np.eye(4)
    matrix[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    matrix[:3, :3] *= document.vector(node.get("scale", [1, 1, 1]), 3, place + ".scale")
    matrix[:3, 3] = document.vector(node.get("translation", [0, 0, 0]), 3, place + ".translation")
    return matrix


def subtree(nodes: list[Node], top: int) -> set[int]:
    """A node and everything that hangs on it."""
    found = {top}
    for i in range(len(nodes)):
        trail = []
        at: int | None = i
        while at is not None and at not in found:
            trail.append(at)
            at = nodes[at].parent
        if at is not None:
            found.update(trail)
    return found
