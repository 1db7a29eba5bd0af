"""The moderngl client: the web client's head, light and clock in a window, or as pictures in files."""

from __future__ import annotations

from fapstream.viewer.camera import View
from fapstream.viewer.canvas import Studio
from fapstream.viewer.clip import Clip, read_clip
from fapstream.viewer.film import film
from fapstream.viewer.renderer import Renderer

__all__ = ["Clip", "Renderer", "Studio", "View", "film", "read_clip"]
