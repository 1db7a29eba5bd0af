"""The melody of words and phrase ends."""

from __future__ import annotations

import pytest

from fapstream.tts.melody import MelodyState, Pitch
from fapstream.tts.prosody import standard

F0, WIDTH = 120.0, 200.0
REGISTER = (F0, WIDTH)
MODEL = standard("en").melody
SOUNDS = standard("en").sounds
WORD = [SOUNDS[t] for t in ["k", "A0", "l", "i1", "m", "A0"]]
MS = [80.0, 70.0, 60.0, 120.0, 60.0, 90.0]
ACCENT = 3


def word(state: MelodyState, height: float, accent: int = ACCENT) -> list[Pitch]:
    return MODEL.word(MS, accent, height, state, REGISTER)


def test_the_declination_falls_with_time_and_goes_on_in_the_next_word() -> None:
    state = MelodyState()
    first, second = word(state, 0.0, -1), word(state, 0.0, -1)
    values = [hz for phone in first + second for _, hz in phone]
    assert values == sorted(values, reverse=True)
    assert state.elapsed_ms == pytest.approx(2 * sum(MS))
    for _ in range(40):
        word(state, 0.0, -1)
    assert word(state, 0.0, -1)[0][0][1] == pytest.approx(F0 - 0.10 * WIDTH, abs=0.5)
    state.restart(1.0)
    assert word(state, 0.0, -1) == first


def test_an_accent_rises_to_the_vowels_middle_and_falls_after_it() -> None:
    flat, accented = word(MelodyState(), 0.0), word(MelodyState(), 0.2)
    (start, from_hz), (middle, peak) = accented[ACCENT]
    assert (start, middle) == (0.0, 55.0)
    assert peak - from_hz > 0.5 * 0.2 * WIDTH, "enough for the gestures that follow accents"
    assert flat[ACCENT][1][1] + 0.2 * WIDTH == pytest.approx(peak)
    assert accented[0] == flat[0]
    assert peak > accented[ACCENT + 1][0][1] > accented[ACCENT + 2][0][1] > flat[ACCENT + 2][0][1]


def test_an_accent_on_the_last_phone_falls_in_the_next_word() -> None:
    state, plain = MelodyState(), MelodyState()
    word(state, 0.2, len(MS) - 1)
    word(plain, 0.0, -1)
    after, flat = word(state, 0.0, -1), word(plain, 0.0, -1)
    assert after[0][0][1] > after[1][0][1] > flat[1][0][1]
    assert after[2] == flat[2]


def test_heights() -> None:
    state = MelodyState()
    tunes = MODEL.tunes
    first, second = (MODEL.height(state, None, False, 0.0) for _ in range(2))
    assert first > second > 0
    assert state.accents == 2
    assert MODEL.height(state, tunes["exclaim"], False, 0.0) > second
    assert MODEL.height(state, tunes["rise"], True, 0.0) == tunes["rise"].accent
    strong = MODEL.height(state, None, False, 0.8)
    assert strong > 1.5 * second
    assert MODEL.height(state, None, False, 0.0) < 0.5 * second, "after the focus accents are small"


@pytest.mark.parametrize("lang", ["en", "el"])
@pytest.mark.parametrize("name", sorted(MODEL.tunes))
@pytest.mark.parametrize("accent", [-1, 1, 3, 5])
def test_endings_reach_their_goal(lang: str, name: str, accent: int) -> None:
    model = standard(lang).melody
    tune = model.tunes[name]
    pitch = model.word(MS, accent, tune.accent, MelodyState(), REGISTER)
    before = list(pitch)
    model.ending(WORD, MS, pitch, tune, REGISTER)
    assert pitch[-1][-1] == (100.0, pytest.approx(F0 + WIDTH * tune.end))
    assert pitch[:5] == before[:5], "only the last syllable's vowel and what follows it"
    for phone in pitch:
        assert phone[0][0] == 0.0
        assert [p for p, _ in phone] == sorted({p for p, _ in phone})


def test_the_final_fall_is_sixty_hertz_of_a_range_of_220() -> None:
    """The paper on the FPD-based talking head, section 4.1."""
    top = MODEL.word(MS, -1, 0.0, MelodyState(), (180.0, 220.0))[0][0][1]
    assert top - (180.0 + 220.0 * MODEL.tunes["fall"].end) == pytest.approx(60.0, abs=2.0)


def test_a_greek_question_rises_and_falls_on_its_last_vowel() -> None:
    model = standard("el").melody
    pitch = model.word(MS, 3, model.tunes["rise"].accent, MelodyState(), REGISTER)
    model.ending(WORD, MS, pitch, model.tunes["rise"], REGISTER)
    (_, start), (_, peak), (_, end) = pitch[-1]
    assert peak > start + 20
    assert peak > end + 40


def test_a_word_of_consonants_can_end_a_phrase() -> None:
    sounds = [SOUNDS["s"], SOUNDS["t"]]
    pitch = MODEL.word([80.0, 70.0], -1, 0.0, MelodyState(), REGISTER)
    MODEL.ending(sounds, [80.0, 70.0], pitch, MODEL.tunes["fall"], REGISTER)
    assert pitch[-1][-1][0] == 100.0
