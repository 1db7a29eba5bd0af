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
from fapstream.tts.tables import phone_set

FOUND = Homographs()
CASES = [
    line.split("\t")
    for line in (Path(__file__).parent / "cases" / "homographs.tsv").read_text("utf-8").splitlines()
    if line and not line.startswith(";")
]
WORDS = sorted(FOUND.words)
NEAR = st.sampled_from(
    ["the", "to", "they", "of", "is", "has", "not", "very", "gas", "in", "car", *WORDS[:20]]
)


@pytest.mark.parametrize(("sentence", "word", "number"), CASES)
def test_sentences(sentence: str, word: str, number: str) -> None:
    words = re.findall("[a-z']+", sentence.lower())
    sounds = english().phones(words)[words.index(word)]
    ways = FOUND.words[word]
    assert ways.index(sounds) + 1 == int(number), " ".join(sounds)


def test_there_are_many_and_most_kinds_are_met_both_ways() -> None:
    assert len(CASES) >= 150
    assert len(WORDS) >= 150
    assert {number for *_, number in CASES} == {"1", "2"}


@given(st.lists(NEAR, max_size=3), st.sampled_from(WORDS), st.none() | NEAR, st.none() | NEAR)
def test_a_choice_depends_on_what_it_says(before: list[str], word: str, one: str, other: str) -> None:
    chosen = FOUND.choose(before, word, one)
    assert chosen in FOUND.words[word]
    assert FOUND.choose(before[-2:], word, one) == chosen
    if not FOUND.needs_next(word):
        assert FOUND.choose(before, word, other) == chosen


def test_other_words() -> None:
    assert "house" in FOUND
    assert "tree" not in FOUND
    assert FOUND.choose(["the"], "tree", None) is None
    assert not FOUND.needs_next("tree")


def test_pronunciations_are_phones_of_the_language() -> None:
    phones = phone_set("en")
    for ways in FOUND.words.values():
        assert len(ways) == 2
        assert ways[0] != ways[1]
        for token in ways[0] + ways[1]:
            name = token[:-1] if token[-1] in "012" else token
            assert (phones[name].kind == "vowel") == (token[-1] in "012"), token


@pytest.mark.parametrize(
    ("words", "kinds"),
    [
        ("read\tnobody\tr E1 d / r i1 d", "k\t\t\t1"),
        ("read\tk\tr E1 d", "k\tthe\t\t2\nk\t\t\t1"),
        ("read\tk\tr E1 d / ", "k\t\t\t1"),
        ("read\tk\tr E1 d / r i1 d", "k\t\t\t3"),
        ("read\tk\tr E1 d / r i1 d", "k\ta b c\t\t1\nk\t\t\t1"),
        ("read\tk\tr E1 d / r i1 d", "k\t\ta b\t1\nk\t\t\t1"),
        ("read\tk\tr E1 d / r i1 d", "k\tthe\t\t1"),
    ],
)
def test_bad_tables(words: str, kinds: str, monkeypatch: pytest.MonkeyPatch) -> None:
    made = {"en/homographs.tsv": words, "en/homograph_kinds.tsv": kinds}

    def rows(path: str, columns: int) -> list[tuple[int, list[str]]]:
        lines = enumerate(made[path].split("\n"), 1)
        return [(n, (line.split("\t") + [""] * columns)[:columns]) for n, line in lines]

    monkeypatch.setattr(module, "read_rows", rows)
    with pytest.raises(DataError):
        Homographs()
