"""The duration rules."""

from __future__ import annotations

import pytest

from fapstream.tts.prosody import standard


def timed(lang: str, word: str, final: bool = False, function: bool = False) -> list[float]:
    rooms = standard(lang)
    sounds = [rooms.sounds[token] for token in word.split()]
    return rooms.durations.word(sounds, sum(s.vowel for s in sounds), function, final)


@pytest.mark.parametrize("lang", ["en", "el"])
def test_stressed_vowels_are_longer(lang: str) -> None:
    vowel = {"en": "A", "el": "a"}[lang]
    stressed, unstressed = (timed(lang, f"t {vowel}{s} t")[1] for s in (1, 0))
    assert stressed > 1.15 * unstressed


@pytest.mark.parametrize("lang", ["en", "el"])
def test_the_last_syllable_before_a_pause_is_longer(lang: str) -> None:
    word = {"en": "b A0 t A1 t", "el": "m a0 t a1 s"}[lang]
    within, before_pause = timed(lang, word), timed(lang, word, final=True)
    assert within[:2] == before_pause[:2]
    assert before_pause[2] >= within[2]
    assert before_pause[3] > 1.15 * within[3]
    assert before_pause[4] > within[4]


@pytest.mark.parametrize("lang", ["en", "el"])
def test_phones_are_shorter_in_longer_words(lang: str) -> None:
    vowel = {"en": "A", "el": "a"}[lang]
    syllable = f" t {vowel}0"
    lengths = [timed(lang, f"t {vowel}1" + syllable * n)[1] for n in range(1, 5)]
    assert lengths == sorted(lengths, reverse=True)
    assert lengths[0] > lengths[2]
    assert timed(lang, f"t {vowel}1" + syllable * 30)


def test_clusters_and_what_follows_a_vowel() -> None:
    assert timed("en", "s t A1")[0] < timed("en", "s A1")[0]
    assert timed("en", "b I1 t")[1] < timed("en", "b I1 d")[1] < timed("en", "b I1 z")[1]


def test_the_place_in_the_syllable_counts() -> None:
    """The t of a-tra begins a syllable, that of at-la ends one."""
    onset, coda = timed("en", "A1 t r A0")[1], timed("en", "A1 t l A0")[1]
    assert onset != coda


def test_function_words_are_quick() -> None:
    assert timed("en", "D E1 r", function=True)[1] < timed("en", "D E1 r")[1]


def test_words_without_a_vowel_have_durations_too() -> None:
    assert all(ms > 0 for final in (False, True) for ms in timed("en", "s t", final))
