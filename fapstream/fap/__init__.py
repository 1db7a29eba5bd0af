"""MPEG-4 facial animation as ISO/IEC 14496-2 has it: FAPs, visemes, expressions, files, streams."""

from __future__ import annotations

from fapstream.fap.animation import read_animation
from fapstream.fap.expand import Expander
from fapstream.fap.fba_decode import decode_fba
from fapstream.fap.fba_encode import FbaOptions, encode_fba
from fapstream.fap.files import format_fap, read_fap
from fapstream.fap.rows import FapRow, Note
from fapstream.fap.sequence import FapSequence
from fapstream.fap.tables import (
    ANGLE_UNIT_RAD,
    EXPRESSIONS,
    FULL,
    N_VISEMES,
    Fap,
    expressions,
    faps,
    limits,
    visemes,
)

__all__ = [
    "ANGLE_UNIT_RAD",
    "EXPRESSIONS",
    "FULL",
    "N_VISEMES",
    "Expander",
    "Fap",
    "FapRow",
    "FapSequence",
    "FbaOptions",
    "Note",
    "decode_fba",
    "encode_fba",
    "expressions",
    "faps",
    "format_fap",
    "limits",
    "read_animation",
    "read_fap",
    "visemes",
]
