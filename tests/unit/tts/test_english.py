"""English words to phones."""

from __future__ import annotations

import pytest

from fapstream.tts.english import english
from fapstream.tts.tables import phone_set, read_pairs, read_rows


@pytest.mark.parametrize(
    ("word", "phones"),
    [
        ("hello", "h @0 l @U1"),
        ("world", "w r=1 l d"),
        ("B", "b i1"),
        ("internet's", "I1 n t r=0 n E2 t s"),
        ("bosses'", "b O1 s I0 z"),
        ("googled", "g u1 g @0 l d"),
    ],
)
def test_words(word: str, phones: str) -> None:
    assert " ".join(english().word(word)) == phones


def test_compounds_and_unknown_words() -> None:
    assert not english().is_word("blorping")
    assert english().word("blorping")[-2:] == ("I0", "N")
    assert english().word("''") == ()


def test_weak_forms_and_the_before_vowels() -> None:
    assert english().phones(["the", "apple", "and", "the", "pear"])[0] == ("D", "i0")
    assert english().phones(["the", "apple", "and", "the", "pear"])[3] == ("D", "@0")
    assert english().phones(["a", "pear"])[0] == ("@0",)
    assert english().phones(["to", "eat"])[0] == ("t", "u0")
    assert english().phones(["to", "go"])[0] == ("t", "@0")
    assert english().phones(["go", "to"])[1] == ("t", "u1")


@pytest.mark.parametrize(
    ("word", "path"),
    [
        ("B", "letter"),
        ("hello", "lexicon"),
        ("googlings", "stem"),
        ("skyhouse", "compound"),
        ("zorblax", "tree"),
    ],
)
def test_the_path_is_told(word: str, path: str) -> None:
    assert english().path(word) == path


def test_the_tables_name_phones_of_the_language() -> None:
    rows = [row for _, row in read_rows("en/function_words.tsv", 4)]
    written = [row[1] for row in rows] + [row[3] for row in rows]
    written += list(read_pairs("en/letters.tsv").values())
    phones = phone_set("en")
    for token in " ".join(written).split():
        name = token[:-1] if token[-1].isdigit() else token
        assert (phones[name].kind == "vowel") == token[-1].isdigit(), token


def test_words_of_the_news_that_cmudict_lacks() -> None:
    """Every one of the table, in phones that there are, once, and not one that the lexicon has already."""
    phones, lexicon = phone_set("en"), set(english().lexicon_words())
    rows = [row for _, row in read_rows("en/recent.tsv", 2)]
    assert [word for word, _ in rows] == sorted({word for word, _ in rows} - lexicon)
    for word, spoken in rows:
        for token in spoken.split():
            name = token.rstrip("012")
            assert (phones[name].kind == "vowel") == (name != token), word
        assert sum(token.endswith("1") for token in spoken.split()) == 1, word
    assert english().word("covid") == ("k", "@U1", "v", "I0", "d")
    assert english().path("covid") == "lexicon"
    assert english().word("houthis") == ("h", "u1", "T", "i0", "z")
    assert english().word("kyiv's")[-2:] == ("v", "z")
    assert english().is_word("covid")


def test_a_homograph_has_several_readings() -> None:
    readings = [" ".join(phones) for phones in english().readings("record")]
    assert sorted(readings) == ["r E1 k r=0 d", "r I0 k O1 r d"]
    assert english().readings("rivers") == (english().word("rivers"),)
