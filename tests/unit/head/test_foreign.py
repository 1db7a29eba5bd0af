"""Other people's heads as ours: what moves, by how much, what is missing, and what is refused."""

import contextlib
import copy
import time
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.errors import DataError
from fapstream.fap.tables import visemes
from fapstream.head.deform import deform
from fapstream.head.document import split_glb
from fapstream.head.foreign import _named, load_head, read_foreign
from fapstream.head.gltf import read_head
from fapstream.head.gltf_write import write_head
from fapstream.head.mesh import Head, Material
from fapstream.head.scene import Surface
from fapstream.head.shapes import arkit, oculus, strengths
from tests.unit.head.avatars import avatar, changed, packed, push, sheet

AVATAR = (Path(__file__).parents[3] / "protocol/vectors/foreign/avatar.glb").read_bytes()
POINTS, _ = sheet()


def moved(head: Head, values: np.ndarray, part: str = "skin") -> np.ndarray:
    return deform(head, values)[part] - head.part(part).positions


def frame(**values: int) -> np.ndarray:
    out = np.zeros(68, np.int16)
    for name, value in values.items():
        out[int(name[1:]) - 1] = value
    return out


@pytest.mark.parametrize("scale", [1.0, 100.0, 0.01], ids=["metres", "centimetres", "hundreds of metres"])
def test_shapes_move_the_face_as_their_drives_say(scale: float) -> None:
    imported = read_foreign(avatar(scale=scale), "x.glb", "someone")
    assert imported.warnings() == ()
    for viseme in (1, 2, 10, 14):
        rows = strengths(visemes()[viseme][None].astype(np.int32), [n for n in arkit() if "Look" not in n])
        expected = sum(weight[0] * push(name, POINTS) for name, weight in rows.items())
        np.testing.assert_allclose(moved(imported.head, visemes()[viseme]), expected, atol=6e-5)


def surface(name: str, vertices: int, far: float) -> Surface:
    """Of which jawOpen moves every vertex so far."""
    still = np.zeros((vertices, 3))
    move = np.full((vertices, 3), far, np.float32)
    return Surface(
        (name,), still, still, still[:, :2], np.zeros((1, 3), np.int64), Material(name), {"jawOpen": move},
        np.zeros((vertices, 1), np.int64), np.ones((vertices, 1)),
    )  # fmt: skip


def test_the_skin_is_what_most_vertices_move_of_not_what_moves_most() -> None:
    named = _named([surface("beard", 5, 0.03), surface("face", 20, 0.001)])
    assert named["skin"].names == ("face",)


def test_strengths_stay_between_0_and_1() -> None:
    head = read_foreign(avatar(["jawOpen"])).head
    np.testing.assert_allclose(moved(head, frame(f5=-5000)), push("jawOpen", POINTS), atol=3e-5)
    assert not moved(head, frame(f5=3000)).any()


def test_the_whole_stands_in_metres_round_the_top_of_the_spine() -> None:
    for scale in (1.0, 100.0):
        head = read_foreign(avatar(scale=scale)).head
        np.testing.assert_allclose(head.part("skin").positions, POINTS, atol=1e-5)
        assert head.turns[-1].pivot == (0.0, 0.0, 0.0)


def test_eyes_and_head_turn_by_their_bones() -> None:
    head = read_foreign(avatar()).head
    left = next(turn for turn in head.turns if turn.faps == (23, 25))
    np.testing.assert_allclose(left.pivot, (0.03, 0.035, 0.07), atol=1e-6)
    (eye,) = left.parts or ()
    assert moved(head, frame(f23=30000), eye)[:, 0].max() > 0
    assert not moved(head, frame(f23=30000)).any()
    assert moved(head, frame(f49=20000)).any()
    assert {turn.faps for turn in head.turns} == {(23, 25), (24, 26), (48, 49, 50)}


def test_eyes_without_bones_are_moved_by_their_shapes() -> None:
    head = read_foreign(avatar(rig=False)).head
    assert [turn.faps for turn in head.turns] == [(48, 49, 50)]
    assert moved(head, frame(f23=30000)).any()


