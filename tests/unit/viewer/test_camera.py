"""The portrait is the web client's; turning and zooming keep what they should keep."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.head.mesh import Camera
from fapstream.viewer.camera import Lens, View, lens

CAMERA = Camera((0.01, 0.02, 0.03), 0.36)
FOV = 20.0


def seen(found: Lens, point: tuple[float, float, float]) -> np.ndarray:
    """Normalised device coordinates."""
    clip = found.projection @ found.view @ np.array([*point, 1.0])
    return np.asarray(clip[:3] / clip[3])


def test_the_portrait_frames_its_height() -> None:
    """tan(10 degrees) * distance is half of the height; the edge of the plane of the target is at 1."""
    found = lens(CAMERA, FOV, 1.0)
    assert found.position == pytest.approx((0.01, 0.02, 0.03 + 0.18 / np.tan(np.radians(10))))
    assert seen(found, (0.01, 0.02, 0.03))[:2] == pytest.approx((0, 0))
    assert seen(found, (0.01, 0.20, 0.03))[:2] == pytest.approx((0, 1))
    assert seen(found, (0.19, 0.02, 0.03))[:2] == pytest.approx((1, 0))


@pytest.mark.parametrize(("aspect", "shown"), [(2.0, 0.36), (0.8, 0.36), (0.4, 0.72)])
def test_a_narrow_picture_shows_more_so_that_the_head_stays_in_it(aspect: float, shown: float) -> None:
    found = lens(CAMERA, FOV, aspect)
    assert seen(found, (0.01, 0.02 + shown / 2, 0.03))[1] == pytest.approx(1)
    assert seen(found, (0.01 + aspect * shown / 2, 0.02, 0.03))[0] == pytest.approx(1)


def test_turning_goes_round_the_target_and_keeps_the_distance() -> None:
    front, side = lens(CAMERA, FOV, 1.0), lens(CAMERA, FOV, 1.0, View(yaw=90))
    distance = front.position[2] - 0.03
    assert side.position == pytest.approx((0.01 + distance, 0.02, 0.03))
    above = lens(CAMERA, FOV, 1.0, View(pitch=30))
    assert above.position == pytest.approx((0.01, 0.02 + distance / 2, 0.03 + distance * np.cos(np.pi / 6)))
    for found in (side, above):
        assert seen(found, CAMERA.target)[:2] == pytest.approx((0, 0))
        assert np.linalg.det(found.view) == pytest.approx(1)


def test_zoom_makes_larger_and_another_target_goes_to_the_middle() -> None:
    found = lens(CAMERA, FOV, 1.0, View(zoom=3, target=(0.0, -0.03, 0.1)))
    assert seen(found, (0.0, -0.03, 0.1))[:2] == pytest.approx((0, 0))
    assert seen(found, (0.0, 0.03, 0.1))[1] == pytest.approx(1)
