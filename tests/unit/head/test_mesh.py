"""The shipped head as a mesh: what protocol/HEAD.md and the web client rely on."""

import gzip

import numpy as np
import pytest

from fapstream.head.fapu import measure
from tests.unit.head.packaged import packaged, packaged_data

HEAD = packaged()


def test_it_is_light() -> None:
    assert len(gzip.compress(packaged_data())) < 1_000_000
    assert sum(len(part.positions) for part in HEAD.parts) <= 25_000


def test_the_parts_are_there() -> None:
    usual = {"skin", "eye_l", "eye_r", "teeth_upper", "teeth_lower", "tongue"}
    assert usual <= {part.name for part in HEAD.parts}
    with pytest.raises(KeyError):
        HEAD.part("hat")


def test_its_units_are_those_of_its_feature_points() -> None:
    assert HEAD.fapu.as_dict() == pytest.approx(measure(HEAD.fdp).as_dict(), abs=2e-7)


def test_its_proportions_are_a_humans() -> None:
    sizes = {name: value * 1000 for name, value in HEAD.fapu.as_dict().items()}
    assert 54 < sizes["ES0"] < 70
    assert 40 < sizes["MW0"] < 60
    assert 7 < sizes["IRISD0"] < 13


@pytest.mark.parametrize("part", HEAD.parts, ids=lambda part: part.name)
def test_normals_are_of_unit_length_and_agree_with_the_triangles(part: object) -> None:
    lengths = np.linalg.norm(part.normals, axis=1)
    assert np.abs(lengths - 1).max() < 0.03
    a, b, c = (part.positions[part.triangles[:, k]] for k in range(3))
    face = np.cross(b - a, c - a)
    agree = (face * part.normals[part.triangles].mean(1)).sum(1) >= 0
    assert agree.mean() > 0.97


def test_every_low_level_fap_moves_something() -> None:
    moving = {fap for row in (*HEAD.fat, *HEAD.turns) for fap in row.faps}
    assert moving == set(range(3, 69))
