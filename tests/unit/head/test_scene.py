"""Scenes at rest: what stands in the file in many ways comes out as the same mesh."""

import numpy as np
import pytest

from fapstream.errors import DataError
from fapstream.head.document import split_glb
from fapstream.head.glb_writer import GlbWriter
from fapstream.head.scene import Scene, Surface
from tests.unit.head.avatars import avatar, changed, moved, push, sheet

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [9, 9, 9]], np.float32)
FACES = np.array([[0], [1], [2], [0], [2], [3]], np.uint16)


def read(data: bytes, wanted: object = None) -> list[Surface]:
    return Scene(*split_glb(data, "x.glb"), "x.glb").surfaces(wanted or {})


def square(node: dict | None = None, **primitive: object) -> bytes:
    writer = GlbWriter()
    mesh = {"attributes": {"POSITION": writer.array(SQUARE)}, "indices": writer.array(FACES), **primitive}
    writer.add("meshes", {"name": "m", "primitives": [mesh]})
    writer.add("nodes", {"name": "n", "mesh": 0, **(node or {})})
    return writer.file()


def test_unused_vertices_are_left_out_and_the_node_is_worked_in() -> None:
    (surface,) = read(square({"scale": [2, 2, 2], "translation": [0, 0, 1]}))
    np.testing.assert_allclose(surface.positions, SQUARE[:4] * 2 + (0, 0, 1))
    np.testing.assert_array_equal(surface.triangles, FACES.reshape(-1, 3))
    assert surface.names == ("plain", "m", "n")


def test_a_mirrored_node_turns_the_triangles_round() -> None:
    (surface,) = read(square({"scale": [-1, 1, 1]}))
    np.testing.assert_array_equal(surface.triangles, FACES.reshape(-1, 3)[:, ::-1])


def test_triangles_need_no_indices() -> None:
    writer = GlbWriter()
    writer.add("meshes", {"primitives": [{"attributes": {"POSITION": writer.array(SQUARE[:3])}}]})
    writer.add("nodes", {"mesh": 0})
    (surface,) = read(writer.file())
    np.testing.assert_array_equal(surface.triangles, [[0, 1, 2]])


def skinned(weights: object = None, joints: object = None, bind: int = 2) -> bytes:
    """The square, quantised to a half of its size, on two bones: at rest, and raised by 10."""
    writer = GlbWriter()
    short = np.rint(SQUARE[:4] / 2 * 32767).astype(np.int16)
    position = writer.array(np.pad(short, ((0, 0), (0, 1))))
    writer.document["accessors"][position] |= {"type": "VEC3", "normalized": True}
    writer.document["bufferViews"][-1]["byteStride"] = 8
    chosen = np.array(joints or [[0, 1, 0, 0]] * 4, np.uint8)
    given = np.array(weights or [[1, 0, 0, 0], [0, 1, 0, 0], [0.5, 0.5, 0, 0], [0, 0, 0, 0]], np.float32)
    attributes = {"POSITION": position, "JOINTS_0": writer.array(chosen), "WEIGHTS_0": writer.array(given)}
    writer.add("meshes", {"primitives": [{"attributes": attributes, "indices": writer.array(FACES)}]})
    matrices = np.tile(np.diag([2, 2, 2, 1]).astype(np.float32), (bind, 1, 1)).reshape(-1, 16)
    writer.add("nodes", {"children": [1, 2], "translation": [0, 0, 5]})
    writer.add("nodes", {"name": "low"})
    writer.add("nodes", {"name": "high", "translation": [0, 10, 0]})
    writer.add("nodes", {"mesh": 0, "skin": 0, "translation": [77, 0, 0]})
    writer.add("skins", {"joints": [1, 2], "inverseBindMatrices": writer.array(matrices)})
    return writer.file()


def test_a_skin_blends_its_joints_and_forgets_its_own_node() -> None:
    (surface,) = read(skinned())
    raised = np.array([[0, 0, 5], [0, 10, 5], [0, 5, 5], [0, 0, 5]])
    np.testing.assert_allclose(surface.positions, SQUARE[:4] + raised, atol=1e-4)
    np.testing.assert_allclose(surface.hanging({2}), [0, 1, 0.5, 0])
    np.testing.assert_allclose(surface.hanging({1, 2}), 1)


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (skinned(joints=[[0, 2, 0, 0]] * 4), "a vertex hangs on joint 2"),
        (skinned(bind=1), "1 matrices for 2 joints"),
        (changed(skinned(), lambda d: d["skins"][0].update(joints=[])), "no joints"),
        (changed(skinned(), lambda d: d["skins"][0].update(joints=[1, 99])), "not an integer"),
        (
            changed(skinned(), lambda d: d["meshes"][0]["primitives"][0]["attributes"].pop("JOINTS_0")),
            "JOINTS_0",
        ),
        (square({"scale": [0, 1, 1]}), "flattens"),
        (square({"mesh": 4}), r"meshes\[4\]"),
        (square(targets=7), "targets"),
        (square(targets=[7]), "targets"),
        (changed(square(), lambda d: d.update(extensionsRequired=["KHR_draco_mesh_compression"])), "draco"),
        (changed(square(), lambda d: d.update(extensionsRequired=7)), "extensionsRequired"),
        (changed(square(), lambda d: d.update(meshes={})), "meshes"),
        (changed(square(), lambda d: d["meshes"][0].update(primitives=[3])), "primitives"),
        (changed(square(), lambda d: d["accessors"][1].update(count=5)), "triangles"),
    ],
)
def test_what_makes_no_mesh_is_refused(data: bytes, reason: str) -> None:
    with pytest.raises(DataError, match=rf"x\.glb: .*{reason}"):
        read(data)


def test_lines_are_left_out_with_a_note() -> None:
    scene = Scene(*split_glb(square(mode=1), "x.glb"), "x.glb")
    assert scene.surfaces({}) == []
    assert "not made of triangles" in scene.notes[0]


def test_a_picture_elsewhere_is_left_out_with_a_note() -> None:
    rows = {"materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
            "textures": [{"source": 0}], "images": [{"uri": "https://example.org/face.png"}]}  # fmt: skip
    scene = Scene(*split_glb(changed(square(material=0), lambda d: d.update(rows)), "x.glb"), "x.glb")
    assert scene.surfaces({})[0].material.texture is None
    assert "not embedded" in scene.notes[0]


def test_targets_move_what_they_are_named_for() -> None:
    data = avatar(["jawOpen", "mouthPucker"], scale=100)
    scene = Scene(*split_glb(data, "x.glb"), "x.glb")
    assert scene.target_names()[0] == ["jawOpen", "mouthPucker"]
    surfaces = scene.surfaces({(0, 1): {"pout": 1.0, "kiss": 0.5}})
    points, _ = sheet()
    np.testing.assert_allclose(surfaces[0].moves["pout"], 100 * push("mouthPucker", points), atol=1e-4)
    np.testing.assert_allclose(surfaces[0].moves["kiss"], 50 * push("mouthPucker", points), atol=1e-4)
    assert surfaces[0].moves["pout"].any(1).sum() == len(moved("mouthPucker"))
    assert "jawOpen" not in surfaces[0].moves
