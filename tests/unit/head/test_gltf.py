"""read_head refuses what protocol/HEAD.md does not allow, and says where."""

import contextlib
import copy
import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.errors import DataError
from fapstream.head.document import split_glb
from fapstream.head.gltf import read_head

SMALL = (Path(__file__).parents[3] / "protocol/vectors/deform/small.glb").read_bytes()
DOCUMENT, BINARY = split_glb(SMALL, "small.glb")


def packed(document: Any, binary: bytes = BINARY) -> bytes:
    text = document if isinstance(document, bytes) else json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = (
        struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    )
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def test_the_small_head_is_read() -> None:
    head = read_head(packed(DOCUMENT))
    assert head.name == "vectors"
    assert head.part("skin").positions.shape == (4, 3)
    assert head.fat[0].knots == (100, 200)
    assert head.fapu.mns0 == 0.02
    assert head.turns[1].parts is None


def test_parts_that_name_one_material_share_it() -> None:
    document = copy.deepcopy(DOCUMENT)
    meshes = [document["meshes"][node["mesh"]] for node in document["nodes"] if "mesh" in node]
    for mesh in meshes:
        mesh["primitives"][0]["material"] = 0
    parts = read_head(packed(document)).parts
    assert len(parts) > 1
    assert all(part.material is parts[0].material for part in parts)


BROKEN: dict[str, tuple[Callable[[dict[str, Any]], Any], str]] = {
    "version": (lambda d: d["extras"]["fapstream"].update(version=2), "extras.fapstream.version"),
    "no extras": (lambda d: d.pop("extras"), "extras"),
    "part missing": (lambda d: d["nodes"][0].update(name="mask"), "'skin' is missing"),
    "part twice": (lambda d: d["nodes"][1].update(name="skin"), r"nodes\[1\]"),
    "transform": (lambda d: d["nodes"][0].update(translation=[1, 0, 0]), r"nodes\[0\]: has a transform"),
    "count": (lambda d: d["accessors"][0].update(count=10**9), "count"),
    "view": (lambda d: d["bufferViews"][0].update(byteLength=10**7), "ends at"),
    "view negative": (lambda d: d["bufferViews"][0].update(byteOffset=-4), "integer"),
    "stride": (lambda d: d["bufferViews"][0].update(byteStride=64), r"POSITION: needs"),
    "zero knot": (lambda d: d["extras"]["fapstream"]["fat"][0].update(knots=[0, 200]), r"fat\[0\]: knots"),
    "knots near": (lambda d: d["extras"]["fapstream"]["fat"][0].update(knots=[-1e-9, 9]), r"fat\[0\]: knots"),
    "knots nearer": (lambda d: d["extras"]["fapstream"]["fat"][0].update(knots=[9, 9.0000001]), "knots"),
    "knots down": (lambda d: d["extras"]["fapstream"]["fat"][0].update(knots=[200, 100]), r"fat\[0\]: knots"),
    "knots many": (lambda d: d["extras"]["fapstream"]["fat"][0].update(knots=[1, 2, 3]), "deltas"),
    "fap 1": (lambda d: d["extras"]["fapstream"]["fat"][0].update(fap=1), r"fat\[0\].fap"),
    "fap true": (lambda d: d["extras"]["fapstream"]["fat"][0].update(fap=True), r"fat\[0\].fap"),
    "drive fap": (lambda d: d["extras"]["fapstream"]["fat"][4].update(drive={"2": 1}), r"fat\[4\].drive"),
    "drive name": (lambda d: d["extras"]["fapstream"]["fat"][4].update(drive={"jaw": 1}), r"fat\[4\].drive"),
    "drive empty": (lambda d: d["extras"]["fapstream"]["fat"][4].update(drive={}), r"fat\[4\].drive"),
    "drive twice": (lambda d: d["extras"]["fapstream"]["fat"][4].update(drive={"3": 1, "03": 1}), "drive"),
    "drive inf": (lambda d: d["extras"]["fapstream"]["fat"][4].update(drive={"3": 1e300}), "drive"),
    "repeat": (lambda d: d["materials"][0].update(normalTexture={"index": 0, "extensions":
               {"KHR_texture_transform": {"scale": [1, 2]}}}), "normalTexture"),
    "scale nan": (lambda d: d["extras"]["fapstream"]["fat"][0].update(scale=1e300), "scale"),
    "fat part": (lambda d: d["extras"]["fapstream"]["fat"][0].update(part="hat"), "no part 'hat'"),
    "fat vertex": (lambda d: d["extras"]["fapstream"]["fat"][2].update(part="eye_l"), "vertex"),
    "axis zero": (lambda d: d["extras"]["fapstream"]["turns"][0].update(axes=[[0, 0, 0], [1, 0, 0]]), "axis"),
    "axes few": (lambda d: d["extras"]["fapstream"]["turns"][0].update(axes=[[0, 1, 0]]), "axis"),
    "fapu": (lambda d: d["extras"]["fapstream"]["fapu"].update(MW0=0), "fapu.MW0"),
    "fdp": (lambda d: d["extras"]["fapstream"]["fdp"].update({"3.5": [0, "x", 0]}), r"fdp\[3.5\]"),
    "camera": (lambda d: d["extras"]["fapstream"].pop("camera"), "camera"),
}  # fmt: skip


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_is_refused_with_the_place(name: str) -> None:
    change, place = BROKEN[name]
    document = copy.deepcopy(DOCUMENT)
    change(document)
    with pytest.raises(DataError, match=rf"bad\.glb: .*{place}"):
        read_head(packed(document), "bad.glb")


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"glTF",
        SMALL[:-4],
        b"X" + SMALL[1:],
        packed(b"[1, 2]"),
        packed(b"{"),
        packed(b'{"asset": NaN}'),
        packed(b'{"asset": "\xff"}'),
        packed(b"[" * 100000),
        packed({}),
    ],
    ids=["empty", "short", "cut", "magic", "array", "json", "NaN", "no UTF-8", "deep", "nothing"],
)
def test_what_is_no_head_is_refused(data: bytes) -> None:
    with pytest.raises(DataError, match=r"bad\.glb"):
        read_head(data, "bad.glb")


@settings(max_examples=300, deadline=None)
@given(st.data())
def test_damage_never_raises_anything_else(data: st.DataObject) -> None:
    broken = bytearray(SMALL)
    for _ in range(data.draw(st.integers(1, 6))):
        broken[data.draw(st.integers(12, len(SMALL) - 1))] = data.draw(st.integers(0, 255))
    with contextlib.suppress(DataError):
        read_head(bytes(broken), "bad.glb")
