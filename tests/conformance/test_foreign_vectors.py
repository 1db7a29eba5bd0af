"""protocol/vectors/foreign, and the talk in deform, in Python; the TypeScript client runs the same files."""

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

from fapstream.head.deform import deform
from fapstream.head.foreign import read_foreign

ROOT = Path(__file__).parents[2]
VECTORS = ROOT / "protocol/vectors/foreign"
DATA = json.loads((VECTORS / "avatar.json").read_text(encoding="utf-8"))
IMPORTED = read_foreign((VECTORS / DATA["head"]).read_bytes(), DATA["head"], "avatar")


def test_parts_and_warnings() -> None:
    assert [part.name for part in IMPORTED.head.parts] == DATA["parts"]
    assert list(IMPORTED.warnings()) == DATA["warnings"]


@pytest.mark.parametrize("case", DATA["cases"], ids=lambda case: case["name"])
def test_vertices_go_where_the_vectors_say(case: dict) -> None:
    values = np.zeros(68, np.int16)
    for fap, value in case["faps"].items():
        values[int(fap) - 1] = value
    positions = deform(IMPORTED.head, values)
    for part, expected in case["positions"].items():
        found = positions[part][case["vertices"][part]]
        np.testing.assert_allclose(found, expected, rtol=0, atol=DATA["tolerance_m"])


@pytest.mark.parametrize("name", ["small.glb", "talk.glb"])
def test_the_deform_vectors_are_those_that_the_tool_writes(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    spec = importlib.util.spec_from_file_location("tool", ROOT / "tools/build_deform_vectors.py")
    assert spec
    assert spec.loader
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    monkeypatch.setattr(tool, "OUT", tmp_path)
    tool.main()
    assert (tmp_path / name).read_bytes() == (ROOT / "protocol/vectors/deform" / name).read_bytes()
    assert (tmp_path / "small.json").read_text() == (ROOT / "protocol/vectors/deform/small.json").read_text()
