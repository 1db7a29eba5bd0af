"""Greek numbers as words."""

from __future__ import annotations

import pytest

from fapstream.tts.numerals import Numerals, greek_ending

EL = Numerals("el")


@pytest.mark.parametrize(
    ("n", "gender", "words"),
    [
        (1, "f", "μία"),
        (1, "ma", "έναν"),
        (1, "fg", "μιας"),
        (4, "m", "τέσσερις"),
        (13, "g", "δεκατριών"),
        (200, "f", "διακόσιες"),
        (200, "ma", "διακόσιους"),
        (304, "m", "τριακόσιοι τέσσερις"),
        (400, "g", "τετρακοσίων"),
        (1000, "f", "χίλιες"),
        (1001, "ma", "χίλιους έναν"),
        (3000, "g", "τριών χιλιάδων"),
        (3400, "m", "τρεις χιλιάδες τετρακόσιοι"),
        (1_000_000, "g", "ενός εκατομμυρίου"),
        (4_200_000, "fg", "τεσσάρων εκατομμυρίων διακοσίων χιλιάδων"),
    ],
)
def test_forms_of_cardinals(n: int, gender: str, words: str) -> None:
    assert " ".join(EL.cardinal(n, gender)) == words


@pytest.mark.parametrize(
    ("n", "suffix", "words"),
    [
        (1, "ος", "πρώτος"),
        (5, "η", "πέμπτη"),
        (11, "ο", "ενδέκατο"),
        (21, "η", "εικοστή πρώτη"),
        (20, "ου", "εικοστού"),
        (112, "ος", "εκατοστός δωδέκατος"),
        (200, "ο", "διακοσιοστό"),
        (1821, "ο", "χιλιοστό οκτακοσιοστό εικοστό πρώτο"),
    ],
)
def test_ordinals(n: int, suffix: str, words: str) -> None:
    assert " ".join(EL.ordinal(n, suffix)) == words


def test_ordinals_without_a_stem_are_cardinals() -> None:
    assert EL.ordinal(10_000, "ο") == EL.cardinal(10_000)


def test_endings() -> None:
    assert greek_ending("εικοστ", "οι") == "εικοστοί"
    assert greek_ending("πρώτ", "ης") == "πρώτης"
    assert greek_ending("εικοστ", "ους") == "εικοστούς"


def test_decimals() -> None:
    assert EL.number("3", "14") == ["τρία", "κόμμα", "δεκατέσσερα"]
    assert EL.number("3", "05") == ["τρία", "κόμμα", "μηδέν", "πέντε"]
    assert EL.number("3", "4", "g") == ["τριών", "κόμμα", "τεσσάρων"]


def test_halves() -> None:
    assert EL.half(1, "f") == "μιάμιση"
    assert EL.half(2, "f") == EL.half(2) == "δυόμισι"
    assert EL.half(77) == ""
