"""Greek words to phones."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.tts.greek import greek
from fapstream.tts.tables import phone_set


@pytest.mark.parametrize(
    ("word", "phones"),
    [
        ("καλημέρα", "k a0 l i0 m e1 r a0"),
        ("ευχαριστώ", "e0 f x a0 r i0 s t o1"),
        ("αύριο", "a1 v r i0 o0"),
        ("κόσμοσ", "k o1 z m o0 s"),
        ("άγγελοσ", "a1 N gj e0 l o0 s"),
        ("γκολ", "g o1 l"),
        ("μπαμπάσ", "b a0 m b a1 s"),
        ("παιδιά", "p e0 D j a1"),
        ("χέρι", "C e1 r i0"),
        ("χαρά", "x a0 r a1"),
        ("εκκλησία", "e0 k l i0 s i1 a0"),
        ("ξύλο", "k s i1 l o0"),
        ("μια", "m J a0"),
        ("ποιοσ", "p C o1 s"),
        ("χιόνι", "C o1 n i0"),
        ("γιορτή", "j o0 r t i1"),
        ("μαϊμού", "m a0 i0 m u1"),
        ("τζάμι", "dz a1 m i0"),
        ("καλημερα", "k a0 l i0 m e1 r a0"),
        ("του", "t u0"),
        ("φωσ", "f o1 s"),
        ("Β", "v i1 t a0"),
    ],
)
def test_words(word: str, phones: str) -> None:
    assert " ".join(greek().word(word)) == phones


def test_words_act_on_each_other() -> None:
    assert greek().phones(["τουσ", "βλέπω"])[0][-1] == "z"
    assert greek().phones(["τουσ", "παίρνω"])[0][-1] == "s"
    assert greek().phones(["τον", "πατέρα"]) == [("t", "o0", "m"), ("b", "a0", "t", "e1", "r", "a0")]
    assert greek().phones(["στην", "κόρη"])[1][0] == "g"
    assert greek().phones(["την", "άλλη"])[0][-1] == "n"


@given(st.lists(st.text("αβγδεζηθικλμνξοπρστυφχψωάέήίόύώϊϋΐΰ", min_size=1, max_size=15), max_size=6))
def test_any_letters_give_phones_of_the_language(words: list[str]) -> None:
    phones = phone_set("el")
    found = greek().phones(words)
    assert len(found) == len(words)
    for tokens in found:
        for token in tokens:
            name = token[:-1] if token[-1].isdigit() else token
            assert (phones[name].kind == "vowel") == token[-1].isdigit()