def test_without_bones_the_neck_follows_smoothly() -> None:
    weights = read_foreign(avatar(rig=False)).head.turns[-1].weights["skin"]
    low, high = POINTS[:, 1].argmin(), POINTS[:, 1].argmax()
    assert weights[high] == 1
    assert weights[low] < 1


def test_missing_shapes_are_named_in_one_warning() -> None:
    (warning,) = read_foreign(avatar(set(arkit()) - {"mouthClose", "cheekPuff"}), "x", "Ann").warnings()
    assert warning == "Ann: shapes are missing: cheekPuff, mouthClose (jawOpen instead)"


def test_visemes_alone_make_a_talking_head() -> None:
    imported = read_foreign(avatar(list(oculus())))
    assert len(imported.plan.missing) > 40
    mouth = np.abs(POINTS[:, 1] + 0.07).argmin()
    assert moved(imported.head, visemes()[10])[:, 1].min() < -0.008
    assert abs(moved(imported.head, visemes()[1])[mouth, 1]) < 0.004


def vrm_1(mesh_node: int) -> dict[str, Any]:
    presets = {
        name: {"morphTargetBinds": [{"node": mesh_node, "index": k}]}
        for k, name in enumerate(["aa", "ou", "blink"])
    }
    return {
        "VRMC_vrm": {"expressions": {"preset": presets}, "humanoid": {"humanBones": {"head": {"node": 0}}}}
    }


SECRET = {"Fcl_01": "viseme_aa", "Fcl_02": "viseme_U", "Fcl_03": "blink"}


def test_vrm_1_by_its_presets() -> None:
    head = read_foreign(avatar(SECRET, **vrm_1(1)), "x.vrm").head
    assert moved(head, visemes()[10])[:, 1].min() < -0.008
    np.testing.assert_allclose(moved(head, frame(f19=1024, f20=1024)), push("blink", POINTS), atol=1e-4)


def test_vrm_0_looks_backwards() -> None:
    def turn(document: dict[str, Any]) -> None:
        document["nodes"][0]["rotation"] = [0, 1, 0, 0]
        groups = [
            {"presetName": p, "binds": [{"mesh": 0, "index": k, "weight": 100}]} for k, p in enumerate("au")
        ]
        document["extensions"] = {"VRM": {"blendShapeMaster": {"blendShapeGroups": groups}}}

    head = read_foreign(changed(avatar(SECRET), turn), "x.vrm").head
    np.testing.assert_allclose(head.part("skin").positions, POINTS, atol=1e-5)
    assert moved(head, visemes()[10])[:, 1].min() < -0.008


def test_the_avatar_that_knows_nothing_of_us_speaks() -> None:
    head, warnings = load_head(AVATAR, "avatar.glb", "avatar")
    assert len(warnings) == 1
    assert "cheekPuff" in warnings[0]
    assert "mouthDimpleLeft (mouthStretchLeft instead)" in warnings[0]
    assert {"skin", "eye_l", "eye_r", "teeth", "tongue", "hair"} <= {part.name for part in head.parts}
    opened = moved(head, visemes()[10])
    assert opened[:, 1].min() < -0.01
    eyes = moved(head, frame(f23=20000, f24=20000), "eye_l")
    assert eyes[:, 0].max() > 0.001
    rest = moved(head, frame(f48=15000))
    assert np.abs(rest).max() > 0.005


def test_an_imported_head_is_an_ordinary_head_file() -> None:
    head = read_foreign(AVATAR, "avatar.glb", "avatar").head
    again, warnings = load_head(write_head(head), "again.glb")
    assert warnings == ()
    for part, points in deform(head, visemes()[14]).items():
        np.testing.assert_allclose(deform(again, visemes()[14])[part], points, atol=2e-7)


def test_our_own_files_are_read_as_such() -> None:
    small = (Path(__file__).parents[3] / "protocol/vectors/deform/small.glb").read_bytes()
    assert load_head(small)[0].name == read_head(small).name


