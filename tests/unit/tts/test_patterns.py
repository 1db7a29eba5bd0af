"""The engine of patterns on tables made for it, and the tables of the languages."""

from __future__ import annotations

import pytest

from fapstream.errors import DataError
from fapstream.tts import patterns as module
from fapstream.tts.language import language
from fapstream.tts.patterns import Found, Patterns, Reading, Vocabulary, Words
from fapstream.tts.tables import LANGUAGES

VOCABULARY = """
month\tMay\tmay
month\tJan.|January\tjanuary
unit\tkm\tkilometer\tkilometers
sign\t$\tdollar\tdollars
sign\tUS$\tU S dollar\tU S dollars
abbreviation\tetc.\tet cetera\tend
spelled\tBBC\t
spoken\tNATO\t
""".strip()

PATTERNS = r"""
going_on	unit month
macro	number	\d+(?:\.\d+)?
month	(?P<m>{month}) (?P<d>\d+)	$m:month $d:digits
sign	(?P<s>{sign})(?P<n>{number})	$n:digits $s:sign:n
digit	(?P<n>{number}) ?(?P<u>{unit})	$n:digits $u:unit:n
digit	(?P<a>\d+)-(?P<b>\d+)	from $a:digits [ to $b:digits ]
digit after (?i:no)	(?P<n>\d+)	number $n:digits
digit	(?P<n>\d+)s	$n:digits 's
digit	(?P<n>\d+)~	$n:digits
""".strip()


def digits(found: Found, group: str, other: str) -> Words:
    return [c for c in found.text(group) if c.isdigit()]


@pytest.fixture
def tables(monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """Tables by path, that a test may change."""
    made = {"v": VOCABULARY, "p": PATTERNS}

    def rows(path: str, columns: int) -> list[tuple[int, list[str]]]:
        lines = [(n, line) for n, line in enumerate(made[path].splitlines(), 1) if line]
        return [(n, (line.split("\t") + [""] * columns)[:columns]) for n, line in lines]

    monkeypatch.setattr(module, "read_rows", rows)
    return made


def made() -> Patterns:
    return Patterns("p", Vocabulary("v"), {"digits": digits})


def read(where: str, text: str, before: str = "") -> list[Reading] | None:
    found = made().read(where, text, 0, before)
    return found[0] if found else None


def test_groups_are_read_in_their_order_with_their_places(tables: dict[str, str]) -> None:
    assert read("month", "May 15 x") == [Reading(["may"], 0, 3), Reading(["1", "5"], 4, 6)]
    assert read("month", "January 2") == [Reading(["january"], 0, 7), Reading(["2"], 8, 9)]
    assert read("digit", "1 km") == [Reading(["1"], 0, 1), Reading(["kilometer"], 2, 4)]
    assert read("digit", "2km") == [Reading(["2"], 0, 1), Reading(["kilometers"], 1, 3)]


def test_what_is_said_out_of_order_is_one_reading(tables: dict[str, str]) -> None:
    assert read("sign", "US$5") == [Reading(["5", "U", "S", "dollars"], 0, 4)]


def test_literals_options_endings_and_conditions(tables: dict[str, str]) -> None:
    assert read("digit", "3-4") == [Reading(["from", "3"], 0, 1), Reading(["to", "4"], 2, 3)]
    assert read("digit", "7s") == [Reading(["7's"], 0, 2)]
    assert read("digit", "7", before="No") == [Reading(["number", "7"], 0, 1)]
    assert read("digit", "7", before="so") == [Reading(["7"], 0, 1)]
    assert read("digit", "7x") == [Reading(["7"], 0, 1)], "~ lets a letter follow"
    assert read("month", "May x") is None
    assert read("nowhere", "1") is None


def test_the_word_after(tables: dict[str, str]) -> None:
    seen = []

    def noting(found: Found, group: str, other: str) -> Words:
        seen.append((found.before, found.after))
        return ["x"]

    Patterns("p", Vocabulary("v"), {"digits": noting}).read("digit", "5 «Ώρες»", 0, "Σε")
    assert seen == [("σε", "ώρες")]


def test_the_vocabulary(tables: dict[str, str]) -> None:
    vocabulary = Vocabulary("v")
    assert vocabulary.ends == {"etc.": "end"}
    assert vocabulary.known["BBC"].one == "B B C"
    assert vocabulary.known["NATO"].one == "nato"
    assert vocabulary.entry("month", "MAY".title()) is not None
    assert vocabulary.gender("km") == ""


@pytest.mark.parametrize(
    "line",
    [
        "digit\t(\\d+\t$n",
        "digit\t(?P<n>\\d+)\t$m:digits",
        "digit\t(?P<n>\\d+)\t$n:nobody",
        "digit\t{nothing}\tx",
        "digit\t\\d\t[ x",
        "digit\t\\d\tx ]",
        "digit\t(?P<n>\\d)\t$n:unit:q",
    ],
)
def test_what_makes_no_sense_is_named(tables: dict[str, str], line: str) -> None:
    tables["p"] = line
    with pytest.raises(DataError, match="p"):
        made().check()


def test_a_vocabulary_without_a_word(tables: dict[str, str]) -> None:
    tables["v"] = "unit\t\tx"
    with pytest.raises(DataError, match="v:1"):
        Vocabulary("v")


@pytest.mark.parametrize("lang", LANGUAGES)
def test_the_patterns_of_the_languages_make_sense(lang: str) -> None:
    language(lang).normalise._patterns.check()
