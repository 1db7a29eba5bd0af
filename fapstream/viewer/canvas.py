"""What a head is drawn on: smooth edges, and pictures without a window."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fapstream.head.deform import Values
from fapstream.head.mesh import Head
from fapstream.viewer.camera import PORTRAIT, Lens, View
from fapstream.viewer.graphics import open_context
from fapstream.viewer.renderer import Renderer

SAMPLES = 4
"""Of multisampling, where the graphics card does it at no cost worth naming."""

Pixels = NDArray[np.uint8]


class Canvas:
    """A multisampled framebuffer of `size` (width, height) pixels, resolved where it is wanted."""

    def __init__(self, context: Any, size: tuple[int, int], samples: int = SAMPLES) -> None:
        samples = min(samples, context.max_samples)
        self._parts = (
            context.renderbuffer(size, 4, samples=samples),
            context.depth_renderbuffer(size, samples=samples),
        )
        self.framebuffer = context.framebuffer([self._parts[0]], self._parts[1])
        self.size = size
        self._context = context

    def resolve(self, target: Any) -> None:
        """Copy the picture to another framebuffer of the same size."""
        self._context.copy_framebuffer(target, self.framebuffer)

    def release(self) -> None:
        """Give it back to the graphics card."""
        for thing in (self.framebuffer, *self._parts):
            thing.release()


class Studio:
    """A head without a window; `picture` takes pictures of it. `size`: (width, height) in pixels."""

    def __init__(self, head: Head, size: tuple[int, int], samples: int = SAMPLES) -> None:
        """Raises ViewerUnavailable, DataError for a picture in the head file."""
        self._context = open_context()
        self._renderer = Renderer(self._context, head)
        self._canvas = Canvas(self._context, size, samples)
        self._plain = Canvas(self._context, size, 0)

    def picture(
        self, values: Values | NDArray[np.float64], view: View | Lens = PORTRAIT, backdrop: bool = True
    ) -> Pixels:
        """The face under FAPs (68,): uint8 (height, width, 4), top row first.

        With the backdrop alpha is 255; without it the picture has premultiplied alpha.
        """
        with self._context:  # several studios may be open
            self._renderer.deform(values)
            self._renderer.draw(self._canvas.framebuffer, view, backdrop)
            self._canvas.resolve(self._plain.framebuffer)
            data = self._plain.framebuffer.read(components=4)
        width, height = self._canvas.size
        return np.frombuffer(data, np.uint8).reshape(height, width, 4)[::-1]

    def close(self) -> None:
        """Give everything back to the graphics card."""
        self._context.release()
