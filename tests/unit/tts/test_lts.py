"""The letter-to-sound trees."""

from __future__ import annotations

import zlib
from functools import cache

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.errors import DataError
from fapstream.tts import lts
from fapstream.tts.lexicon import Lexicon
from fapstream.tts.tables import phone_set, read_bytes


@cache
def loaded() -> lts.LetterToSound:
    return lts.LetterToSound(read_bytes("en/lts.bin"))


@pytest.fixture
def trees() -> lts.LetterToSound:
    return loaded()


@given(st.text("abcdefghijklmnopqrstuvwxyz", min_size=1, max_size=120))
def test_any_letters_give_phones_with_at_most_one_primary_stress(word: str) -> None:
    tokens = loaded()(word)
    phones = phone_set("en")
    vowels = [t for t in tokens if t[-1].isdigit()]
    assert all((t[:-1] if t[-1].isdigit() else t) in phones for t in tokens)
    assert sum(t.endswith("1") for t in vowels) == bool(vowels)


def plain(tokens: tuple[str, ...]) -> tuple[str, ...]:
    return tuple("V" if t == "@0" else t.rstrip("012") for t in tokens)


def test_held_out_words(trees: lts.LetterToSound) -> None:
    """Words of the tenth that training never saw (by hash), as tools/train_lts.py splits them."""
    lexicon = Lexicon(read_bytes("en/lexicon.bin"))
    words = [w for w in lexicon.words() if w.isalpha() and len(w) > 1 and zlib.crc32(w.encode()) % 10 == 0]
    sample = words[::6]
    right = sum(plain(trees(w)) == plain(lexicon.get(w) or ()) for w in sample)
    assert len(sample) > 1500
    assert right / len(sample) > 0.63


def test_invented_words_sound_right(trees: lts.LetterToSound) -> None:
    assert plain(trees("blorp")) == ("b", "l", "O", "r", "p")
    assert trees("snation")[-4:] == ("EI1", "S", "@0", "n")


def test_one_primary() -> None:
    assert lts.one_primary(["A1", "t", "i1"]) == ("A2", "t", "i1")
    assert lts.one_primary(["A0", "t", "i2"]) == ("A0", "t", "i1")
    assert lts.one_primary(["A0", "t", "i0"]) == ("A1", "t", "i0")
    assert lts.one_primary(["s", "t"]) == ("s", "t")


def test_vowel_groups() -> None:
    assert lts.vowel_groups("beauty") == [0, 1, 1, 1, 1, 2]


def test_small_and_whole() -> None:
    assert len(read_bytes("en/lts.bin")) < 2_000_000
    with pytest.raises(DataError):
        lts.LetterToSound(b"what")
