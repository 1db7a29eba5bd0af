"""protocol/vectors/life.json: the idle face is the same in Python and TypeScript."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fapstream.motion import IdleLife, idle_face

CASES = json.loads((Path(__file__).parents[2] / "protocol/vectors/life.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("case", CASES, ids=lambda c: f"{c['seed']}-{c['mode']}")
def test_the_face_at_each_instant(case: dict[str, Any]) -> None:
    life = IdleLife(case["seed"], case["mode"])
    for t, expected in zip(case["times"], case["values"], strict=True):
        face = idle_face(life.at(t))
        moved = np.flatnonzero(face) + 1
        assert set(moved) <= set(case["faps"])
        assert face[np.array(case["faps"]) - 1] == pytest.approx(expected, abs=0.01)
