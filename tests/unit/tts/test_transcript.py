"""The words that a transcript is read as."""

from __future__ import annotations

import pytest

from fapstream.tts.transcript import wanted


def test_numbers_and_abbreviations_are_the_words_they_are_read_as() -> None:
    words = wanted("At 5 pm Dr. Smith paid $3.50.")
    assert [w.spoken for w in words] == [
        *("at", "five", "p", "m", "doctor", "smith", "paid", "three", "dollars", "and", "fifty", "cents")
    ]
    assert [(w.written.text, w.written.start) for w in words[1:4]] == [("5", 3), ("pm", 5), ("pm", 5)]
    assert words[2].readings == (("P", "IY1"),)


def test_the_reading_that_fits_the_words_around_comes_first() -> None:
    (noun, *_), (verb, *_) = (
        next(w for w in wanted(text) if w.spoken == "record").readings
        for text in ("She broke the record.", "They want to record it.")
    )
    assert noun == ("R", "EH1", "K", "ER0", "D")
    assert verb == ("R", "IH0", "K", "AO1", "R", "D")


def test_weak_forms_have_the_strong_one_beside_them() -> None:
    at = wanted("At home.")[0]
    assert at.readings == (("AH0", "T"), ("AE1", "T"))


def test_words_of_another_script_have_phones_alone() -> None:
    (word,) = wanted("Γεια")
    assert word.spoken == ""
    assert word.readings == (("Y", "AA1"),)


@pytest.mark.parametrize("text", ["", " \n", "?!", "...", "— “” *"])
def test_no_words(text: str) -> None:
    assert wanted(text) == []


def test_a_long_text_has_every_word_once() -> None:
    """Phrases without a mark are cut, and no word is read twice or lost for that."""
    text = "one two three four five " * 60
    assert [w.spoken for w in wanted(text)] == text.split()
