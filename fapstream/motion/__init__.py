"""Timed phones to FAP tracks, and what a face does between them."""

from __future__ import annotations

from fapstream.motion.idle import IdleLife
from fapstream.motion.mixer import idle_face
from fapstream.motion.mouths import DEFAULT_MODEL, GAINS, MODELS, Motion
from fapstream.motion.speaker import hearing_mouth
from fapstream.motion.track import FaceTrack

__all__ = [
    "DEFAULT_MODEL",
    "GAINS",
    "MODELS",
    "FaceTrack",
    "IdleLife",
    "Motion",
    "hearing_mouth",
    "idle_face",
]
