"""Words that mix scripts."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.tts.lookalikes import is_greek, one_script


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("Αθήνα", ["Αθήνα"]),
        ("Aθήνα", ["Αθήνα"]),
        ("αθήνa", ["αθήνα"]),
        ("wοrld", ["world"]),
        ("hello", ["hello"]),
        ("webσελίδα", ["web", "σελίδα"]),
    ],
)
def test_a_letter_of_the_wrong_script_is_taken_for_its_double(text: str, words: list[str]) -> None:
    assert one_script(text) == words


@given(st.text("aboxzαβοχζΑABΒ", min_size=1, max_size=12))
def test_nothing_is_lost(text: str) -> None:
    parts = one_script(text)
    assert sum(map(len, parts)) == len(text)
    for part in parts:
        assert not (is_greek(part) and any(c in "bz" for c in part)) or len(parts) == 1
