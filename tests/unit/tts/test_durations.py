"""The duration rules."""

from __future__ import annotations

import tomllib

import pytest

from fapstream.tts.durations import DurationModel, Segment
from fapstream.tts.tables import read_text

FACTORS = tomllib.loads(read_text("prosody.toml"))["durations"]


def timed(
    lang: str, *words: str, final: bool = False, rate: float = 1.0, function: bool = False
) -> list[Segment]:
    model = DurationModel(lang, FACTORS[lang])
    segments = model.segments([tuple(w.split()) for w in words], [function] * len(words))
    model.assign(segments, rate, final)
    return segments


@pytest.mark.parametrize("lang", ["en", "el"])
def test_stressed_vowels_are_longer(lang: str) -> None:
    vowel = {"en": "A", "el": "a"}[lang]
    stressed, unstressed = (timed(lang, f"t {vowel}{s} t")[1].ms for s in (1, 0))
    assert stressed > 1.15 * unstressed


@pytest.mark.parametrize("lang", ["en", "el"])
def test_the_last_syllable_before_a_pause_is_longer(lang: str) -> None:
    words = {"en": ("t A1 t", "t A1 t"), "el": ("t a1 s", "t a1 s")}[lang]
    within, before_pause = timed(lang, *words), timed(lang, *words, final=True)
    assert [s.ms for s in within[:3]] == [s.ms for s in before_pause[:3]]
    assert before_pause[4].ms > 1.15 * within[4].ms
    assert before_pause[5].ms > within[5].ms


def test_phones_are_shorter_in_longer_words() -> None:
    assert timed("el", "t a1 t a0 t a0 t a0")[1].ms < timed("el", "t a1 t a0")[1].ms


def test_clusters_and_what_follows_a_vowel() -> None:
    assert timed("en", "s t A1")[0].ms < timed("en", "s A1")[0].ms
    assert timed("en", "b I1 t")[1].ms < timed("en", "b I1 d")[1].ms < timed("en", "b I1 z")[1].ms


def test_function_words_are_quick() -> None:
    assert timed("en", "D E1 r", function=True)[1].ms < timed("en", "D E1 r")[1].ms


def test_rate_divides_everything() -> None:
    normal, fast = timed("en", "h @0 l @U1"), timed("en", "h @0 l @U1", rate=2.0)
    assert [s.ms for s in fast] == pytest.approx([s.ms / 2 for s in normal])


def test_segments_know_their_word() -> None:
    segments = timed("en", "h @0 l @U1", "w r=1 l d")
    assert [s.word for s in segments] == [0] * 4 + [1] * 4
    assert [s.n_syllables for s in segments] == [2] * 4 + [1] * 4
    assert [s.initial for s in segments] == [True, False, False, False] * 2
