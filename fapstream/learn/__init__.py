"""What people's faces do when they speak: measured on landmarks, and learned.

    landmarks (a mesh tracked through a clip) -> measured (FAPs, points) -> articulatory (six parameters)
    parameters and the phones that were heard -> sentences -> hmm, ohman -> training: a motion.Speaker

Nothing here is needed to speak; it takes scipy.
"""

from __future__ import annotations

from fapstream.learn.clips import Clip, Folder
from fapstream.learn.landmarks import Landmarks
from fapstream.learn.measured import MEASURED, RATE, Measured, measure_clip

__all__ = ["MEASURED", "RATE", "Clip", "Folder", "Landmarks", "Measured", "measure_clip"]
