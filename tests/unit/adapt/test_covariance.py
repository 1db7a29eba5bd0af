"""What is known of faces before any photo is seen."""

from __future__ import annotations

import numpy as np

from fapstream.adapt.covariance import Covariance, precision, similarities
from fapstream.adapt.points import MIRROR
from fapstream.adapt.rigid import Similarity
from fapstream.adapt.views import rotation
from tests.unit.adapt.persons import places

POINTS = np.array(list(places().values()))


def test_it_is_a_covariance() -> None:
    matrix = Covariance().within(POINTS)
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-12)
    assert np.linalg.eigvalsh(matrix).min() > 0


def test_what_one_side_does_the_other_does_mirrored() -> None:
    faces = Covariance(asymmetry=0.0)
    left = np.array([[0.03, 0.02, 0.09]])
    both = np.concatenate([left, left * MIRROR])
    weights = np.random.default_rng(0).normal(size=(len(POINTS), 3))
    move = faces.field(both, POINTS, weights)
    np.testing.assert_allclose(move[1], move[0] * MIRROR, atol=1e-9)
    middle = faces.field(np.array([[0.0, 0.01, 0.1]]), POINTS, weights)
    assert abs(middle[0, 0]) < 1e-12, "the midline stays in the middle"
    uneven = Covariance(asymmetry=0.5).field(both, POINTS, weights)
    assert np.abs(uneven[1] - uneven[0] * MIRROR).max() > 1e-3 * np.abs(uneven).max()


def test_field_and_slopes_are_those_of_the_matrix() -> None:
    faces, rng = Covariance(), np.random.default_rng(1)
    weights, at = rng.normal(size=(len(POINTS), 3)), rng.normal(0, 0.08, (5, 3))
    whole = (faces.between(at, POINTS) @ weights.ravel()).reshape(-1, 3)
    np.testing.assert_allclose(faces.field(at, POINTS, weights), whole, atol=1e-12)
    slopes, step = faces.slopes(at, POINTS, weights), 1e-6
    for axis in range(3):
        ahead, behind = (faces.field(at + way * step * np.eye(3)[axis], POINTS, weights) for way in (1, -1))
        np.testing.assert_allclose(slopes[:, :, axis], (ahead - behind) / (2 * step), rtol=1e-4, atol=1e-6)


def test_poses_cannot_be_taken_for_faces() -> None:
    basis = similarities(POINTS)
    np.testing.assert_allclose(basis.T @ basis, np.eye(7), atol=1e-9)
    small = Similarity(1.001, rotation(np.array([1e-3, -2e-3, 1e-3])), np.array([1e-4, 0, 2e-4]))
    move = (small(POINTS) - POINTS).ravel()
    assert np.linalg.norm(move - basis @ (basis.T @ move)) < 2e-3 * np.linalg.norm(move)
    prior = precision(Covariance(), POINTS)
    other = np.random.default_rng(2).normal(size=move.shape)
    other *= np.linalg.norm(move) / np.linalg.norm(other)
    assert move @ prior @ move > 50 * (other @ prior @ other)
