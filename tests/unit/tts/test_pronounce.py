"""Words of either script in either language."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.errors import UnknownLanguage
from fapstream.tts.pronounce import LEFT, Pronouncer, script
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


def test_phones_that_are_given_stay_and_part_their_neighbours() -> None:
    given = ("t", "E1", "s", "t")
    assert Pronouncer("en")(["the", given, "apple"])[1] == given
    assert Pronouncer("el")([("s", "a1"), "γεια"]) == [("s", "a1"), ("j", "a1")]
    assert not Pronouncer("en").needs_next(given)
    assert Pronouncer("en").path(given) == "user"


WORDS = {
    "en": ["the", "a", "to", "apple", "car", "of", "and", "hour", "B", "βήτα", ("t", "i1")],
    "el": ["τον", "πατέρα", "κόσμο", "την", "ο", "δεν", "μουσ", "βάζο", "web", "Β", ("t", "i1")],
}


@pytest.mark.parametrize("lang", LANGUAGES)
@given(st.data())
def test_a_word_needs_only_its_neighbours(lang: str, data: st.DataObject) -> None:
    """Pronounced one at a time, with what needs_next asks for, words sound as in the whole phrase."""
    reader = Pronouncer(lang)
    words = data.draw(st.lists(st.sampled_from(WORDS[lang]), min_size=1, max_size=8))
    whole = reader(words)
    for i, word in enumerate(words):
        before = words[max(0, i - LEFT) : i]
        end = i + 2 if reader.needs_next(word) else i + 1
        assert reader([*before, *words[i:end]], len(before))[0] == whole[i]


def test_unknown_language() -> None:
    with pytest.raises(UnknownLanguage):
        Pronouncer("xx")
