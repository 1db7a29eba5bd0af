"""protocol/vectors/jitter.json, stretch.json: store and stretch are the same in Python and TypeScript."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fapstream.stream import stretch
from fapstream.stream.jitter import Jitter

VECTORS = Path(__file__).parents[2] / "protocol/vectors"
PATTERNS = json.loads((VECTORS / "jitter.json").read_text(encoding="utf-8"))
SOUNDS = json.loads((VECTORS / "stretch.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("case", PATTERNS, ids=lambda c: c["pattern"])
def test_the_target_after_each_step(case: dict[str, Any]) -> None:
    jitter, targets = Jitter(), []
    verbs = {
        "packet": jitter.observe,
        "underrun": jitter.underrun,
        "restart": jitter.restart,
        "ease": jitter.ease,
    }
    for name, *times in case["steps"]:
        verbs[name](*times)
        targets.append(jitter.target_s)
    assert targets == pytest.approx(case["targets"], abs=1e-6)


@pytest.mark.parametrize("case", SOUNDS, ids=lambda c: f"{c['rate']} {c['way']}")
def test_the_period_and_how_it_dies_away(case: dict[str, Any]) -> None:
    sound = np.array(case["pcm"]["i16"]) / 32_768
    lag, alike = stretch.period(sound, case["at"], case["way"], case["rate"])
    assert (lag, alike) == (case["lag"], pytest.approx(case["alike"], abs=1e-6))
    fall = stretch.fall(sound, case["rate"], 0.04)
    assert fall[::16] == pytest.approx(case["fall"], abs=1e-6)
