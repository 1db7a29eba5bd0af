"""How English pronunciations are compared."""

from __future__ import annotations

import zlib

from tests.benchmarks.english_list import from_ipa, held_out, plain, score_words


def test_the_words_are_those_kept_apart() -> None:
    words = held_out()
    assert len(words) > 11_000
    assert all(zlib.crc32(w.encode()) % 10 == 0 and w.isalpha() for w in words)
    assert 400 < len(held_out(500)) < 1000


def test_scores() -> None:
    words = {"cat": ("k", "{1", "t"), "about": ("@0", "b", "aU1", "t")}
    perfect = score_words(words.__getitem__, words)
    assert (perfect.words, perfect.right, perfect.right_with_stress, perfect.phone_error_rate) == (
        2,
        2,
        2,
        0.0,
    )
    near = score_words({"cat": ("k", "{0", "t"), "about": ("V0", "b", "aU1")}.__getitem__, words)
    assert (near.right, near.right_with_stress) == (1, 0)
    assert near.phone_error_rate == 1 / 7, "the reduced vowel is the full one, a t is missing"
    assert plain(("@0", "r=1")) == ("V", "r=")


def test_espeaks_notation() -> None:
    assert from_ipa("həlˈoʊ") == ("h", "@0", "l", "@U1")
    assert from_ipa("tʃˈɜːtʃ") == ("tS", "r=1", "tS")
    assert from_ipa("bˈɔːɹd") == ("b", "O1", "r", "d")
