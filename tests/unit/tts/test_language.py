"""The composed languages."""

from __future__ import annotations

import pytest

from fapstream.errors import UnknownLanguage
from fapstream.tts.language import language
from fapstream.tts.patterns import Vocabulary


@pytest.mark.parametrize("name", ["en", "el"])
def test_a_language_is_made_once_and_is_whole(name: str) -> None:
    rooms = language(name)
    assert rooms is language(name)
    assert rooms.cut_before


def test_question_words() -> None:
    assert language("en").asks_with_word(["where", "is", "it"])
    assert language("en").asks_with_word(["and", "what"])
    assert not language("en").asks_with_word(["is", "it", "what"])
    assert language("el").asks_with_word(["ποιοσ", "είναι"])


def test_unknown() -> None:
    with pytest.raises(UnknownLanguage):
        language("tlh")


@pytest.mark.parametrize("name", ["en", "el"])
def test_the_vocabulary_can_be_spoken(name: str) -> None:
    vocabulary = Vocabulary(f"{name}/vocabulary.tsv")
    assert {"abbreviation", "symbol", "sign", "unit", "scale", "month"} <= set(vocabulary.classes)
    assert set(vocabulary.ends.values()) <= {"", "end", "number"}
    for kind, entries in vocabulary.classes.items():
        for written, entry in entries.items():
            readings = [entry.one] if kind == "abbreviation" else [entry.one, entry.many]
            for reading in (r for r in readings if not r.isdecimal()):  # the value of a numeral
                assert all(language(name).pronounce(reading.split())), (written, reading)
