"""Landmarks of our own head, exported to plain morph targets, against its feature points."""

import numpy as np
import pytest

from fapstream.head.document import split_glb
from fapstream.head.export import export_shapes
from fapstream.head.foreign import read_foreign
from fapstream.head.gltf import read_head
from fapstream.head.landmarks import find, moving
from fapstream.head.mesh import Head
from fapstream.head.scene import Scene
from tests.unit.head.avatars import EYES, avatar
from tests.unit.head.packaged import packaged_data

GENERIC = packaged_data()


@pytest.fixture(scope="module")
def pair() -> tuple[Head, Head]:
    head = read_head(GENERIC)
    return head, read_foreign(export_shapes(head)).head


def test_units_and_points_are_nearly_those_that_were_lost(pair: tuple[Head, Head]) -> None:
    """The shapes tell them to a fifth."""
    head, found = pair
    assert found.fapu.as_dict() == pytest.approx(head.fapu.as_dict(), rel=0.2)
    for name, error in (("8.3", 0.004), ("8.4", 0.004), ("3.5", 0.001), ("3.6", 0.001)):
        np.testing.assert_allclose(found.fdp[name][:2], head.fdp[name][:2], atol=error)
    np.testing.assert_allclose(found.mouth.center, head.mouth.center, atol=0.01)


def test_the_portrait_is_framed_alike(pair: tuple[Head, Head]) -> None:
    head, found = pair
    assert found.camera.height == pytest.approx(head.camera.height, rel=0.1)
    np.testing.assert_allclose(found.camera.target, head.camera.target, atol=0.02)


def test_lids_tell_the_eyes_where_nothing_else_does() -> None:
    scene = Scene(*split_glb(avatar(rig=False), "x"), "x")
    surfaces = scene.surfaces({(0, k): {name: 1.0} for k, name in enumerate(scene.target_names()[0])})
    marks = find(surfaces, {})
    assert marks.eyes[0][0] == pytest.approx(EYES, abs=0.004)
    assert marks.eyes[1][0] == pytest.approx(-EYES, abs=0.004)
    assert marks.eyes[0][1] > marks.mouth[1] > marks.chin
    assert marks.eyes[0][1] < marks.top


def test_nothing_moves_under_a_shape_that_is_not_there() -> None:
    assert moving([], ["jawOpen"], 0.5).shape == (0, 3)
