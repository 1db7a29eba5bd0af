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
    assert right / len(sample) > 0.7


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
    assert len(read_bytes("en/lts.bin")) < 1_900_000
    for data in (b"what", b"FLT2what"):
        with pytest.raises(DataError):
            lts.LetterToSound(data)


def test_states_of_labels() -> None:
    """Nearest first: two labels, three phones, two vowels; stresses, syllables, and those since a stress."""
    labels = [("k",), ("A1", "r"), (), ("@0",)]
    back, forth = lts.Labels(labels), lts.Labels(labels, backward=False)
    assert (back.start[:10], forth.start[:10]) == (bytes(10), bytes(10))
    state = back.follow(back.follow(back.start, 1), 0)
    names = ["", *sorted(["k", "A1", "r", "@0"])]
    assert (state[0], state[1]) == (1, 2)
    assert [names[p] for p in state[2:7]] == ["k", "A1", "r", "A1", ""]
    assert tuple(state[7:10]) == (1, 1, 1)
    state = forth.follow(forth.follow(forth.start, 1), 3)
    assert [names[p] for p in state[2:7]] == ["@0", "r", "A1", "@0", "A1"]
    assert tuple(state[7:10]) == (1, 2, 2)
    assert lts.primaries(state) == 1
    assert len(state) == len(back.start)
