"""What is read as a word and what is spelled."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.tts.spelling import MAX_WORD, Speller, fold_greek, fold_latin

SPELLER = Speller(lambda word: word in ("nato", "it"))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("Hello", "hello"),
        ("NATO", "nato"),
        ("BBC", "B B C"),
        ("XKCD", "X K C D"),
        ("HELICOPTER", "helicopter"),
        ("pdf", "P D F"),
        ("a", "a"),
        ("b", "B"),
        ("I", "i"),
        ("don't", "don't"),
        ("don’t", "don't"),
        ("naïve", "naive"),
        ("straße", "strasse"),
        ("Ａ", "a"),
        ("κόσμος", "κόσμοσ"),
        ("ΚΟΣΜΟΣ", "κοσμοσ"),
        ("ΒΔ", "Β Δ"),
        ("β", "Β"),
        ("ο", "ο"),
        ("ἦν", "ήν"),
        ("привет", ""),
        ("你好", ""),
    ],
)
def test_words(text: str, words: str) -> None:
    assert " ".join(SPELLER.words(text)) == words


def test_long_words_come_in_pieces() -> None:
    assert [len(w) for w in SPELLER.words("la" * 70)] == [MAX_WORD, MAX_WORD, 20]


@given(st.text(min_size=1, max_size=20).filter(str.isalpha))
def test_any_letters(text: str) -> None:
    for word in SPELLER.words(text):
        assert word.islower() or len(word) == 1 or word == "I"
        assert all(c.isalpha() or c == "'" for c in word)


def test_folding() -> None:
    assert fold_latin("Ｃafé’s") == "Cafe's"
    assert fold_greek("Καλημέρας") == fold_greek("Καλημε\u0301ρας") == "καλημέρασ"
    assert fold_greek("ΜΑΪ́ΟΥ") == "μαΐου"
