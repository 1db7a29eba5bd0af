"""What the pointer does to the view, and what is said where there is no screen. Real windows: tests/e2e."""

from __future__ import annotations

import pytest

from fapstream.viewer.camera import PORTRAIT, View
from fapstream.viewer.graphics import ViewerUnavailable
from fapstream.viewer.window import LEAST_ZOOM, MOST_PITCH, MOST_YAW, MOST_ZOOM, Window, dragged, zoomed


def test_dragging_turns_the_head_with_the_pointer() -> None:
    """To the right: the camera goes to the left of the picture, the subject's right; down: up."""
    view = dragged(PORTRAIT, 100, 50)
    assert view.yaw < 0 < view.pitch
    assert dragged(view, -100, -50) == PORTRAIT
    far = dragged(PORTRAIT, -10_000, 10_000)
    assert (far.yaw, far.pitch) == (MOST_YAW, MOST_PITCH)


def test_the_wheel_zooms_within_bounds() -> None:
    assert zoomed(PORTRAIT, 1).zoom > 1
    assert zoomed(zoomed(PORTRAIT, 3), -3).zoom == pytest.approx(1)
    assert zoomed(View(yaw=9), 1000) == View(yaw=9, zoom=MOST_ZOOM)
    assert zoomed(PORTRAIT, -1000).zoom == LEAST_ZOOM


def test_without_a_screen_the_way_out_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(ViewerUnavailable, match=r"no window opens here \(.+\); --headless"):
        Window("x", (64, 64))
