"""Words that sound differently by what they are."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.errors import DataError
from fapstream.tts import homographs as module
from fapstream.tts.english import english
from fapstream.tts.homographs import Homographs
from fapstream.tts.tables import read_rows

PATH = "en/homographs.tsv"
FOUND = Homographs(PATH)
CASES = [
    line.split("\t")
    for line in (Path(__file__).parent / "cases" / "homographs.tsv").read_text("utf-8").splitlines()
    if line and not line.startswith(";")
]
WORDS = sorted(FOUND.words)
ROWS = [fields for _, fields in read_rows(PATH, 4) if not fields[0].startswith("class ")]
CONTEXT = sorted({item for row in ROWS for item in (row[0] + " " + row[2]).split() if item.islower()})
NEAR = st.sampled_from(
    ["the", "to", "they", "of", "is", "has", "not", "very", "gas", "in", "workers", "an", *CONTEXT, *WORDS]
)


@pytest.mark.parametrize(("sentence", "word", "phones"), CASES)
def test_sentences(sentence: str, word: str, phones: str) -> None:
    words = re.findall("[a-z']+", sentence.lower())
    assert words.count(word) == 1
    assert " ".join(english().phones(words)[words.index(word)]) == phones


def test_there_are_many() -> None:
    assert len(CASES) >= 800
    assert len(WORDS) >= 250
    assert len({(word, phones) for _, word, phones in CASES}) >= 230


def written(text: str, monkeypatch: pytest.MonkeyPatch) -> Homographs:
    def rows(path: str, columns: int) -> list[tuple[int, list[str]]]:
        lines = enumerate(text.split("\n"), 1)
        return [(n, (line.split("\t") + [""] * columns)[:columns]) for n, line in lines]

    monkeypatch.setattr(module, "read_rows", rows)
    return Homographs("made up")


def test_what_an_item_can_be(monkeypatch: pytest.MonkeyPatch) -> None:
    found = written(
        "class A the *ly\nclass A #\nclass B A my\n"
        "B of\tread\t\tr E1 d\n\tread\tA\tr i1 d\n*ed\tread\tout\tr I1 d\n"
        "#\tread\t\tr {1 d\n\tread\t\tr u1 d",
        monkeypatch,
    )
    assert found.choose(["my", "of"], "read", "it") == ("r", "E1", "d")
    assert found.choose(["of"], "read", "it") == ("r", "E1", "d")
    assert found.choose(["slowly", "of"], "read", None) == ("r", "E1", "d")
    assert found.choose(["a", "of"], "read", "the") == ("r", "i1", "d")
    assert found.choose([], "read", None) == ("r", "i1", "d")
    assert found.choose(["has", "waited"], "read", "out") == ("r", "I1", "d")
    assert found.choose([], "read", "out") == ("r", "{1", "d")
    assert found.choose(["has", "waited"], "read", "in") == ("r", "u1", "d")


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("class A", 1),
        ("class a the", 1),
        ("class A the B", 1),
        ("class A the\n\tread\t\tr i1 d\nclass A a", 3),
        ("the\tread\t\tr i1 d", 1),
        ("the\tread\t\tr i1 d\n\tread\tout\tr E1 d", 2),
        ("\tread\t\tr i1 d\nthe\tread\t\tr E1 d", 2),
        ("a b c\tread\t\tr i1 d", 1),
        ("\tread\ta b\tr i1 d", 1),
        ("NONE\tread\t\tr i1 d", 1),
        ("*\tread\t\tr i1 d", 1),
        ("a#\tread\t\tr i1 d", 1),
        ("\tRead\t\tr i1 d", 1),
        ("\t\t\tr i1 d", 1),
        ("\tread it\t\tr i1 d", 1),
        ("\tread\t\t", 1),
        ("\tread\t\tr i d", 1),
        ("\tread\t\tr1 i1 d", 1),
        ("\tread\t\tr y1 d", 1),
        ("\tread\t\t_", 1),
    ],
)
def test_bad_tables(text: str, line: int, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(DataError) as error:
        written(text, monkeypatch).warm()
    assert error.value.line == line


def test_needs_next_is_whether_a_line_says_what_comes_after() -> None:
    looking = {row[1] for row in ROWS if row[2]}
    assert looking
    assert set(WORDS) - looking
    for word in [*WORDS, "tree"]:
        assert FOUND.needs_next(word) == (word in looking)
        assert english().needs_next(word) >= FOUND.needs_next(word)


@given(st.lists(NEAR, max_size=4), st.sampled_from(WORDS), st.none() | NEAR, st.none() | NEAR)
def test_a_choice_depends_on_what_it_says(before: list[str], word: str, one: str, other: str) -> None:
    chosen = FOUND.choose(before, word, one)
    assert chosen in FOUND.words[word]
    assert FOUND.choose(before[-2:], word, one) == chosen
    if not FOUND.needs_next(word):
        assert FOUND.choose(before, word, other) == chosen


@given(st.lists(NEAR, min_size=1, max_size=7))
def test_phones_depend_on_two_words_before_and_one_after(words: list[str]) -> None:
    whole = english().phones(words)
    for i in range(len(words)):
        window = words[max(0, i - 2) : i + 2]
        assert english().phones(window)[min(i, 2)] == whole[i]


def test_however_it_sounds_it_begins_alike() -> None:
    """Or `the` before it would depend on the word after it."""
    for word, ways in FOUND.words.items():
        assert len({way[0][-1].isdigit() for way in ways}) == 1, word


def test_other_words() -> None:
    assert "house" in FOUND
    assert "tree" not in FOUND
    assert not FOUND.needs_next("tree")
