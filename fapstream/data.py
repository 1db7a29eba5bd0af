"""Knowledge kept as files in `fapstream/<room>/data` of the package; what they mean their rooms know."""

from __future__ import annotations

import os
from collections.abc import Iterator

from fapstream.errors import DataError

PACKAGE = os.path.dirname(__file__)
"""Files are read from the directory of the package: importlib.resources and pathlib would make the start of
the front-end a tenth longer, and nobody runs the package from an archive."""


def _path(room: str, *parts: str) -> str:
    return os.path.join(PACKAGE, room, "data", *parts)


def read_bytes(room: str, path: str) -> bytes:
    """The contents of a file. Raises DataError when it is not there."""
    try:
        with open(_path(room, *path.split("/")), "rb") as file:
            return file.read()
    except OSError as error:
        raise DataError(path, None, "not in the package") from error


def read_text(room: str, path: str) -> str:
    """The contents as UTF-8 text. Raises DataError."""
    return read_bytes(room, path).decode("utf-8")


def read_lines(room: str, path: str, comment: str = "#") -> Iterator[tuple[int, str]]:
    """(line number, line) of a table, without blank lines and those that begin with `comment`."""
    for number, line in enumerate(read_text(room, path).split("\n"), 1):
        if line.strip() and not line.startswith(comment):
            yield number, line


def names(room: str) -> list[str]:
    """The files that there are."""
    return sorted(os.listdir(_path(room)))
