"""MPEG-4 facial animation as ISO/IEC 14496-2 has it: FAPs, visemes, expressions, files."""

from __future__ import annotations

from fapstream.fap.files import format_fap
from fapstream.fap.tables import EXPRESSIONS, N_VISEMES, Fap, expressions, faps, visemes

__all__ = ["EXPRESSIONS", "N_VISEMES", "Fap", "expressions", "faps", "format_fap", "visemes"]
