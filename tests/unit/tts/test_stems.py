"""Words from the words they are made of."""

from __future__ import annotations

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.tts.english import english
from fapstream.tts.stems import Stems, past, plural
from fapstream.tts.tables import phone_set, read_pairs, read_rows

KNOWN = {
    "cat": "k {1 t",
    "dog": "d O1 g",
    "box": "b A1 k s",
    "judge": "dZ V1 dZ",
    "stop": "s t A1 p",
    "love": "l V1 v",
    "happy": "h {1 p i0",
    "want": "w A1 n t",
    "google": "g u1 g @0 l",
    "house": "h aU1 s",
    "weather": "w E1 D r=0",
    "water": "w O1 t r=0",
    "school": "s k u1 l",
    "carry": "k {1 r i0",
    "lower": "l @U1 r=0",
    "real": "r i1 @0 l",
    "broad": "b r O1 d",
    "rat": "r {1 t",
    "rate": "r EI1 t",
    "web": "w E1 b",
    "cam": "k {1 m",
}
STEMS = Stems(lambda word: tuple(KNOWN[word].split()) if word in KNOWN else None)


@pytest.mark.parametrize(
    ("word", "phones"),
    [
        ("cats", "k {1 t s"),
        ("dogs", "d O1 g z"),
        ("boxes", "b A1 k s I0 z"),
        ("judges", "dZ V1 dZ I0 z"),
        ("carries", "k {1 r i0 z"),
        ("carried", "k {1 r i0 d"),
        ("stopped", "s t A1 p t"),
        ("loved", "l V1 v d"),
        ("wanted", "w A1 n t I0 d"),
        ("stopping", "s t A1 p I0 N"),
        ("loving", "l V1 v I0 N"),
        ("happiest", "h {1 p i0 @0 s t"),
        ("happiness", "h {1 p i0 n @0 s"),
        ("loveless", "l V1 v l @0 s"),
        ("cat's", "k {1 t s"),
        ("judge's", "dZ V1 dZ I0 z"),
        ("dogs'", "d O1 g z"),
        ("boxes'", "b A1 k s I0 z"),
        ("googled's", "g u1 g @0 l d z"),
        ("cat'll", "k {1 t @0 l"),
        ("really", "r i1 @0 l i0"),
        ("broadly", "b r O1 d l i0"),
        ("rating", "r EI1 t I0 N"),
        ("ratting", "r {1 t I0 N"),
        ("wanting", "w A1 n t I0 N"),
        ("catproof", "k {1 t p r u2 f"),
    ],
)
def test_endings(word: str, phones: str) -> None:
    assert STEMS.inflected(word) == tuple(phones.split())


@pytest.mark.parametrize(
    "word", ["cat", "zorbs", "zorb's", "s", "'s", "s'", "ing", "unzorb", "as", "x" * 500 + "s"]
)
def test_what_has_no_stem(word: str) -> None:
    assert STEMS.inflected(word) is None


@pytest.mark.parametrize(
    ("word", "phones"),
    [
        ("skyhouse", None),
        ("dogloves", None),
        ("weatherwater", "w E1 D r=0 w O2 t r=0"),
        ("lowerschool", None),
        ("webcam", "w E1 b k {2 m"),
        ("dog", None),
        ("doghouse", "d O1 g h aU2 s"),
        ("dogwant", None),
        ("a" * 300, None),
    ],
)
def test_compounds(word: str, phones: str | None) -> None:
    assert STEMS.compound(word) == (tuple(phones.split()) if phones else None)


def test_the_lexicons_own_words() -> None:
    assert english().word("bosses'") == ("b", "O1", "s", "I0", "z")
    assert english().word("googled's") == ("g", "u1", "g", "@0", "l", "d", "z")


def test_plural_and_past() -> None:
    assert plural(("k", "{1", "t"))[-1] == "s"
    assert plural(("d", "O1", "g"))[-1] == "z"
    assert plural(("b", "@1", "s"))[-2:] == ("I0", "z")
    assert past(("w", "A1", "n", "t"))[-2:] == ("I0", "d")
    assert past(("l", "{1", "f"))[-1] == "t"


def test_the_tables_name_phones_and_words() -> None:
    phones = phone_set("en")
    written = [row[2] for _, row in read_rows("en/endings.tsv", 3)]
    for token in " ".join(written).split():
        name = token[:-1] if token[-1] in "012" else token
        assert token in ("PLURAL", "PAST", "LY") or (phones[name].kind == "vowel") == (token[-1] in "012"), (
            token
        )
    for words in read_pairs("en/compounds.tsv").values():
        assert all(english().is_word(word) for word in words.split())


@given(st.text("abcdefghijklmnopqrstuvwxyz'", max_size=60))
def test_any_word(word: str) -> None:
    known = set(phone_set("en"))
    for tokens in (english().word(word), STEMS.inflected(word), STEMS.compound(word)):
        assert {t[:-1] if t[-1] in "012" else t for t in tokens or ()} <= known


def test_an_endless_word_takes_no_time() -> None:
    begin = time.process_time()
    for word in ("over" * 15, "s" * 60, "un" * 30, "catcat" * 10):
        english().word(word)
    assert time.process_time() - begin < 0.5
