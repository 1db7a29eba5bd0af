"""Words of either script in either language."""

from __future__ import annotations

import pytest

from fapstream.errors import UnknownLanguage
from fapstream.tts.pronounce import Pronouncer, script
from fapstream.tts.tables import LANGUAGES, phone_set, read_pairs


def test_each_word_is_read_by_its_own_language() -> None:
    assert Pronouncer("en")(["γεια", "world"]) == [("j", "A1"), ("w", "r=1", "l", "d")]
    assert Pronouncer("el")(["web"]) == [("u0", "e1", "b")]
    assert Pronouncer("el")(["bird"]) == [("b", "e1", "r", "d")]
    assert Pronouncer("el")(["γεια"]) == [("j", "a1")]


@pytest.mark.parametrize(("lang", "foreign"), [("en", "el"), ("el", "en")])
def test_every_foreign_phone_has_a_place_here(lang: str, foreign: str) -> None:
    nearest = read_pairs(f"{lang}/from_{foreign}.tsv")
    here, there = phone_set(lang), phone_set(foreign)
    for name, info in there.items():
        mapped = nearest.get(name, name).split()
        assert all(phone in here for phone in mapped), name
        assert info.kind != "vowel" or here[mapped[0]].kind == "vowel", name
    assert set(nearest) <= set(there)


def test_scripts() -> None:
    assert [script(w) for w in ("abc", "αβγ", "A", "Β")] == ["en", "el", "en", "el"]
    assert LANGUAGES == ("en", "el")


def test_unknown_language() -> None:
    with pytest.raises(UnknownLanguage):
        Pronouncer("xx")
