"""Characters to tokens."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.tts.segment import MAX_TOKEN, NewLine, Piece, Scanner, Segmenter, Token, core, ends_before

ABBREVIATIONS = {"Dr.": "", "etc.": "end", "No.": "number"}


def runs(*fragments: str) -> list[tuple[str, int] | NewLine]:
    scanner = Scanner()
    found = [event for f in fragments for event in scanner.feed(f)] + scanner.end()
    return [contents(event) for event in found]


def contents(event: Piece) -> tuple[str, int] | NewLine:
    """What can be compared."""
    return event if isinstance(event, NewLine) else (event.text, event.start)


def tokens(text: str, lang: str = "en") -> list[Token]:
    segmenter = Segmenter(lang, ABBREVIATIONS)
    return [t for event in runs(text) if not isinstance(event, NewLine) for t in segmenter.tokens(*event)]


@given(st.text(max_size=500), st.lists(st.integers(0, 500), max_size=10))
def test_fragments_do_not_matter_and_nothing_is_lost(text: str, cuts: list[int]) -> None:
    edges = [0, *sorted(c for c in cuts if c <= len(text)), len(text)]
    whole = runs(text)
    assert runs(*(text[a:b] for a, b in pairwise(edges))) == whole
    for event in whole:
        if not isinstance(event, NewLine):
            run, start = event
            assert text[start : start + len(run)] == run
    seen = "".join(e[0] for e in whole if not isinstance(e, NewLine))
    assert seen == "".join(c for c in text if not c.isspace())


def test_a_run_is_held_until_white_space_comes() -> None:
    scanner = Scanner()
    assert scanner.feed("hel") == []
    assert [*map(contents, scanner.feed("lo "))] == [("hello", 0)]
    assert scanner.feed("wor") == []
    assert [*map(contents, scanner.end())] == [("wor", 6)]


def test_endless_runs_are_cut() -> None:
    found = runs("x" * (2 * MAX_TOKEN + 5))
    assert [len(e[0]) for e in found if not isinstance(e, NewLine)] == [MAX_TOKEN, MAX_TOKEN, 5]


@pytest.mark.parametrize(
    ("text", "stop"),
    [
        ("word", ""),
        ("word,", "comma"),
        ("word;", "semicolon"),
        ("word:", "colon"),
        ("word.", "sentence"),
        ('word."', "sentence"),
        ("word?!", "question"),
        ("word!", "exclamation"),
        ("word…", "ellipsis"),
        ("word...", "ellipsis"),
        ("word)", "comma"),
        ("word(s)", ""),
        ("Dr.", ""),
        ("J.", ""),
        ("U.S.", "capital"),
        ("etc.", "capital"),
        ("No.", "number"),
        ("3.5", ""),
        ("21:45", ""),
        ("etc.,", "comma"),
        ("(212)", ""),
        ("#word", ""),
        ("-", "dash"),
    ],
)
def test_stops(text: str, stop: str) -> None:
    assert [t.stop for t in tokens(text)] == [stop]


def test_the_greek_question_mark_and_middle_dot() -> None:
    assert [t.stop for t in tokens("πού; να· ναι\u037e", "el")] == ["question", "semicolon", "question"]
    assert [t.stop for t in tokens("one; two", "en")] == ["semicolon", ""]


def test_what_the_next_token_decides() -> None:
    assert ends_before("capital", "The")
    assert ends_before("capital", '"The')
    assert not ends_before("capital", "the")
    assert ends_before("number", "Really")
    assert not ends_before("number", "5")
    assert ends_before("capital", "The", {"The"})
    assert ends_before("capital", "“The”,", {"The"})
    assert not ends_before("capital", "President", {"The"})
    assert ends_before("date", "the")
    assert not ends_before("date", "2026")


def test_cuts_inside_a_run() -> None:
    found = tokens("one—two,three wait...what 10–20")
    assert [(t.text, t.stop) for t in found] == [
        ("one", ""),
        ("—", "dash"),
        ("two", ""),
        (",", "comma"),
        ("three", ""),
        ("wait", ""),
        ("...", "ellipsis"),
        ("what", ""),
        ("10–20", ""),
    ]
    assert found[2].start == 4


@pytest.mark.parametrize(
    ("text", "expression", "ms"),
    [
        ("\\:)1000", "joy", 1000),
        ("\\:|250", "sadness", 250),
        ("\\:O", "surprise", 1000),
        ("\\:(5", "anger", 40),
        ("\\:;99999999", "disgust", 10_000),
        ("\\:o500", "fear", 500),
    ],
)
def test_smileys(text: str, expression: str, ms: int) -> None:
    before, smiley, after = tokens(f"hi{text}.")
    assert (smiley.expression, smiley.silence_ms) == (expression, ms)
    assert (before.text, after.text) == ("hi", ".")


def test_brackets_make_a_pause() -> None:
    assert [(t.text, t.stop) for t in tokens("we (they) go")] == [
        ("we", ""),
        ("(", "comma"),
        ("they)", "comma"),
        ("go", ""),
    ]


def test_footnote_marks_are_passed_over_and_addresses_are_whole() -> None:
    assert [(t.text, t.stop) for t in tokens("fell.[12] Then")] == [("fell.", "sentence"), ("Then", "")]
    assert [t.text for t in tokens("https://example.com/a?b--c")] == ["https://example.com/a?b--c"]
    assert [t.word for t in tokens("CO₂ x² (word) #word")] == ["", "", "", "word", ""]


def test_core() -> None:
    assert core("«Καλημέρα»,") == "Καλημέρα"
    assert core('("etc.",') == "etc."
