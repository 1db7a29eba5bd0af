"""Kept text against the whole of it; words by samples; beginnings of sentences."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.stream import KeptText, SaidWord, SaidWords
from fapstream.stream.history import KEPT_TEXT, KEPT_WORDS, PIECE


@given(st.lists(st.tuples(st.text(max_size=8), st.integers(0, 60)), max_size=40), st.integers(0, 80))
def test_text_is_found_by_its_offsets(steps: list[tuple[str, int]], char: int) -> None:
    """Added to and cut anywhere, like a string, but that a cut beyond the end forgets what was before."""
    kept, whole, start = KeptText(), "", 0
    for text, cut in steps:
        kept.add(text, 0)
        whole += text
        if cut < 40:
            kept.cut(cut)
            if start <= cut <= len(whole):
                whole = whole[:cut]
            else:
                whole, start = " " * cut, cut
        assert kept.since(char) == whole[max(start, char) :]
        assert kept.before(char, 5) == whole[max(start, char - 5) : max(start, char)]


@pytest.mark.parametrize("size", [1, 7, 3000, 50_000])
def test_old_text_is_forgotten(size: int) -> None:
    """But never what waits to be spoken."""
    kept, total, waiting = KeptText(), 0, 100_000
    while total < 4 * KEPT_TEXT:
        total += size
        kept.add("x" * (size - 1) + "y", waiting=min(total, waiting))
        held = len(kept.since(0))
        assert total - kept.start == held
        assert min(total, waiting + KEPT_TEXT) <= held <= waiting + KEPT_TEXT + max(PIECE, size)
    assert len(kept._parts) < 200 or size > PIECE


def said(*words: tuple[int, int, int, int]) -> SaidWords:
    made = SaidWords()
    for word in words:
        made.add(SaidWord(*word))
    return made


def test_a_word_is_heard_from_its_first_sample_on() -> None:
    words = said((10, 20, 0, 3), (30, 40, 4, 7))
    assert words.at(9) is None
    assert [words.at(s).char_end for s in (10, 29, 30, 10**9)] == [3, 3, 7, 7]  # type: ignore[union-attr]


def test_a_cut_takes_the_words_from_it_on() -> None:
    words = said((10, 20, 0, 3), (30, 40, 4, 7))
    words.cut(30, 3)
    assert words.at(100) == SaidWord(10, 20, 0, 3)
    words.add(SaidWord(30, 50, 3, 9))
    words.cut(31, 9)
    assert words.at(100) == SaidWord(30, 50, 3, 9)


@settings(deadline=None, max_examples=5)
@given(st.integers(3 * KEPT_WORDS, 5 * KEPT_WORDS))
def test_old_words_are_forgotten(n: int) -> None:
    words = SaidWords()
    for k in range(n):
        words.add(SaidWord(10 * k, 10 * k + 9, 5 * k, 5 * k + 4))
        words.begin_phrase(5 * k)
    assert len(words._words) < 2 * KEPT_WORDS
    assert len(words._phrases) < 2 * KEPT_WORDS
    assert words.at(10 * n).char_start == 5 * (n - 1)  # type: ignore[union-attr]


TEXT = 'One, two. Dr. Who "came." \\:)300 <break/> Is it? Yes;\n\n  Title. So 3.5 it… is! End'
PHRASES = [0, 5, 10, TEXT.index("Is"), TEXT.index("Yes"), TEXT.index("Title"), TEXT.index("So"),
           TEXT.index("is!"), TEXT.index("End")]  # fmt: skip


def sentences(marks: str = "", upto: int = len(TEXT)) -> list[str]:
    words, kept = SaidWords(marks), KeptText()
    kept.add(TEXT, 0)
    for char in PHRASES:
        words.begin_phrase(char)
    found = [words.sentence(kept, upto, back) for back in range(12)]
    assert found == sorted(found, reverse=True)
    return [TEXT[at:].split()[0] for at in dict.fromkeys(found)]


def test_sentences_begin_where_a_phrase_does_after_a_closing_mark() -> None:
    """A comma closes no sentence; nor does the dot of `Dr.`, where no phrase begins."""
    assert sentences() == ["End", "is!", "So", "Title.", "Yes;", "Is", "Dr.", "One,"]
    assert sentences(upto=TEXT.index("it?")) == ["Is", "Dr.", "One,"]


def test_marks_of_the_language() -> None:
    words, kept = SaidWords(";\u037e"), KeptText()
    kept.add("τι; ναι", 0)
    for char in (0, 4):
        words.begin_phrase(char)
    assert words.sentence(kept, 5, 0) == 4
    assert words.sentence(kept, 5, 1) == 0


def test_the_oldest_sentence_is_one_whose_text_is_still_there() -> None:
    words, kept = SaidWords(), KeptText()
    for k in range(2000):
        words.begin_phrase(100 * k)
        kept.add("x" * 98 + ". ", 0)
    char = words.sentence(kept, 200_000, 10**6)
    assert kept.start <= char <= kept.start + 100
    assert len(kept.since(char)) == 200_000 - char
