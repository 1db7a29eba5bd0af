"""Knowledge kept as files in `fapstream/<room>/data` of the package; what they mean their rooms know."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import resources

from fapstream.errors import DataError


def read_bytes(room: str, path: str) -> bytes:
    """The contents of a file. Raises DataError when it is not there."""
    try:
        return resources.files(f"fapstream.{room}").joinpath("data", *path.split("/")).read_bytes()
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
    return sorted(file.name for file in resources.files(f"fapstream.{room}").joinpath("data").iterdir())
