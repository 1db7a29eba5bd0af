"""How what patterns find is read, reader by reader, in English."""

from __future__ import annotations

import re

import pytest

from fapstream.tts.language import language
from fapstream.tts.numerals import Numerals
from fapstream.tts.patterns import Found, Vocabulary
from fapstream.tts.readers import Readers, roman

READERS = Readers(
    Numerals("en"), Vocabulary("en/vocabulary.tsv"), language("en").normalise._speller.words
).table()


def read(reader: str, text: str, other: str = "") -> str:
    match = re.fullmatch(r"(?P<a>.*?)(?:\|(?P<b>.*))?", f"{text}|{other}" if other else text)
    assert match
    return " ".join(READERS[reader](Found(match, ""), "a", "b" if other else ""))


@pytest.mark.parametrize(
    ("reader", "text", "words"),
    [
        ("text", "Hello, you!", "hello you"),
        ("spell", "aB-1é", "A B one E"),
        ("digits", "555-01", "five five five zero one"),
        ("cardinal", "1,234", "one thousand two hundred thirty four"),
        ("number", "-3.05", "minus three point zero five"),
        ("number", "+1,000", "plus one thousand"),
        ("year", "1984", "nineteen eighty four"),
        ("decade", "1990", "nineteen nineties"),
        ("hour", "0", "zero"),
        ("minute", "05", "oh five"),
        ("ordinal", "21", "twenty first"),
        ("roman", "XIV", "fourteen"),
        ("roman_ordinal", "VIII", "eighth"),
    ],
)
def test_readers(reader: str, text: str, words: str) -> None:
    assert read(reader, text) == words


def test_fractions_by_their_numerator() -> None:
    assert read("fraction", "4", "1") == "quarter"
    assert read("fraction", "3", "2") == "thirds"
    assert read("fraction", "21", "5") == "twenty firsts"


@pytest.mark.parametrize(
    ("text", "value"), [("I", 1), ("IV", 4), ("XLII", 42), ("MCMXCIV", 1994), ("viii", 8)]
)
def test_roman(text: str, value: int) -> None:
    assert roman(text) == value
