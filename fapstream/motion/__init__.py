"""Timed phones to FAP tracks, and what a face does between them."""

from __future__ import annotations

from fapstream.motion.idle import IdleLife
from fapstream.motion.mixer import idle_face
from fapstream.motion.track import FaceTrack

__all__ = ["FaceTrack", "IdleLife", "idle_face"]
