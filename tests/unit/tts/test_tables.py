"""The tables of tts/data."""

from __future__ import annotations

import pytest

from fapstream.errors import DataError, UnknownLanguage
from fapstream.tts import tables


@pytest.mark.parametrize("lang", tables.LANGUAGES)
def test_every_phone_can_be_spoken(lang: str) -> None:
    phones = tables.phone_set(lang)
    assert "_" in phones
    for info in phones.values():
        assert 0 < info.min_ms <= info.mean_ms < 400
        assert info.kind in {"vowel", "stop", "affricate", "fricative", "nasal", "liquid", "glide", "silence"}
        assert info.voiced or info.kind not in {"vowel", "nasal", "liquid", "glide"}


def test_unknown_language() -> None:
    with pytest.raises(UnknownLanguage) as caught:
        tables.phone_set("fr")
    assert caught.value.known == tables.LANGUAGES


def test_missing_table_names_its_path() -> None:
    with pytest.raises(DataError, match=r"en/nothing\.tsv"):
        tables.read_text("en/nothing.tsv")


def test_a_row_with_too_many_fields_names_its_line() -> None:
    with pytest.raises(DataError) as caught:
        list(tables.read_rows("en/phones.tsv", 2))
    assert caught.value.line == 1


def test_comments_are_skipped_and_missing_fields_are_empty() -> None:
    rows = list(tables.read_rows("el/function_words.tsv", 5))
    assert rows[0][0] == 2
    assert all(len(fields) == 5 and fields[4] == "" for _, fields in rows)


def test_the_dictionary_notice_is_in_the_package() -> None:
    assert "Carnegie Mellon University" in tables.read_text("en/CMUDICT-LICENSE")
