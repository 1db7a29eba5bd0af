"""Files of the package: read whole or by line, and named when they are missing."""

from __future__ import annotations

from pathlib import Path

import pytest

from fapstream import data
from fapstream.data import names, read_bytes, read_lines, read_text
from fapstream.errors import DataError


def test_files_of_rooms_are_found() -> None:
    assert read_bytes("tts", "en/lexicon.bin")
    assert read_text("fap", "faps.json").startswith("[")
    assert {"life.json", "visemes_en.tsv"} <= set(names("motion"))
    assert names("motion") == sorted(names("motion"))


def test_lines_keep_their_numbers_and_comments_are_left_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "any/data").mkdir(parents=True)
    (tmp_path / "any/data/a.tsv").write_text("# c\n\na\t1\n  \n;b\t2\n", encoding="utf-8")
    monkeypatch.setattr(data, "PACKAGE", str(tmp_path))
    assert list(read_lines("any", "a.tsv")) == [(3, "a\t1"), (5, ";b\t2")]
    assert list(read_lines("any", "a.tsv", comment=";")) == [(1, "# c"), (3, "a\t1")]


def test_what_is_not_there_is_named() -> None:
    with pytest.raises(DataError, match=r"none/at_all\.tsv: not in the package"):
        list(read_lines("tts", "none/at_all.tsv"))
