"""Numbers as words."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.tts.numerals import Numerals, greek_ending

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


def test_greek_genders() -> None:
    assert EL.cardinal(1, "f") == ["μία"]
    assert EL.cardinal(4, "m") == ["τέσσερις"]
    assert EL.cardinal(200, "f") == ["διακόσιες"]
    assert EL.cardinal(304, "m") == ["τριακόσιοι", "τέσσερις"]
    assert EL.cardinal(1000, "f") == ["χίλιες"]
    assert EL.gender_before("ώρες", "3") == "f"
    assert EL.gender_before("άνδρας", "1") == "m"
    assert EL.gender_before("παιδιά", "3") == ""


@pytest.mark.parametrize(
    ("year", "words"),
    [
        (1066, "one thousand sixty six"),
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
    ("time", "english", "greek"),
    [
        ((21, 45), "twenty one forty five", "είκοσι μία και σαράντα πέντε"),
        ((9, 0), "nine o'clock", "εννέα"),
        ((21, 0), "twenty one hundred", "είκοσι μία"),
        ((0, 0), "zero hundred", "μηδέν"),
        ((8, 5), "eight oh five", "οκτώ και πέντε"),
        ((3, 1, 2), "three oh one and two", "τρεις και ένα και δύο"),
    ],
)
def test_clock(time: tuple[int, ...], english: str, greek: str) -> None:
    assert " ".join(EN.clock(*time)) == english
    assert " ".join(EL.clock(*time)) == greek


def test_decimals() -> None:
    assert EN.number("3", "14") == ["three", "point", "one", "four"]
    assert EL.number("3", "14") == ["τρία", "κόμμα", "δεκατέσσερα"]
    assert EL.number("3", "05") == ["τρία", "κόμμα", "μηδέν", "πέντε"]
    assert EN.number("007") == ["zero", "zero", "seven"]


def test_money() -> None:
    assert " ".join(EN.money("$", "2", "50")) == "two dollars and fifty cents"
    assert " ".join(EN.money("$", "1")) == "one dollar"
    assert " ".join(EN.money("£", "0", "01")) == "zero pounds and one penny"
    assert " ".join(EN.money("€", "2", "5")) == "two point five euros"
    assert " ".join(EL.money("€", "12", "30")) == "δώδεκα ευρώ και τριάντα λεπτά"
    assert " ".join(EL.money("£", "3")) == "τρεις λίρες"


@pytest.mark.parametrize(
    ("n", "words"),
    [(1, "first"), (12, "twelfth"), (20, "twentieth"), (21, "twenty first"), (100, "one hundredth")],
)
def test_english_ordinals(n: int, words: str) -> None:
    assert " ".join(EN.ordinal(n, "th")) == words


@pytest.mark.parametrize(
    ("n", "suffix", "words"),
    [
        (1, "ος", "πρώτος"),
        (5, "η", "πέμπτη"),
        (11, "ο", "ενδέκατο"),
        (21, "η", "εικοστή πρώτη"),
        (20, "ου", "εικοστού"),
        (112, "ος", "εκατοστός δωδέκατος"),
        (1821, "ο", "χιλιοστό"),
    ],
)
def test_greek_ordinals(n: int, suffix: str, words: str) -> None:
    spoken = " ".join(EL.ordinal(n, suffix))
    assert spoken.startswith(words) if n != 1821 else spoken == " ".join(EL.cardinal(1821))


def test_greek_ending() -> None:
    assert greek_ending("εικοστ", "οι") == "εικοστοί"
    assert greek_ending("πρώτ", "ης") == "πρώτης"
    assert greek_ending("εικοστ", "ους") == "εικοστούς"


def test_decades() -> None:
    assert EN.decade(1990) == ["nineteen", "nineties"]
    assert EN.decade(2000) == ["two", "thousands"]
