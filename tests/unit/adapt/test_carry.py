"""A head through a warp."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.adapt.carry import carry
from fapstream.adapt.rigid import Similarity
from fapstream.adapt.warp import Chain
from fapstream.fap import visemes
from fapstream.head.deform import deform
from fapstream.head.fapu import measure
from fapstream.head.gltf import read_head
from fapstream.head.gltf_write import write_head
from fapstream.head.mesh import Head
from tests.unit.adapt.persons import NAMES, adapted
from tests.unit.head.packaged import packaged


def same(points: np.ndarray) -> np.ndarray:
    return points.copy()


def frame(**values: int) -> np.ndarray:
    row = np.zeros(68, np.int32)
    for key, value in values.items():
        row[int(key[3:]) - 1] = value
    return row


TALKING = frame(
    fap3=500, fap5=-400, fap10=-300, fap11=-300, fap19=600, fap20=700, fap31=200, fap44=300, fap53=80
)


def test_the_warp_that_does_nothing_gives_the_head_back() -> None:
    head = packaged()
    again = carry(head, same)
    for old, new in zip(head.parts, again.parts, strict=True):
        if not old.name.startswith(("teeth", "tongue")):
            np.testing.assert_allclose(new.positions, old.positions, atol=2e-5)
        np.testing.assert_allclose(new.normals, old.normals, atol=1e-2)
    for name, value in head.fapu.as_dict().items():
        assert again.fapu.as_dict()[name] == pytest.approx(value, rel=2e-3)
    before, after = deform(head, TALKING), deform(again, TALKING)
    for part in ("skin", "eye_l", "lashes", "tongue", "teeth_lower"):
        np.testing.assert_allclose(after[part], before[part], atol=2.5e-4)


def test_a_larger_head_moves_as_much_larger() -> None:
    head, size = packaged(), 1.25
    large = carry(head, Similarity(size, np.eye(3), np.array([0.0, 0.01, 0.02])))
    rest, moved = (deform(h, frame())["skin"] for h in (head, large))
    before, after = deform(head, TALKING)["skin"] - rest, deform(large, TALKING)["skin"] - moved
    np.testing.assert_allclose(after, size * before, atol=2e-4)
    assert large.fapu.es0 == pytest.approx(size * head.fapu.es0, rel=1e-3)


def test_displacements_turn_with_the_surface() -> None:
    """Equation 2: Df psi. A part of the skin that a shear leans is moved along the lean."""
    head = packaged()
    shear = np.eye(3)
    shear[2, 1] = 0.3
    leaned = carry(head, lambda points: points @ shear.T)
    puffed, plain = (deform(h, frame(fap33=300))["skin"] - h.part("skin").positions for h in (leaned, head))
    most = np.linalg.norm(plain, axis=1).argmax()
    assert puffed[most, 2] == pytest.approx(
        (plain[most] @ shear.T)[2] * puffed[most, 1] / plain[most, 1], rel=0.02
    )


@pytest.mark.parametrize("name", NAMES)
def test_an_adapted_head_is_a_sound_file(name: str) -> None:
    head = adapted(name)
    again = read_head(write_head(head), name)
    assert again.name == head.name
    assert len(again.fat) == len(packaged().fat)
    assert measure(head.fdp).es0 == pytest.approx(head.fapu.es0)
    for part in head.parts:
        assert np.isfinite(part.positions).all()
        assert len(part.positions) == len(packaged().part(part.name).positions)
    assert 0.02 < head.mouth.size[0] < 0.09
    assert abs(head.mouth.center[1] - head.fdp["2.2"][1]) < 0.01


@pytest.mark.parametrize("name", NAMES)
def test_nothing_is_turned_inside_out(name: str) -> None:
    head, generic = adapted(name), packaged()
    for part in head.parts:
        if part.name == "hair":
            continue
        faces = [p.positions[p.triangles].astype(float) for p in (generic.part(part.name), part)]
        before, after = (np.cross(f[:, 1] - f[:, 0], f[:, 2] - f[:, 0]) for f in faces)
        large = np.linalg.norm(before, axis=1) > 1e-9
        assert ((before * after).sum(1)[large] > 0).all(), part.name


@pytest.mark.parametrize("name", NAMES)
def test_teeth_stay_behind_the_lips_and_within_the_mouth(name: str) -> None:
    """From in front, closed lips hide all teeth; spoken vowels show some."""
    head = adapted(name)
    assert not seen(head, frame(), "teeth_upper")
    assert seen(head, visemes()[10].astype(np.int32), "teeth_upper")


def seen(head: Head, values: np.ndarray, part: str) -> bool:
    """Whether a vertex of the part lies before all of the skin in the same column, near the lips."""
    positions = deform(head, values)
    skin, teeth = positions["skin"], positions[part]
    triangles = skin[head.part("skin").triangles]
    near = np.abs(triangles.mean(1) - head.mouth.center).max(1) < 0.04
    a, b, c = (triangles[near, k] for k in range(3))
    for point in teeth[np.abs(teeth[:, 0] - head.mouth.center[0]) < 0.015][::3]:
        u, v, w = (corner[:, :2] - point[:2] for corner in (a, b, c))
        s = [p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0] for p, q in ((u, v), (v, w), (w, u))]
        total = sum(s)
        inside = ((np.array(s) >= 0).all(0) | (np.array(s) <= 0).all(0)) & (np.abs(total) > 1e-12)
        depth = (s[1] * a[:, 2] + s[2] * b[:, 2] + s[0] * c[:, 2])[inside] / total[inside]
        if not (depth > point[2]).any():
            return True
    return False


def test_what_is_given_is_not_changed() -> None:
    head = packaged()
    before = head.part("skin").positions.copy()
    carry(head, Chain((same, Similarity(1.1, np.eye(3), np.zeros(3)))), "other")
    assert np.array_equal(head.part("skin").positions, before)
