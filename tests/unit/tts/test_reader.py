"""Text with mark-up to tokens, pauses and notes."""

from __future__ import annotations

import re
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.records import Note
from fapstream.tts.language import language
from fapstream.tts.reader import MAX_CONTENT, MAX_DEPTH, Event, Pause, Reader
from fapstream.tts.segment import Token

PIECES = st.sampled_from(
    [
        "<emphasis>",
        "</emphasis>",
        "<prosody rate='slow'>",
        "</prosody>",
        "<sub alias='x y'>",
        "</sub>",
        "<break/>",
        "<mark name='m'/>",
        "<say-as interpret-as='digits'>",
        "</say-as>",
        "<b>",
        "<",
        ">",
        "a < b",
        "12",
        "word.",
        "\n",
        " ",
        "<phoneme ph='t'>",
        "</phoneme>",
        "&amp;",
        "<!-- x -->",
        "\\:)5",
    ]
)
TEXT = st.lists(PIECES | st.text(max_size=6), max_size=30).map("".join)


def events(*fragments: str, lang: str = "en") -> list[Event]:
    reader = Reader(lambda name: language(name).segmenter, lang, language(lang).say_as)
    return [e for f in fragments for e in reader.feed(f)] + list(reader.end())


def contents(event: Event) -> tuple[object, ...]:
    """What can be compared."""
    if not isinstance(event, Token):
        return event
    e = event
    return e.text, e.start, e.word, e.stop, e.style, e.expression, e.silence_ms, e.raw, e.said


def tokens(text: str) -> list[Token]:
    return [e for e in events(text) if isinstance(e, Token)]


def warnings(text: str) -> list[str]:
    return [e.text for e in events(text) if isinstance(e, Note) and e.kind == "warning"]


@given(TEXT, st.lists(st.integers(0, 200), max_size=8))
def test_fragments_do_not_matter(text: str, cuts: list[int]) -> None:
    edges = [0, *sorted(min(c, len(text)) for c in cuts), len(text)]
    whole = [*map(contents, events(text))]
    assert [*map(contents, events(*(text[a:b] for a, b in pairwise(edges))))] == whole
    assert [*map(contents, events(*text))] == whole


@given(TEXT)
def test_tokens_come_in_order_and_are_what_was_written(text: str) -> None:
    at = 0
    for token in tokens(text):
        raw = token.raw or token.text
        assert at <= token.start
        at = token.start + len(raw)
        assert re.sub(r"\s", " ", text[token.start : at]) == re.sub(r"\s", " ", raw)


def test_styles_hold_between_their_tags() -> None:
    found = tokens("one <prosody rate='slow'>two <emphasis>three</emphasis></prosody> four")
    assert [(t.text, t.style.rate, t.style.emphasis) for t in found] == [
        ("one", 1.0, 0.0),
        ("two", 0.75, 0.0),
        ("three", 0.75, 0.4),
        ("four", 1.0, 0.0),
    ]
    assert warnings("one <prosody rate='slow'>two</prosody>") == []


def test_pauses_and_marks() -> None:
    found = events("one <break time='2s'/> two<mark name='here'/> <s>three</s> <break strength='none'/>")
    assert [e for e in found if isinstance(e, Pause)] == [
        Pause("break", 2000.0),
        Pause("sentence"),
        Pause("sentence"),
    ]
    assert [e for e in found if isinstance(e, Note)] == [Note("mark", "here", 26, 45)]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<sub alias='World Wide Web'>WWW</sub>", ("world", "wide", "web")),
        ("<say-as interpret-as='characters'>ab1</say-as>", ("A", "B", "one")),
        ("<say-as interpret-as='digits'>1 2-3</say-as>", ("one", "two", "three")),
        ("<say-as interpret-as='ordinal'>21</say-as>", ("twenty", "first")),
        ("<say-as interpret-as='cardinal'>1984</say-as>", None),
        (
            "<phoneme alphabet='sampa' ph='t @ m A1 t @U'>tomato</phoneme>",
            (("t", "@0", "m", "A1", "t", "@U0"),),
        ),
    ],
)
def test_content_is_read_as_the_element_says(text: str, said: tuple[object, ...] | None) -> None:
    (token,) = tokens(text)
    assert token.said
    assert said is None or token.said == said
    assert warnings(text) == []


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a <b>bold</b> move", "a <b>bold</b> move"),
        ("one </emphasis> two", "one </emphasis> two"),
        ("<emphasis>one </prosody> two", "one </prosody> two"),
        ("<sub alias='x'>never closed", "never closed"),
        ("<phoneme alphabet='sampa' ph='nonsense'>this</phoneme> too", "this too"),
        (
            "<sub alias='x'>" + "long " * (MAX_CONTENT // 5 + 1) + "</sub>",
            "long " * (MAX_CONTENT // 5 + 1) + "</sub>",
        ),
        ("<sub alias='x'>a <break/> b", "a b"),
        ("<emphasis>" * (MAX_DEPTH + 1) + "deep", "<emphasis>deep"),
    ],
)
def test_what_is_malformed_is_read_as_text_with_a_warning(text: str, words: str) -> None:
    assert " ".join(t.raw or t.text for t in tokens(text)).replace(" ", "") == words.replace(" ", "")
    assert warnings(text)


@pytest.mark.parametrize("text", ["1 < 2 and 3 > 2", "I <3 you", "x<y", "a << b", "<<<", "<"])
def test_signs_are_no_markup(text: str) -> None:
    assert warnings(text) == []
    assert "".join(t.text for t in tokens(text)) == text.replace(" ", "")


def test_entities_are_what_they_stand_for() -> None:
    (token,) = tokens("AT&amp;T")
    assert (token.raw, token.text.replace("\u2060", "")) == ("AT&amp;T", "AT&T")
    assert len(token.raw) == len(token.text)
    assert [t.stop for t in tokens("say &quot;no&quot; now")] == ["", "", ""]
