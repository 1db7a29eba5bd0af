"""Greek text to spoken words: every case of cases/normalise_el.tsv, and what must hold for any text."""

from __future__ import annotations

import time
import timeit
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.records import Utterance
from fapstream.tts.frontend import FrontEnd
from fapstream.tts.language import language
from fapstream.tts.lookalikes import one_script
from fapstream.tts.patterns import Vocabulary
from fapstream.tts.segment import Run, Scanner
from fapstream.tts.spelling import fold_greek

CASES = [
    line.split("\t")
    for line in (Path(__file__).parent / "cases" / "normalise_el.tsv").read_text("utf-8").splitlines()
    if line and not line.startswith(";")
]
ALPHABET = "0123456789,.:-–/%€$'΄’ αβγΑΒΓΙΧXVκμςώή#@+°½"
PIECES = st.sampled_from([word for text, _ in CASES for word in text.split()])
TEXT = st.lists(PIECES | st.text(ALPHABET, max_size=8), max_size=30).map(" ".join)


def utterances(*fragments: str) -> list[Utterance]:
    front = FrontEnd("el")
    return [u for fragment in fragments for u in front.feed(fragment)] + front.end()


def words(*fragments: str) -> list[tuple[int, int, object]]:
    """Every word once, also if two utterances share it."""
    return list(dict.fromkeys((w.start, w.end, w.spoken) for u in utterances(*fragments) for w in u.words))


def read(text: str) -> str:
    spoken = [s for u in utterances(text) for w in u.words for s in w.spoken]
    return " ".join(s if isinstance(s, str) else "".join(s) for s in spoken)


@pytest.mark.parametrize(("text", "spoken"), CASES, ids=[text for text, _ in CASES])
def test_case(text: str, spoken: str) -> None:
    assert read(text).replace("ς", "σ") == spoken.replace("ς", "σ")


def test_cases_are_many_and_none_twice() -> None:
    assert len(CASES) >= 450
    assert len({text for text, _ in CASES}) == len(CASES)


def test_cases_do_not_depend_on_fragments() -> None:
    for text, _ in CASES:
        assert words(*text) == words(text), text


@settings(max_examples=150, deadline=None)
@given(TEXT, st.integers(1, 9))
def test_any_fragmentation_gives_the_same(text: str, size: int) -> None:
    assert words(*(text[at : at + size] for at in range(0, len(text), size))) == words(text)


@settings(max_examples=150, deadline=None)
@given(TEXT)
def test_words_are_where_they_say(text: str) -> None:
    rooms, scanner = language("el"), Scanner()
    runs = [found for found in [*scanner.feed(text), *scanner.end()] if isinstance(found, Run)]
    tokens = [token for run in runs for token in rooms.segmenter.tokens(run.text, run.start)]
    at = 0
    for item in rooms.normalise.take(tokens, True).items:
        assert text[item.start : item.end].split() == item.text.split()
        assert at <= item.start < item.end
        assert item.spoken
        assert all(s and (s.islower() or len(s) == 1) for s in item.spoken if isinstance(s, str))
        at = item.end


HOSTILE = """
1 1. 1, 1- 1/ . -1. Α' 1α- 12.345, 1: a. a@ #α 1€ ΧΧ www.a XV' /1.α,- 1x 1,5 +1 €1 a-a. Α.Α Σ' § 1.234.
"""


@pytest.mark.parametrize("piece", [*HOSTILE.split(), "1 1 ", "+1 ", "1 και ", "1 000 ", "Α' "])
def test_hostile_tokens_stay_fast(piece: str) -> None:
    token = (piece * 200)[:200]
    text = f"{token} {token} {token}"
    plain = ("καλημέρα κόσμε " * len(text))[: len(text)]
    # eight times as long at most where this was written; backtracking costs thousands of times as much
    assert seconds(text) < 60 * seconds(plain)


def seconds(text: str) -> float:
    """The shortest of three readings."""
    return min(timeit.repeat(lambda: read(text), timer=time.process_time, number=1, repeat=3))


def test_the_vocabulary_can_be_spoken() -> None:
    for name, entries in Vocabulary("el/vocabulary.tsv").classes.items():
        for written, entry in entries.items():
            said = entry.one if name == "abbreviation" else f"{entry.one} {entry.many}"
            for word in said.split():
                assert word.isdecimal() or word.islower() or len(word) == 1, written
                assert name in ("keraia", "roman", "date_before") or not word.isdecimal(), written


def test_folding() -> None:
    assert fold_greek("Καλημέρας") == fold_greek("Καλημε\u0301ρας") == "καλημέρασ"
    assert fold_greek("ΜΑΪ́ΟΥ") == "μαΐου"
    assert fold_greek("΄Ελληνας") == "έλληνασ"
    assert fold_greek("ᾯδε") == "ώδε"


def test_letters_of_another_script() -> None:
    assert one_script("Aθήνα") == ["Αθήνα"]
    assert one_script("µε") == ["με"]
    assert one_script("ΒBC") == ["BBC"]
    assert one_script("Facebookίζω") == ["Facebook", "ίζω"]
    assert one_script("café") == ["café"]
