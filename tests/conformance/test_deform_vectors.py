"""protocol/vectors/deform in Python; the TypeScript client runs the same file."""

import json
from pathlib import Path

import numpy as np
import pytest

from fapstream.head.deform import deform
from fapstream.head.gltf import read_head

VECTORS = Path(__file__).parents[2] / "protocol/vectors/deform"
DATA = json.loads((VECTORS / "small.json").read_text(encoding="utf-8"))
HEAD = read_head((VECTORS / DATA["head"]).read_bytes(), DATA["head"])


@pytest.mark.parametrize("case", DATA["cases"], ids=lambda case: case["name"])
def test_vertices_go_where_the_vectors_say(case: dict) -> None:
    values = np.zeros(68, np.int16)
    for fap, value in case["faps"].items():
        values[int(fap) - 1] = value
    positions = deform(HEAD, values)
    for part, expected in case["positions"].items():
        np.testing.assert_allclose(positions[part], expected, rtol=0, atol=DATA["tolerance_m"])
