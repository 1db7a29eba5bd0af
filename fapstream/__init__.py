"""fapstream: text in, voice and MPEG-4 face out, streamed on one clock."""

from __future__ import annotations

__version__ = "0.1.0"
__all__ = ["__version__"]
