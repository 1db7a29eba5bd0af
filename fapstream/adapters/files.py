"""Files read as a whole, but never more of them than there may be."""

from __future__ import annotations

from pathlib import Path

from fapstream.errors import InputError

MAX_BYTES = 1 << 28
"""Of an animation or a sound: hours."""


def read_file(path: Path, most: int = MAX_BYTES) -> bytes:
    """What is in the file. Raises OSError, InputError for more than `most` bytes, and reads no more."""
    with path.open("rb") as file:
        data = file.read(most + 1)
    if len(data) > most:
        raise InputError(f"{path}: more than {most >> 20} MB, the most that is read of such a file")
    return data
