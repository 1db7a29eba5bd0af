"""Eyes stay balls under their lids."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fapstream.adapt.eyes import KEPT, LEFT, keeping_eyes
from tests.unit.head.packaged import packaged


def squeezed(points: np.ndarray) -> np.ndarray:
    """Wider by a tenth, lower by a tenth, and bent."""
    return points * (1.1, 0.9, 1.02) + 0.002 * np.sin(40 * points[:, [1, 2, 0]])


def test_what_is_near_a_ball_keeps_its_distance_in_radii() -> None:
    head = packaged()
    warp, balls = keeping_eyes(squeezed, head)
    assert set(balls) == {"l", "r"}
    for ball in balls.values():
        rng = np.random.default_rng(0)
        away = rng.normal(size=(300, 3))
        away /= np.linalg.norm(away, axis=1, keepdims=True)
        far = rng.uniform(0.3, KEPT, (300, 1)) * ball.radius
        moved = warp(ball.centre + far * away)
        middle = ball.moved(ball.centre[None])
        np.testing.assert_allclose(
            np.linalg.norm(moved - middle, axis=1), far[:, 0] * ball.moved.scale, rtol=1e-6
        )
        outside = ball.centre + away * ball.radius * (LEFT + 0.01)
        np.testing.assert_allclose(warp(outside), squeezed(outside))


def test_pupils_are_where_the_photo_has_them_and_eyes_look_ahead() -> None:
    _, balls = keeping_eyes(squeezed, packaged())
    for side, name in (("l", "3.5"), ("r", "3.6")):
        pupil = np.array([packaged().fdp[name]])
        np.testing.assert_allclose(balls[side].moved(pupil)[0, :2], squeezed(pupil)[0, :2], atol=1e-9)
        assert np.array_equal(balls[side].moved.rotation, np.eye(3))
        assert 0.9 < balls[side].moved.scale < 1.1


def test_nothing_tears_round_the_ball() -> None:
    warp, balls = keeping_eyes(squeezed, packaged())
    ball = balls["l"]
    line = ball.centre + np.linspace(0.3, 3, 400)[:, None] * ball.radius * np.array([0.48, 0.6, 0.64])
    steps = np.linalg.norm(np.diff(warp(line), axis=0), axis=1)
    assert steps.max() < 3 * np.median(steps)
    assert steps.min() > 0.2 * np.median(steps)


def test_a_head_without_eyes_is_warped_as_it_is() -> None:
    head = packaged()
    blind = replace(head, parts=tuple(part for part in head.parts if not part.name.startswith("eye")))
    warp, balls = keeping_eyes(squeezed, blind)
    assert not balls
    assert warp(head.part("skin").positions[:9].astype(float)) == pytest.approx(
        squeezed(head.part("skin").positions[:9].astype(float))
    )