def test_a_file_without_face_shapes_says_what_is_looked_for() -> None:
    reason = r"x\.glb: .*no face shapes that open .*: .*Bulge, Dent.*jawOpen.*viseme_aa"
    with pytest.raises(DataError, match=reason):
        read_foreign(avatar({"Bulge": "cheekPuff", "Dent": "jawOpen"}), "x.glb")
    with pytest.raises(DataError, match="no named morph targets"):
        read_foreign(changed(avatar(), lambda d: d["meshes"][0].pop("extras")), "x.glb")


HOSTILE = {
    # found by fuzzing
    "targets null": lambda d: d["meshes"][0]["primitives"][0].update(targets=None),
    "mesh null": lambda d: d.update(meshes=[None, *d["meshes"][1:]]),
    "eyelids only": lambda d: d["meshes"][0]["extras"].update(targetNames=["blink"]),
    "all below the bust": lambda d: d["nodes"][1].update(translation=[0, -9, 0]),
    "displacement huge": lambda d: d["accessors"][2].update(componentType=5123),
    "node far": lambda d: d["nodes"][1].update(translation=[1e6, 0, 0]),
    # thought of
    "cycle": lambda d: d["nodes"][1].update(children=[0]),
    "huge count": lambda d: d["accessors"][0].update(count=1 << 31),
    "huge sparse": lambda d: d["accessors"][3].update(count=1 << 22),
    "no meshes": lambda d: d.update(meshes=[]),
    "nodes": lambda d: d.update(nodes=[{}] * 100_000),
    "far away": lambda d: d["nodes"][0].update(scale=[1e6] * 3),
    "mesh of nothing": lambda d: d["meshes"][0].update(primitives=[]),
    "targets of nothing": lambda d: d["meshes"][0]["primitives"][0].update(targets=[{}] * 52),
    "many primitives": lambda d: d["meshes"][0].update(primitives=d["meshes"][0]["primitives"] * 10_000),
    "many targets": lambda d: d["meshes"][0]["primitives"][0].update(
        targets=d["meshes"][0]["primitives"][0]["targets"] * 1000
    ),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_files_are_refused_in_little_memory(name: str) -> None:
    data = changed(avatar(), HOSTILE[name])
    tracemalloc.start()
    with contextlib.suppress(DataError):
        head = read_foreign(data, "bad.glb").head
        assert all(np.isfinite(part.positions).all() for part in head.parts)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 64 << 20


SMALL = avatar(["jawOpen", "mouthPucker", "eyeBlinkLeft"])


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_damage_never_raises_anything_else(data: st.DataObject) -> None:
    broken = bytearray(SMALL)
    for _ in range(data.draw(st.integers(1, 6))):
        broken[data.draw(st.integers(12, len(SMALL) - 1))] = data.draw(st.integers(0, 255))
    with contextlib.suppress(DataError):
        read_foreign(bytes(broken), "bad.glb")


LEAVES = st.one_of(st.none(), st.booleans(), st.integers(-3, 1 << 33), st.floats(), st.text(max_size=3),
                   st.just([]), st.just({}), st.just([0, 1, 2]))  # fmt: skip


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_a_document_changed_anywhere_never_raises_anything_else(data: st.DataObject) -> None:
    document, binary = split_glb(SMALL, "x")
    for _ in range(data.draw(st.integers(1, 3))):
        at: Any = document
        while isinstance(at, dict | list) and at:
            keys = list(at) if isinstance(at, dict) else list(range(len(at)))
            key = data.draw(st.sampled_from(keys))
            if not isinstance(at[key], dict | list) or data.draw(st.integers(0, 5)) == 0:
                at[key] = copy.deepcopy(data.draw(LEAVES))
                break
            at = at[key]
    with contextlib.suppress(DataError):
        read_foreign(packed(document, bytes(binary)), "bad.glb")


CORPUS = Path(__file__).with_name("corpus")


@pytest.mark.parametrize("path", sorted(CORPUS.glob("*.glb")), ids=lambda path: path.name)
def test_what_once_went_wrong_is_refused_in_no_time(path: Path) -> None:
    began = time.thread_time()
    with pytest.raises(DataError, match=path.name):
        load_head(path.read_bytes(), path.name)
    assert time.thread_time() - began < 1
