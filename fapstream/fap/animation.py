"""Face animation in whichever form: `.fap` text or an FBA stream."""

from __future__ import annotations

from pathlib import PurePath

from fapstream.fap.fba import OBJECT_CODE
from fapstream.fap.fba_decode import decode_fba
from fapstream.fap.files import DEFAULT_FPS, read_fap
from fapstream.fap.sequence import FapSequence

_SEEN_WITHIN = 64
"""Bytes in which an FBA object begins, if the name does not say what it is."""


def read_animation(data: bytes, where: str, fps: float = DEFAULT_FPS) -> FapSequence:
    """The animation in a file's bytes; `where` is its name, `fps` for a text without a header.

    Raises DataError with the line, BitstreamError with the bit.
    """
    path = PurePath(where)
    if path.suffix.lower() == ".fba" or OBJECT_CODE.to_bytes(4, "big") in data[:_SEEN_WITHIN]:
        return decode_fba(data, where, path.stem)
    return read_fap(data.decode("utf-8", "replace"), where, fps)
