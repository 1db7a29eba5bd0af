"""Written English to spoken words: the cases of normalise_en.tsv, and what must hold for any text."""

from __future__ import annotations

import re
import time
from itertools import product
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.records import Word
from fapstream.tts.frontend import FrontEnd

CASES = [
    line.split("\t")
    for line in (Path(__file__).parent / "cases" / "normalise_en.tsv").read_text("utf-8").splitlines()
    if line and not line.startswith("; ")
]
SPOKEN = re.compile(r"[a-z][a-z']*|[α-ωάέήίόύώϊϋΐΰ]+|[A-ZΑ-Ω]")
PIECES = [text for text, _ in CASES]
LETTERS = "aA1 9.,-–—/:;'’\"$€£%°#@&+*=_()[]{}<>|~^½²₂مπ٣😂🇬❤️\u00ad\u200b\u2060…\nIVXmkKst"


def words(*fragments: str) -> list[Word]:
    """What is read; a long number that is cut between two utterances counts once."""
    front = FrontEnd("en")
    found = [u for f in fragments for u in front.feed(f)] + front.end()
    said = [word for utterance in found for word in utterance.words]
    return [word for i, word in enumerate(said) if i == 0 or word != said[i - 1]]


def read(text: str) -> str:
    return " ".join(str(spoken) for word in words(text) for spoken in word.spoken)


@pytest.mark.parametrize(("text", "spoken"), CASES, ids=[text for text, _ in CASES])
def test_case(text: str, spoken: str) -> None:
    assert read(text) == spoken


def test_there_are_many_cases() -> None:
    assert len(CASES) >= 450
    assert len({text for text, _ in CASES}) == len(CASES)


@settings(max_examples=150, deadline=None)
@given(
    st.text(max_size=120)
    | st.text(LETTERS, max_size=120)
    | st.lists(st.sampled_from(PIECES) | st.text(LETTERS, max_size=6), max_size=6).map(" ".join)
)
def test_any_text_gives_items_in_order_with_words_that_can_be_said(text: str) -> None:
    at = 0
    for word in words(text):
        assert at <= word.start < word.end <= len(text)
        assert "".join(text[word.start : word.end].split()) == "".join(word.text.split())
        assert word.spoken
        for spoken in word.spoken:
            assert SPOKEN.fullmatch(str(spoken)), (text, word)
        at = word.end


@settings(max_examples=60, deadline=None)
@given(st.lists(st.sampled_from(PIECES), min_size=1, max_size=4).map(" ".join), st.integers(1, 9))
def test_fragments_do_not_matter(text: str, size: int) -> None:
    whole = words(text)
    assert words(*text) == whole
    assert words(*(text[at : at + size] for at in range(0, len(text), size))) == whole


@pytest.mark.parametrize(
    "token",
    [
        (a + b + c) * (200 // len(a + b + c))
        for a, b, c in product(("1", "12", "a", "A1"), (",", ".", "-", "/", ":", "x", "@"), ("2", "b", "000"))
    ]
    + ["1" * 200, "I" * 200, "$" * 200, "-" * 199 + "1", "1 " * 100, "$1 " * 60, "1,000 " * 30, "😂" * 200],
)
def test_long_tokens_are_read_fast(token: str) -> None:
    words(token)
    best = 1.0
    for _ in range(3):
        begin = time.process_time()
        words(token)
        best = min(best, time.process_time() - begin)
    assert best < 0.15
