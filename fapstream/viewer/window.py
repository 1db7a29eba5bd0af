"""A window through glfw: drag to look from the side, wheel to come closer, R to go back, Escape to leave."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fapstream.viewer.camera import PORTRAIT, View
from fapstream.viewer.canvas import SAMPLES, Canvas
from fapstream.viewer.graphics import ViewerUnavailable, is_software, needed
from fapstream.viewer.renderer import Renderer

DEGREES_A_PIXEL = 0.3
MOST_YAW, MOST_PITCH = 80.0, 40.0
ZOOM_A_STEP = 1.1
LEAST_ZOOM, MOST_ZOOM = 0.5, 6.0


def dragged(view: View, dx: float, dy: float) -> View:
    """The view after the pointer has pulled the head by so many pixels to the right and down."""
    yaw = max(-MOST_YAW, min(MOST_YAW, view.yaw - dx * DEGREES_A_PIXEL))
    pitch = max(-MOST_PITCH, min(MOST_PITCH, view.pitch + dy * DEGREES_A_PIXEL))
    return replace(view, yaw=yaw, pitch=pitch)


def zoomed(view: View, steps: float) -> View:
    """The view after so many steps of the wheel; upwards is closer."""
    return replace(view, zoom=max(LEAST_ZOOM, min(MOST_ZOOM, view.zoom * ZOOM_A_STEP**steps)))


class Window:
    """`size`: (width, height) of the window; None fills the screen."""

    def __init__(self, title: str, size: tuple[int, int] | None) -> None:
        """Raises ViewerUnavailable."""
        self.glfw = glfw = needed("glfw")
        moderngl = needed("moderngl")
        glfw.ERROR_REPORTING = False
        self.handle = self._open(title, size)
        glfw.make_context_current(self.handle)
        glfw.swap_interval(1)
        try:
            self.context = moderngl.create_context(require=330)
        except Exception as e:  # moderngl raises bare Exceptions
            glfw.terminate()
            raise ViewerUnavailable(f"the window has no OpenGL 3.3: {e}") from e
        self.software = is_software(self.context)
        """Is it the processor that draws? Then smooth edges would cost half of the frames."""
        self._canvas: Canvas | None = None
        self.view = PORTRAIT
        """From where the user wants to look."""
        self._grip: tuple[float, float] | None = None
        glfw.set_key_callback(self.handle, self._key)
        glfw.set_scroll_callback(self.handle, self._scroll)
        glfw.set_cursor_pos_callback(self.handle, self._move)

    @property
    def closed(self) -> bool:
        """Has the user had enough?"""
        return bool(self.glfw.window_should_close(self.handle))

    def title(self, text: str) -> None:
        """What stands above the picture."""
        self.glfw.set_window_title(self.handle, text)

    def show(self, renderer: Renderer) -> None:
        """Draw the head as it is and hand the picture over; takes what the user did."""
        width, height = self.glfw.get_framebuffer_size(self.handle)
        if width and height:
            canvas = self._fitting((width, height))
            renderer.draw(canvas.framebuffer, self.view)
            self.context.screen.viewport = (0, 0, width, height)
            canvas.resolve(self.context.screen)
        self.glfw.swap_buffers(self.handle)
        self.glfw.poll_events()

    def close(self) -> None:
        """Shut it."""
        self.context.release()
        self.glfw.terminate()

    def _open(self, title: str, size: tuple[int, int] | None) -> Any:
        glfw = self.glfw
        if not glfw.init():
            raise ViewerUnavailable(f"no window opens here ({self._reason()}); --headless writes pictures")
        hints = {
            glfw.CONTEXT_VERSION_MAJOR: 3,
            glfw.CONTEXT_VERSION_MINOR: 3,
            glfw.OPENGL_PROFILE: glfw.OPENGL_CORE_PROFILE,
            glfw.OPENGL_FORWARD_COMPAT: True,
        }
        for hint, value in hints.items():
            glfw.window_hint(hint, value)
        monitor = None
        if size is None:
            monitor = glfw.get_primary_monitor()
            size = tuple(glfw.get_video_mode(monitor).size) if monitor else (1280, 800)
        handle = glfw.create_window(*size, title, monitor, None)
        if not handle:
            reason = self._reason()
            glfw.terminate()
            raise ViewerUnavailable(f"no window opens here ({reason}); --headless writes pictures")
        return handle

    def _reason(self) -> str:
        _, text = self.glfw.get_error()
        return text.decode("utf-8", "replace") if isinstance(text, bytes) else str(text or "no display")

    def _fitting(self, size: tuple[int, int]) -> Canvas:
        if self._canvas is None or self._canvas.size != size:
            if self._canvas:
                self._canvas.release()
            self._canvas = Canvas(self.context, size, 0 if self.software else SAMPLES)
        return self._canvas

    def _key(self, _window: Any, key: int, _code: int, action: int, _mods: int) -> None:
        if action == self.glfw.PRESS and key == self.glfw.KEY_ESCAPE:
            self.glfw.set_window_should_close(self.handle, True)
        if action == self.glfw.PRESS and key == self.glfw.KEY_R:
            self.view = PORTRAIT

    def _scroll(self, _window: Any, _dx: float, dy: float) -> None:
        self.view = zoomed(self.view, dy)

    def _move(self, _window: Any, x: float, y: float) -> None:
        held = self.glfw.get_mouse_button(self.handle, self.glfw.MOUSE_BUTTON_LEFT) == self.glfw.PRESS
        if held and self._grip:
            self.view = dragged(self.view, x - self._grip[0], y - self._grip[1])
        self._grip = (x, y) if held else None
