"""The composed languages."""

from __future__ import annotations

import pytest

from fapstream.errors import UnknownLanguage
from fapstream.tts.language import language
from fapstream.tts.tables import read_rows


@pytest.mark.parametrize("name", ["en", "el"])
def test_a_language_is_made_once_and_is_whole(name: str) -> None:
    rooms = language(name)
    assert rooms is language(name)
    assert rooms.cut_before
    assert all(stop.pause_ms >= 0 and 0 <= stop.reset <= 1 for stop in rooms.stops.values())
    assert {"comma", "sentence", "question", "line", "smiley", "open"} <= set(rooms.stops)


def test_question_words() -> None:
    assert language("en").asks_with_word(["where", "is", "it"])
    assert language("en").asks_with_word(["and", "what"])
    assert not language("en").asks_with_word(["is", "it", "what"])
    assert language("el").asks_with_word(["ποιοσ", "είναι"])


def test_unknown() -> None:
    with pytest.raises(UnknownLanguage):
        language("tlh")


@pytest.mark.parametrize("name", ["en", "el"])
def test_abbreviations_can_be_spoken(name: str) -> None:
    for row in (row for _, row in read_rows(f"{name}/abbreviations.tsv", 3)):
        assert row[2] in ("", "end", "number"), row
        assert all(language(name).pronounce(row[1].split())), row
