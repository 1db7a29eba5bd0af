"""VRM 0 and 1: bones and expressions."""

from typing import Any

import pytest

from fapstream.errors import DataError
from fapstream.head.document import Document
from fapstream.head.vrm import Vrm, read_vrm


def vrm(**extensions: Any) -> Vrm:
    rows = {"nodes": [{}, {"mesh": 1}, {}], "meshes": [{}, {}], "extensions": extensions}
    return read_vrm(Document({"asset": {"version": "2.0"}, **rows}, b"", "x.vrm"))


def new(**expressions: Any) -> dict[str, Any]:
    return {"humanoid": {"humanBones": {"head": {"node": 2}}}, "expressions": expressions}


def old(*groups: Any) -> dict[str, Any]:
    bones = [{"bone": "head", "node": 2}, {"bone": "leftEye", "node": 0}]
    return {"humanoid": {"humanBones": bones}, "blendShapeMaster": {"blendShapeGroups": list(groups)}}


def test_vrm_1() -> None:
    bind = {"node": 1, "index": 3, "weight": 0.8}
    found = vrm(
        VRMC_vrm=new(
            preset={"aa": {"morphTargetBinds": [bind]}}, custom={"JawOpen": {"morphTargetBinds": [bind]}}
        )
    )
    assert found == Vrm({"head": 2}, {"viseme_aa": [(1, 3, 0.8)], "jawOpen": [(1, 3, 0.8)]}, False)


def test_vrm_0() -> None:
    bind = {"mesh": 0, "index": 5, "weight": 50}
    names = (("A", "a"), ("x", "blink_l"), ("MouthSmileLeft", "unknown"), ("Neutral", "neutral"))
    found = vrm(VRM=old(*({"name": name, "presetName": preset, "binds": [bind]} for name, preset in names)))
    assert found.bones == {"head": 2, "leftEye": 0}
    assert found.groups == {name: [(0, 5, 0.5)] for name in ("viseme_aa", "eyeBlinkLeft", "mouthSmileLeft")}
    assert found.backwards


def test_no_vrm() -> None:
    assert vrm() == Vrm({}, {}, False)
    assert vrm(VRM=3, VRMC_vrm=[]) == Vrm({}, {}, False)


@pytest.mark.parametrize(
    "extension",
    [
        {"VRM": old({"presetName": "a", "binds": [{"mesh": 9, "index": 0}]})},
        {"VRM": old({"presetName": "a", "binds": [{"mesh": 0, "index": "x"}]})},
        {"VRM": old({"presetName": "a", "binds": 7})},
        {"VRM": {"humanoid": {"humanBones": [{"bone": "head", "node": 99}]}}},
        {"VRMC_vrm": new(preset={"aa": {"morphTargetBinds": [{"node": 0, "index": 0}]}})},
        {"VRMC_vrm": new(preset={"aa": {"morphTargetBinds": [{"node": 1, "index": 0, "weight": 1e300}]}})},
    ],
)
def test_what_leads_nowhere_is_refused(extension: dict[str, Any]) -> None:
    with pytest.raises(DataError, match=r"x\.vrm: (humanBones|expressions)"):
        vrm(**extension)


@pytest.mark.parametrize(
    "junk",
    [
        {"humanoid": 3},
        {"humanoid": {"humanBones": 3}},
        {"expressions": []},
        {"blendShapeMaster": {"blendShapeGroups": [3, {"binds": [3]}]}},
    ],
)
def test_junk_says_nothing(junk: dict[str, Any]) -> None:
    assert vrm(VRM=junk).groups == vrm(VRMC_vrm=junk).groups == {}
