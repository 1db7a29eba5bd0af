"""The drawn shapes agree with deform, whatever was shown before."""

import json
from pathlib import Path

import numpy as np
import pytest

from fapstream.head.deform import deform
from fapstream.head.deformer import Deformer, head_turn
from fapstream.head.gltf import read_head
from tests.unit.head.packaged import packaged

GENERIC = packaged()
VECTORS = Path(__file__).parents[3] / "protocol/vectors/deform"
DATA = json.loads((VECTORS / "small.json").read_text(encoding="utf-8"))
SMALL = read_head((VECTORS / DATA["head"]).read_bytes(), DATA["head"])


def frame(faps: dict[int, int]) -> np.ndarray:
    values = np.zeros(68, np.int16)
    for fap, value in faps.items():
        values[fap - 1] = value
    return values


def random_frames(n: int) -> np.ndarray:
    rng = np.random.default_rng(5)
    frames = rng.integers(-400, 400, (n, 68)) * rng.integers(0, 2, (n, 68))
    frames[:, 47:50] *= 20
    return frames.astype(np.int16)


@pytest.mark.parametrize("case", DATA["cases"], ids=lambda case: case["name"])
def test_the_vectors(case: dict) -> None:
    deformer = Deformer(SMALL)
    deformer.apply(frame({int(fap): value for fap, value in case["faps"].items()}))
    for shape in deformer.shapes:
        if shape.part.name in case["positions"]:
            expected = case["positions"][shape.part.name]
            np.testing.assert_allclose(shape.positions, expected, rtol=0, atol=DATA["tolerance_m"])


def test_it_is_deform_whatever_was_shown_before() -> None:
    deformer = Deformer(GENERIC)
    for values in random_frames(6):
        deformer.apply(values)
        expected = deform(GENERIC, values)
        for shape in deformer.shapes:
            np.testing.assert_allclose(shape.positions, expected[shape.part.name], rtol=0, atol=1e-7)


def test_back_at_rest_it_is_the_file_and_says_what_moved() -> None:
    deformer = Deformer(GENERIC)
    arrays = [(shape.positions, shape.normals) for shape in deformer.shapes]
    deformer.apply(frame({5: -200}))
    assert "skin" in deformer.moved
    assert "hair" not in deformer.moved
    deformer.apply(frame({}))
    assert "skin" in deformer.moved, "it went back"
    for shape, (positions, normals) in zip(deformer.shapes, arrays, strict=True):
        assert shape.positions is positions
        assert shape.normals is normals
        np.testing.assert_array_equal(positions, shape.part.positions)
    deformer.apply(frame({}))
    assert not deformer.moved


def test_normals_turn_with_the_head() -> None:
    deformer = Deformer(GENERIC)
    hair = next(shape for shape in deformer.shapes if shape.part.name == "hair")
    before = hair.normals.copy()
    deformer.apply(frame({49: 30_000}))
    turn = head_turn(GENERIC, frame({49: 30_000}))
    np.testing.assert_allclose(hair.normals, before @ turn[:3, :3].T, atol=1e-5)


def test_the_turn_of_the_head_is_that_of_parts_that_turn_fully() -> None:
    values = frame({48: 9000, 49: -20_000, 50: 4000})
    hair = deform(GENERIC, values)["hair"]
    turn = head_turn(GENERIC, values)
    rest = GENERIC.part("hair").positions
    np.testing.assert_allclose(rest @ turn[:3, :3].T + turn[:3, 3], hair, atol=1e-6)
    np.testing.assert_array_equal(head_turn(GENERIC, frame({23: 9000})), np.eye(4))
