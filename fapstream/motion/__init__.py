"""Timed phones to FAP tracks."""

from __future__ import annotations

from fapstream.motion.track import FaceTrack

__all__ = ["FaceTrack"]
