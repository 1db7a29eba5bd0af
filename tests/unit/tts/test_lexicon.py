"""The packed lexicon."""

from __future__ import annotations

import time
import tracemalloc

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.errors import DataError
from fapstream.tts.lexicon import Lexicon, pack
from fapstream.tts.tables import phone_set, read_bytes

WORDS = st.text("abcdefghijklmnopqrstuvwxyz'.-", min_size=1, max_size=20)
TOKENS = st.lists(st.sampled_from(["A1", "{0", "t", "tS", "@U2", "r=0"]), min_size=1, max_size=8).map(tuple)


@given(st.dictionaries(WORDS, TOKENS, min_size=1, max_size=40), WORDS)
def test_what_is_packed_is_found_and_nothing_else(entries: dict[str, tuple[str, ...]], other: str) -> None:
    lexicon = Lexicon(pack(entries))
    for word, tokens in entries.items():
        assert lexicon.get(word) == tokens
    assert lexicon.get(other) == entries.get(other)


def test_too_many_tokens() -> None:
    with pytest.raises(DataError):
        pack({"word": [f"t{i}" for i in range(300)]})


@pytest.mark.parametrize("data", [b"", b"junk", b"FLX4junk"])
def test_a_broken_file(data: bytes) -> None:
    with pytest.raises(DataError):
        Lexicon(data)


def test_the_english_lexicon_is_complete_and_light() -> None:
    tracemalloc.start()
    begin = time.process_time()
    lexicon = Lexicon(read_bytes("en/lexicon.bin"))
    lexicon.warm()
    seconds = time.process_time() - begin
    held = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert lexicon.get("hello") == ("h", "@0", "l", "@U1")
    assert lexicon.get("thought") == ("T", "O1", "t")
    assert lexicon.get("zzyzxq") is None
    assert lexicon.get("καλά") is None
    assert held < 40e6
    assert seconds < 1.0


def test_its_tokens_are_phones_of_the_language() -> None:
    lexicon = Lexicon(read_bytes("en/lexicon.bin"))
    phones = phone_set("en")
    for token in lexicon.tokens:
        name = token[:-1] if token[-1].isdigit() else token
        assert (phones[name].kind == "vowel") == token[-1].isdigit()
