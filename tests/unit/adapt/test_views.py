"""The paper's cameras and linear solution, and the cameras that are refined."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from fapstream.adapt.points import Facing
from fapstream.adapt.rigid import Similarity
from fapstream.adapt.views import (
    LOOKS,
    TO_MPEG4,
    Camera,
    PaperCameras,
    camera_of,
    rotation,
    rotation_vector,
    to_mpeg4,
)

Floats = NDArray[np.float64]


def face(seed: int = 0, baseline: float = 1.0) -> Floats:
    """Points about the place that both of the paper's cameras look at: (0, 0, b)."""
    return np.random.default_rng(seed).normal(0, 0.08, (30, 3)) + (0, 0, baseline)


def paper(facing: Facing, baseline: float = 1.0) -> PaperCameras:
    return PaperCameras(1400.0, (500.0, 480.0), (510.0, 470.0), baseline, facing)


@pytest.mark.parametrize("facing", ["left", "right"])
def test_equation_1_and_the_appendix_undo_one_another(facing: Facing) -> None:
    points = face()
    np.testing.assert_allclose(paper(facing).locate(*paper(facing).project(points)), points, atol=1e-9)


def test_the_four_equations_are_the_papers() -> None:
    """f x + (XF-XF0) z = 0 and so on: the residuals of located points under noise are at their least
    squares.
    """
    cameras = paper("right")
    front, profile = cameras.project(face())
    noisy = front + np.random.default_rng(3).normal(0, 2, front.shape)
    (xf, yf), (xp, yp) = (noisy - cameras.front).T, (profile - cameras.profile).T

    def equations(points: Floats) -> Floats:
        x, y, z = points.T
        f, b = cameras.focal, cameras.baseline
        return np.stack([
            f * x + xf * z, f * y + yf * z, f * z - xp * x - (f * b - xp * b), f * y - yp * x + yp * b,
        ])  # fmt: skip

    found = cameras.locate(noisy, profile)
    least = (equations(found) ** 2).sum(0)
    for axis in np.eye(3):
        for way in (-1e-5, 1e-5):
            assert ((equations(found + way * axis) ** 2).sum(0) >= least - 1e-9).all()


def test_frames_as_the_issue_of_the_paper_has_them() -> None:
    """x to the subject's right and z away from the face; the right profile's nose points to the image's
    right.
    """
    cameras, b = paper("right"), 1.0
    nose, right_ear, chin = np.array([[0, 0, b - 0.1]]), np.array([[0.08, 0, b]]), np.array([[0, -0.1, b]])
    front = lambda p: cameras.project(p)[0][0] - cameras.front  # noqa: E731
    profile = lambda p: cameras.project(p)[1][0] - cameras.profile  # noqa: E731
    assert front(right_ear)[0] < 0, "the subject's right is on the photo's left"
    assert front(chin)[1] > 0, "rows go down"
    assert profile(nose)[0] > 0
    assert profile(chin)[1] > 0
    assert np.linalg.det(TO_MPEG4) == pytest.approx(1), "both frames are right-handed"
    moved = to_mpeg4(right_ear)[0] - to_mpeg4(np.array([[0, 0, b]]))[0]
    assert moved[0] < 0, "MPEG-4's x goes to the subject's left"
    assert (to_mpeg4(nose) - to_mpeg4(np.array([[0, 0, b]])))[0, 2] > 0, "and its z forward"


@pytest.mark.parametrize("look", sorted(LOOKS))
def test_a_camera_sees_the_head_upright_and_from_its_side(look: str) -> None:
    assert np.linalg.det(LOOKS[look]) == pytest.approx(1)
    camera = Camera(look, (500, 500), np.zeros(3), 3000.0, 0.9, np.zeros(3), np.zeros(2))
    u, v = camera.project(np.array([[0.0, 0.1, 0.0], [0, 0, 0.1], [0.08, 0, 0]])).T
    assert v[0] < 500, "up is up"
    assert (u[1] > 500, u[1] < 500) == (look == "right", look == "left")
    if look == "front":
        assert u[2] > 500, "the subject's left is on the photo's right"
    else:
        nearer = camera.inside(np.array([[0.08, 0, 0]]))[0, 2] > 0
        assert nearer == (look == "left"), "a head that looks left shows its left side"


@pytest.mark.parametrize("facing", ["left", "right"])
def test_the_papers_cameras_in_the_heads_terms_see_the_same(facing: Facing) -> None:
    cameras = paper(facing, 1.3)
    head = np.random.default_rng(5).normal(0, 0.07, (12, 3))
    pose = Similarity(1.2, TO_MPEG4 @ rotation(np.array([0.05, -0.1, 0.03])), np.array([0.02, -0.01, 1.32]))
    seen = cameras.project(pose(head))
    for view, pixels in zip(("front", "profile"), seen, strict=True):
        camera = camera_of(cameras, view, pose, np.array([0.01, 0.02, 0.03]))
        np.testing.assert_allclose(camera.project(head), pixels, atol=1e-6)


def test_derivatives_are_those_of_the_projection() -> None:
    points = np.random.default_rng(2).normal(0, 0.08, (7, 3))
    for look in LOOKS:
        camera = Camera(
            look,
            (400, 300),
            np.array([0.01, 0, 0.05]),
            2500.0,
            0.8,
            np.array([0.1, -0.2, 0.05]),
            np.array([0.01, -0.02]),
        )
        by_point, by_change = camera.derivatives(points)
        for axis in range(3):
            step = 1e-6 * np.eye(3)[axis]
            slope = (camera.project(points + step) - camera.project(points - step)) / 2e-6
            np.testing.assert_allclose(by_point[:, :, axis], slope, rtol=1e-4, atol=1e-3)
        for k in range(7):
            step = 1e-6 * np.eye(7)[k]
            slope = (camera.moved(step).project(points) - camera.moved(-step).project(points)) / 2e-6
            np.testing.assert_allclose(by_change[:, :, k], slope, rtol=1e-4, atol=1e-3)


def test_the_camera_stands_where_it_sees_from() -> None:
    camera = Camera(
        "right", (0, 0), np.array([0.0, 0.1, 0]), 1000.0, 0.5, np.array([0, 0.1, 0]), np.array([0.03, 0.01])
    )
    assert camera.inside(camera.position[None])[0] == pytest.approx((0, 0, 2))
    assert np.isfinite(replace(camera, closeness=0.0).position).all()


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.3, 2.0, np.pi])
def test_rotation_vectors_come_back(angle: float) -> None:
    vector = angle * np.array([0.6, -0.48, 0.64])
    back = rotation_vector(rotation(vector))
    np.testing.assert_allclose(rotation(back), rotation(vector), atol=1e-7)
