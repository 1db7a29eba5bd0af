"""Facial parts deformation (section 2.3)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.adapt.parts import (
    MOST_STRETCHED,
    PartsWarp,
    Piece,
    alignment,
    fit_parts,
    fit_piece,
    mirrored,
    parts,
    stretching,
)
from fapstream.adapt.points import MIRROR, feature_points
from fapstream.adapt.views import rotation
from fapstream.fap.fdp import FDP_NAMES
from tests.unit.adapt.persons import made_up, places
from tests.unit.head.packaged import packaged

PLACES = {name: np.array(at) for name, at in packaged().fdp.items()} | dict(places())
WANTED = {"eye", "brow", "nose", "mouth", "chin", "jaw", "cheek", "forehead", "ear", "skull", "neck"}


def test_the_parts_of_a_face_are_there_and_named_by_points_that_there_are() -> None:
    assert {part.name.removesuffix("_l").removesuffix("_r") for part in parts()} == WANTED
    for part in parts():
        assert set(part.points) <= set(feature_points()), part.name
        assert set(part.area) <= set(FDP_NAMES), part.name
        assert len(part.lines) == 3, "the paper aligns three lines"
        assert {end for line in part.lines for end in line} <= set(part.points), part.name
        assert len(set(part.points)) >= 3
    both = {name: {part.name: part for part in parts()}[f"{name}"] for name in ("eye_l", "eye_r")}
    assert tuple(map(mirrored, both["eye_l"].points)) == both["eye_r"].points
    covered = {name for part in parts() for name in part.points}
    assert covered == set(feature_points()), "no feature point is without a part"


@given(st.integers(0, 10**6))
def test_lines_on_the_midline_align_too(seed: int) -> None:
    """dx = 0, where the paper's gradients are infinite."""
    rng = np.random.default_rng(seed)
    turn = rotation(rng.normal(0, 0.5, 3))
    lines = np.c_[np.zeros(3), rng.normal(size=(3, 2))]
    found = alignment(lines, lines @ turn.T)
    np.testing.assert_allclose(lines @ found.T, lines @ turn.T, atol=1e-9)
    assert np.linalg.det(found) == pytest.approx(1)


def test_stretching_is_the_papers_where_a_part_has_size() -> None:
    """Equation 8: sx = sum(xR xt) / sum(xR^2)."""
    turned = np.random.default_rng(1).normal(0, 5.0, (9, 3))
    target = turned * (1.2, 0.8, 1.05) + np.random.default_rng(2).normal(0, 0.1, (9, 3))
    np.testing.assert_allclose(
        stretching(turned, target), (turned * target).sum(0) / (turned**2).sum(0), rtol=1e-4
    )


def test_flat_parts_keep_their_thickness_and_none_turns_inside_out() -> None:
    flat = np.array([[0.02, 0.001, 0], [-0.02, 0, 0.0001], [0, -0.001, 0]])
    factors = stretching(flat, flat * (1.3, -40, 500))
    assert factors[0] > 1.2
    assert (factors > 0).all()
    assert (factors <= MOST_STRETCHED).all()
    assert stretching(np.zeros((3, 3)), np.ones((3, 3))).tolist() == [1, 1, 1]


def test_a_part_is_centred_turned_stretched_and_moved() -> None:
    rng = np.random.default_rng(4)
    source = rng.normal(0, 0.05, (8, 3))
    turn, stretch = rotation(np.array([0.1, -0.2, 0.05])), np.array([1.2, 0.9, 1.1])
    target = (source - source.mean(0)) @ turn.T * stretch + (0.01, 0.02, 0.03)
    lines = source[[1, 2, 3]] - source[[4, 5, 6]]
    piece = fit_piece(source, target, lines, lines @ turn.T)
    np.testing.assert_allclose(piece(source), target, atol=1e-3)
    np.testing.assert_allclose(piece(source).mean(0), target.mean(0), atol=1e-12)


def test_space_is_shared_out_and_borders_are_interpolated() -> None:
    pieces = tuple(Piece(np.eye(3), np.zeros(3), np.array([k, 0.0, 0])) for k in (0, 1))
    warp = PartsWarp(pieces, (np.array([[0.0, 0, 0]]), np.array([[0.1, 0, 0]])))
    points = np.c_[np.linspace(-0.05, 0.15, 81), np.zeros((81, 2))]
    moved = (warp(points) - points)[:, 0]
    np.testing.assert_allclose(warp.weights(points).sum(1), 1)
    assert moved[0] == 0
    assert moved[-1] == pytest.approx(1)
    assert moved[40] == pytest.approx(0.5), "half way both have the same say"
    assert (np.diff(moved) >= -1e-12).all()
    assert np.diff(moved).max() < 0.15, "nothing tears"


def test_nodes_come_where_they_are_wanted() -> None:
    truth = made_up(5)
    warp = fit_parts(places(), truth, PLACES)
    moved = warp(np.array([places()[name] for name in truth]))
    assert np.abs(moved - np.array(list(truth.values()))).max() < 1e-6


def test_a_symmetric_face_stays_symmetric() -> None:
    truth = made_up(6)
    warp = fit_parts(places(), truth, PLACES)
    points = packaged().part("skin").positions.astype(float)[::40]
    np.testing.assert_allclose(warp(points * MIRROR), warp(points) * MIRROR, atol=6e-4)


def test_parts_with_too_few_points_are_left_to_their_neighbours() -> None:
    truth = {name: at for name, at in made_up(7).items() if not name.startswith("10.")}
    warp = fit_parts(places(), truth, PLACES)
    ear = np.array([places()["10.1"]])
    assert np.linalg.norm(warp(ear) - ear) < 0.02
