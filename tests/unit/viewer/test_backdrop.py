"""The gradient behind the head."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.viewer.backdrop import CENTRE, HEIGHT, WIDTH, Backdrop, colour
from fapstream.viewer.graphics import open_context
from fapstream.viewer.look import load_look


def test_colours() -> None:
    assert colour("#ff8000") == pytest.approx((1.0, 128 / 255, 0.0))


def test_it_is_the_gradient_of_the_look() -> None:
    """Against the gradient computed here, pixel by pixel."""
    context, look = open_context(), load_look()
    target = context.framebuffer([context.renderbuffer((40, 30), 4)])
    target.use()
    Backdrop(context, look).draw()
    drawn = np.frombuffer(target.read(components=3), np.uint8).reshape(30, 40, 3)[::-1] / 255
    x, y = np.meshgrid((np.arange(40) + 0.5) / 40, (np.arange(30) + 0.5) / 30)
    radius = np.hypot((x - CENTRE[0]) / WIDTH, (y - CENTRE[1]) / HEIGHT)
    stops = look.settings["background"]
    places = [place for _, place in stops]
    expected = [np.interp(radius, places, [colour(name)[k] for name, _ in stops]) for k in range(3)]
    np.testing.assert_allclose(drawn, np.stack(expected, -1), atol=2 / 255)
    context.release()
