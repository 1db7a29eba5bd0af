"""Reading the tables of `tts/data`: small text files, read once by whoever composes a language or voice."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

from fapstream import data
from fapstream.errors import DataError, UnknownLanguage

LANGUAGES = ("en", "el")
"""Languages that can be read aloud."""


class PhoneInfo(NamedTuple):
    """What is known of one language-level phone whatever word it stands in.

    `kind`: vowel, stop, affricate, fricative, nasal, liquid, glide or silence. `mean_ms` is the
    inherent duration and `min_ms` the incompressible one, in the sense of Klatt (1979).
    """

    name: str
    kind: str
    voiced: bool
    mean_ms: float
    min_ms: float


def read_bytes(path: str) -> bytes:
    """The contents of `tts/data/<path>`. Raises DataError when it is not there."""
    return data.read_bytes("tts", path)


def read_text(path: str) -> str:
    """The contents of `tts/data/<path>` as UTF-8 text. Raises DataError."""
    return data.read_text("tts", path)


def read_rows(path: str, columns: int) -> Iterator[tuple[int, list[str]]]:
    """(line number, fields) of a tab-separated table; blank lines and lines starting with `;` are skipped.

    Missing trailing fields are empty. Raises DataError naming the line with too many fields.
    """
    for number, line in data.read_lines("tts", path, comment=";"):
        fields = line.split("\t")
        if len(fields) > columns:
            raise DataError(path, number, f"{len(fields)} fields where {columns} are expected")
        yield number, fields + [""] * (columns - len(fields))


def read_pairs(path: str) -> dict[str, str]:
    """A two-column table as a mapping. Raises DataError."""
    return {fields[0]: fields[1] for _, fields in read_rows(path, 2)}


def require_language(lang: str) -> str:
    """`lang` itself. Raises UnknownLanguage."""
    if lang not in LANGUAGES:
        raise UnknownLanguage(lang, LANGUAGES)
    return lang


@cache
def phone_set(lang: str) -> dict[str, PhoneInfo]:
    """Every phone of the language by name, silence `_` included. Raises UnknownLanguage, DataError."""
    path = f"{require_language(lang)}/phones.tsv"
    rows = [row for row in read_rows(path, 5) if row[1][0] != "name"]
    return {row[0]: _phone_info(path, number, row) for number, row in rows}


def _phone_info(path: str, number: int, row: list[str]) -> PhoneInfo:
    try:
        return PhoneInfo(row[0], row[1], row[2] == "1", float(row[3]), float(row[4]))
    except ValueError as error:
        raise DataError(path, number, str(error)) from error
