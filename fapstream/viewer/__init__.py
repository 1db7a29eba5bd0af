"""The moderngl client: the web client's head, light and clock in a window, or as pictures in files."""

from __future__ import annotations
