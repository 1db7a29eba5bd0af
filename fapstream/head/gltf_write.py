"""A Head to the bytes of a GLB file (protocol/HEAD.md)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fapstream.head.glb_writer import GlbWriter, narrow, short, short_list
from fapstream.head.gltf import VERSION
from fapstream.head.mesh import FatEntry, Head, Part, Turn


def write_head(head: Head) -> bytes:
    """The file `read_head` gives `head` back from. Equal arrays are stored once."""
    writer = HeadWriter()
    for part in head.parts:
        writer.part(part)
    writer.extras(head)
    return writer.file()


class HeadWriter(GlbWriter):
    def extras(self, head: Head) -> None:
        """What makes the head move."""
        self.document["extras"] = {
            "fapstream": {
                "version": VERSION,
                "name": head.name,
                "fapu": {name: short(value) for name, value in head.fapu.as_dict().items()},
                "fdp": {name: short_list(point) for name, point in head.fdp.items()},
                "mouth": {"center": short_list(head.mouth.center), "size": short_list(head.mouth.size)},
                "camera": {"target": short_list(head.camera.target), "height": short(head.camera.height)},
                "fat": [self.fat(entry) for entry in head.fat],
                "turns": [self.turn(turn) for turn in head.turns],
            }
        }

    def part(self, part: Part) -> None:
        """One node with one mesh."""
        number = self.add("meshes", {"name": part.name, "primitives": [self.primitive(part)]})
        self.document["scenes"][0]["nodes"].append(self.add("nodes", {"name": part.name, "mesh": number}))

    def fat(self, entry: FatEntry) -> dict[str, Any]:
        simple = len(entry.drive) == 1 and entry.drive[0][1] == 1
        drive = {"fap": entry.faps[0]} if simple else {"drive": {str(fap): c for fap, c in entry.drive}}
        return {
            **drive,
            "part": entry.part,
            "knots": [int(knot) if knot == int(knot) else knot for knot in entry.knots],
            "scale": entry.scale,
            "indices": self.array(narrow(entry.indices[:, None])),
            "deltas": self.array(entry.deltas.reshape(-1, 3)),
        }

    def turn(self, turn: Turn) -> dict[str, Any]:
        row: dict[str, Any] = {
            "faps": list(turn.faps),
            "axes": [list(axis) for axis in turn.axes],
            "parts": "*" if turn.parts is None else list(turn.parts),
            "pivot": short_list(turn.pivot),
        }
        if turn.weights:
            row["weights"] = {name: self.array(_levels(w)) for name, w in turn.weights.items()}
        return row


def _levels(weights: NDArray[np.float32]) -> NDArray[Any]:
    """uint8 where that loses nothing, float32 otherwise; shape (n, 1)."""
    levels = np.rint(weights * 255)
    exact = np.array_equal((levels / np.float32(255)).astype(np.float32), weights)
    return levels.astype(np.uint8)[:, None] if exact else weights[:, None]
