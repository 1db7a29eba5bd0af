"""Numbers as words."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.tts.numerals import Numerals

EN, EL = Numerals("en"), Numerals("el")


@pytest.mark.parametrize(
    ("n", "english", "greek"),
    [
        (0, "zero", "μηδέν"),
        (13, "thirteen", "δεκατρία"),
        (21, "twenty one", "είκοσι ένα"),
        (100, "one hundred", "εκατό"),
        (101, "one hundred one", "εκατόν ένα"),
        (640, "six hundred forty", "εξακόσια σαράντα"),
        (1000, "one thousand", "χίλια"),
        (2004, "two thousand four", "δύο χιλιάδες τέσσερα"),
        (21_300, "twenty one thousand three hundred", "είκοσι μία χιλιάδες τριακόσια"),
        (1_000_001, "one million one", "ένα εκατομμύριο ένα"),
        (3_000_000_000, "three billion", "τρία δισεκατομμύρια"),
    ],
)
def test_cardinals(n: int, english: str, greek: str) -> None:
    assert " ".join(EN.cardinal(n)) == english
    assert " ".join(EL.cardinal(n)) == greek


@given(st.integers(0, 10**20))
def test_every_number_can_be_read_and_no_two_alike(n: int) -> None:
    for numerals in (EN, EL):
        words = numerals.cardinal(n)
        assert words
        assert all(word.islower() and " " not in word for word in words)
        assert words != numerals.cardinal(n + 1)


@pytest.mark.parametrize(
    ("year", "words"),
    [
        (1066, "ten sixty six"),
        (2004, "two thousand four"),
        (1900, "nineteen hundred"),
        (1905, "nineteen oh five"),
        (1984, "nineteen eighty four"),
        (2000, "two thousand"),
        (2026, "twenty twenty six"),
    ],
)
def test_years(year: int, words: str) -> None:
    assert " ".join(EN.year(year)) == words
    assert EL.year(year) == EL.cardinal(year)


@pytest.mark.parametrize(
    ("hour", "minute", "words"),
    [(21, 45, "twenty one forty five"), (8, 5, "eight oh five"), (0, 30, "zero thirty")],
)
def test_clock(hour: int, minute: int, words: str) -> None:
    assert " ".join(EN.hour(hour) + EN.minute(minute)) == words


@pytest.mark.parametrize(
    ("digits", "words"),
    [
        ("7", "seven"),
        ("52", "fifty two"),
        ("320", "three twenty"),
        ("300", "three hundred"),
        ("707", "seven oh seven"),
        ("1702", "seventeen oh two"),
        ("1700", "seventeen hundred"),
        ("2000", "two thousand"),
        ("007", "zero zero seven"),
        ("12345", "one two three four five"),
    ],
)
def test_numbers_in_names(digits: str, words: str) -> None:
    assert " ".join(EN.code(digits)) == words


@pytest.mark.parametrize(
    ("lower", "upper", "words"),
    [
        (2, 1, "half"),
        (2, 3, "halves"),
        (4, 3, "quarters"),
        (3, 1, "third"),
        (3, 2, "thirds"),
        (20, 7, "twentieths"),
    ],
)
def test_denominators(lower: int, upper: int, words: str) -> None:
    assert " ".join(EN.denominator(lower, upper)) == words


def test_decimals() -> None:
    assert EN.number("3", "14") == ["three", "point", "one", "four"]
    assert EL.number("3", "14") == ["τρία", "κόμμα", "δεκατέσσερα"]
    assert EL.number("3", "05") == ["τρία", "κόμμα", "μηδέν", "πέντε"]
    assert EN.number("007") == ["zero", "zero", "seven"]


@pytest.mark.parametrize(
    ("n", "words"),
    [(1, "first"), (12, "twelfth"), (20, "twentieth"), (21, "twenty first"), (100, "one hundredth")],
)
def test_english_ordinals(n: int, words: str) -> None:
    assert " ".join(EN.ordinal(n, "th")) == words
