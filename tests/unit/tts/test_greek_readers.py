"""How what Greek patterns find is read, in the words around it."""

from __future__ import annotations

import pytest

from fapstream.tts.frontend import FrontEnd


def read(text: str) -> str:
    front = FrontEnd("el")
    found = front.feed(text) + front.end()
    return " ".join(str(s) for u in found for w in u.words for s in w.spoken).replace("ς", "σ")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("τους 3 άνδρες", "τουσ τρεισ άνδρεσ"),
        ("των 13 γυναικών", "των δεκατριών γυναικών"),
        ("με 1 ώρα", "με μία ώρα"),
        ("τις 1.500 ψήφους", "τισ χίλιεσ πεντακόσιεσ ψήφουσ"),
        ("η 1η Μαΐου", "η πρώτη μαΐου"),
        ("του 21ου αιώνα", "του εικοστού πρώτου αιώνα"),
        ("2 χλμ.", "δύο χιλιόμετρα"),
        ("3/4", "τρία τέταρτα"),
        ("ένα 24ωρο", "ένα εικοσιτετράωρο"),
        ("ο 15χρονος", "ο δεκαπεντάχρονοσ"),
        ("+5%", "συν πέντε τοισ εκατό"),
    ],
)
def test_numbers_agree(text: str, words: str) -> None:
    assert read(text) == words


def test_addresses_are_read_in_pieces() -> None:
    assert read("nikos@example.gr").split()[:2] == ["nikos", "παπάκι"]
