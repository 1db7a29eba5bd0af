"""Exports, by a reader of a few lines that knows glTF and nothing of ours."""

import json
import struct
from typing import Any

import numpy as np
import pytest

from fapstream.fap.tables import expressions, visemes
from fapstream.head.deform import deform
from fapstream.head.export import arkit_targets, export_shapes, export_talk, fap_targets
from fapstream.head.gltf import read_head
from fapstream.head.mesh import Head
from fapstream.head.shapes import arkit, oculus
from tests.unit.head.packaged import packaged

GENERIC = packaged()
TYPES = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
FPS = 25.0


def talk() -> np.ndarray:
    """Visemes, an expression, glances and nods."""
    frames = np.stack([visemes()[k] for k in (0, 1, 10, 14, 2, 7, 12)]).astype(np.int32)
    frames[3:5] += expressions()["joy"].astype(np.int32)
    frames[:, [22, 23, 24, 25]] = np.linspace(-20000, 15000, 7)[:, None]
    frames[:, [47, 48, 49]] = np.linspace(12000, -24000, 7)[:, None] * (1, -0.7, 0.4)
    frames[2:4, 18:20] = 700
    return frames


class File:
    """A GLB, decoded plainly."""

    def __init__(self, data: bytes) -> None:
        size = struct.unpack_from("<I", data, 12)[0]
        self.json: dict[str, Any] = json.loads(data[20 : 20 + size])
        self.binary = data[28 + size :]

    def view(self, index: int, dtype: str, count: int) -> np.ndarray:
        return np.frombuffer(self.binary, dtype, count, self.json["bufferViews"][index]["byteOffset"])

    def accessor(self, index: int) -> np.ndarray:
        row = self.json["accessors"][index]
        width, dtype = WIDTHS[row["type"]], TYPES[row["componentType"]]
        values = np.zeros(row["count"] * width, dtype)
        if "bufferView" in row:
            values = self.view(row["bufferView"], dtype, len(values)).copy()
        values = values.reshape(-1, width)
        if sparse := row.get("sparse"):
            at = self.view(
                sparse["indices"]["bufferView"], TYPES[sparse["indices"]["componentType"]], sparse["count"]
            )
            new = self.view(sparse["values"]["bufferView"], dtype, sparse["count"] * width)
            values[at] = new.reshape(-1, width)
            assert (np.diff(at.astype(int)) > 0).all()
        return values

    def targets(self, node: dict[str, Any]) -> tuple[list[str], list[np.ndarray]]:
        mesh = self.json["meshes"][node["mesh"]]
        rows = mesh["primitives"][0].get("targets", [])
        return mesh.get("extras", {}).get("targetNames", []), [self.accessor(row["POSITION"]) for row in rows]

    def track(self, node: int, path: str) -> np.ndarray | None:
        (animation,) = self.json["animations"]
        for channel in animation["channels"]:
            if channel["target"] == {"node": node, "path": path}:
                return self.accessor(animation["samplers"][channel["sampler"]]["output"])
        return None

    def world(self, node: int, frame: int) -> np.ndarray:
        rows = self.json["nodes"]
        matrix = np.eye(4)
        matrix[:3, 3] = rows[node].get("translation", [0, 0, 0])
        if (track := self.track(node, "rotation")) is not None:
            x, y, z, w = track[frame].astype(float)
            matrix[:3, :3] = [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        parent = next((i for i, row in enumerate(rows) if node in row.get("children", [])), None)
        return matrix if parent is None else self.world(parent, frame) @ matrix

    def posed(self, node: int, frame: int) -> np.ndarray:
        """Vertices of a skinned, morphed mesh (glTF 2.0, 3.7.2.2 and 3.7.3.3)."""
        row = self.json["nodes"][node]
        attributes = self.json["meshes"][row["mesh"]]["primitives"][0]["attributes"]
        points = self.accessor(attributes["POSITION"]).astype(float)
        names, targets = self.targets(row)
        track = self.track(node, "weights")
        weights = np.zeros(len(names)) if track is None else track.reshape(-1, len(names))[frame]
        for weight, target in zip(weights, targets, strict=True):
            points = points + float(weight) * target
        skin = self.json["skins"][row["skin"]]
        bind = self.accessor(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
        joints = np.stack(
            [self.world(joint, frame) @ b for joint, b in zip(skin["joints"], bind, strict=True)]
        )
        chosen, shares = self.accessor(attributes["JOINTS_0"]), self.accessor(attributes["WEIGHTS_0"])
        blend = np.einsum("nk,nkij->nij", shares, joints[chosen])
        return np.einsum("nij,nj->ni", blend[:, :3, :3], points) + blend[:, :3, 3]


@pytest.fixture(scope="module")
def shapes() -> File:
    return File(export_shapes(GENERIC))


def test_every_shape_is_there_by_its_name(shapes: File) -> None:
    found = {name for mesh in shapes.json["meshes"] for name in mesh.get("extras", {}).get("targetNames", [])}
    still = {"viseme_sil"}
    assert found == (set(arkit()) | set(oculus())) - still


@pytest.mark.parametrize(
    "name", ["jawOpen", "mouthSmileLeft", "eyeBlinkRight", "eyeLookInLeft", "viseme_U", "tongueOut"]
)
def test_a_target_is_what_deform_does(shapes: File, name: str) -> None:
    values = (arkit() | oculus())[name]
    moved = deform(GENERIC, values)
    for node in shapes.json["nodes"]:
        if "mesh" in node:
            names, targets = shapes.targets(node)
            rest = GENERIC.part(node["name"]).positions
            got = targets[names.index(name)] if name in names else np.zeros_like(rest)
            np.testing.assert_allclose(got, moved[node["name"]] - rest, atol=2e-6)


def test_normals_have_unit_length(shapes: File) -> None:
    for mesh in shapes.json["meshes"]:
        normals = shapes.accessor(mesh["primitives"][0]["attributes"]["NORMAL"])
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)


def test_eyes_have_looks_and_jaws_have_teeth() -> None:
    moves = {target.name: set(target.moves) for target in arkit_targets(GENERIC)}
    assert "eye_l" in moves["eyeLookUpLeft"]
    assert "eye_r" not in moves["eyeLookUpLeft"]
    assert {"skin", "teeth_lower", "tongue"} <= moves["jawOpen"]
    assert "teeth_upper" not in moves["jawOpen"]


@pytest.mark.parametrize("frame", range(7))
def test_a_talk_is_played_exactly(frame: int) -> None:
    """Within 3 micrometres of deform, in every part, at every frame."""
    file, frames = File(export_talk(GENERIC, talk(), FPS)), talk()
    moved = deform(GENERIC, frames[frame].astype(float))
    for index, node in enumerate(file.json["nodes"]):
        if "mesh" in node:
            np.testing.assert_allclose(file.posed(index, frame), moved[node["name"]], atol=3e-6)


def test_the_clock_of_a_talk() -> None:
    file = File(export_talk(GENERIC, talk(), FPS))
    for sampler in file.json["animations"][0]["samplers"]:
        np.testing.assert_allclose(file.accessor(sampler["input"])[:, 0], np.arange(8) / FPS, atol=1e-7)


def test_a_talk_in_arkit_shapes_is_near() -> None:
    """Speech within 5 mm at the worst vertex and 1.5 mm rms; a smile, whose shape lifts lips, less near."""
    file, frames = File(export_talk(GENERIC, talk(), FPS, shapes=True)), talk()
    index = next(i for i, node in enumerate(file.json["nodes"]) if node["name"] == "skin")
    names, _ = file.targets(file.json["nodes"][index])
    assert set(names) <= set(arkit())
    for frame in range(7):
        wanted = deform(GENERIC, frames[frame].astype(float))["skin"]
        error = np.linalg.norm(file.posed(index, frame) - wanted, axis=1)
        smiling = 3 <= frame < 5
        assert error.max() < (15e-3 if smiling else 5e-3)
        assert np.sqrt((error**2).mean()) < (5e-3 if smiling else 1.5e-3)


def test_the_tables_are_kept_if_asked_for() -> None:
    again = read_head(export_shapes(GENERIC, keep=True), "kept.glb")
    assert len(again.fat) == len(GENERIC.fat)
    assert "extras" not in File(export_shapes(GENERIC)).json


def test_only_what_is_used_becomes_a_target() -> None:
    frames = np.zeros((3, 68))
    frames[1, 4] = -100
    targets, weights = fap_targets(GENERIC, frames)
    assert all(target.name.startswith("raise_b_midlip") for target in targets)
    assert all(row[0] == 0 and row[2] == 0 for row in weights.values())
    still: Head = GENERIC
    assert "animations" not in File(export_talk(still, np.zeros((2, 68), np.int32), FPS)).json
