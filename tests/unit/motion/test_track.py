"""Timed phones to frames: smooth, on the clock, with lips that close, and the same however phones arrive."""

from __future__ import annotations

from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

from fapstream.fap import EXPRESSIONS, expressions, visemes
from fapstream.motion.track import FaceTrack
from fapstream.motion.visemes import Keyframe, keyframes
from fapstream.records import SILENCE, FapFrame, Phone, TimedPhone
from fapstream.tts import LANGUAGES, phone_set
from tests.unit.fakes import timed

IDLE = [18, 19, 20, 21, 47, 48, 49]
"""Columns of the FAPs that blinks and head motion also move."""

MOUTH = [i for i in range(2, 68) if i not in IDLE]
LIPS = [3, 4, 7, 8, 9, 10, 11, 12, 50, 51, 54, 55, 56, 57, 58, 59]
"""Columns of FAPs 4, 5, 8-13, 51, 52, 55-60: the lips' own lines."""

VOWELS = {lang: [p for p, i in phone_set(lang).items() if i.kind == "vowel"] for lang in LANGUAGES}


def run(phones: tuple[TimedPhone, ...], lang: str, rate: int = 16000, fps: int = 25) -> list[FapFrame]:
    track = FaceTrack(lang, rate, fps)
    track.add(phones)
    return track.frames(phones[-1].end)


def stacked(frames: list[FapFrame]) -> NDArray[np.int32]:
    return np.array([f.values for f in frames]).reshape(-1, 68)


def turns(lang: str) -> st.SearchStrategy[list[Phone]]:
    """Phones with pauses and expressions among them; the last is a pause."""
    name = st.sampled_from([n for n in phone_set(lang) if n != SILENCE])
    sound = st.builds(Phone, name, st.floats(15, 250), stress=st.integers(0, 2))
    pause = st.builds(
        Phone, st.just(SILENCE), st.floats(10, 900), expression=st.sampled_from([None, None, *EXPRESSIONS])
    )
    phones = st.lists(st.one_of(sound, sound, sound, pause), min_size=1, max_size=25)
    return phones.map(lambda found: [*found, Phone(SILENCE, 200.0)])


@pytest.mark.parametrize("rate", [16000, 22050])
@pytest.mark.parametrize("fps", [25, 50])
def test_frame_k_holds_at_k_rate_over_fps(rate: int, fps: int) -> None:
    phones = timed([Phone("a", 700.0), Phone(SILENCE, 300.0)], rate)
    frames = run(phones, "el", rate, fps)
    assert [f.sample for f in frames] == [k * rate // fps for k in range(fps)]
    assert all(f.values.dtype == np.int32 and f.values.shape == (68,) for f in frames)


def test_frames_never_carry_the_composite_faps() -> None:
    phones = timed([Phone("a", 300.0), Phone(SILENCE, 900.0, expression="joy")], 16000)
    assert not stacked(run(phones, "el"))[:, :2].any()


@settings(max_examples=60, deadline=None)
@given(st.data(), st.sampled_from(LANGUAGES), st.sampled_from([25, 50]))
def test_batches_do_not_matter(data: st.DataObject, lang: str, fps: Literal[25, 50]) -> None:
    """Phones in any batches, frames taken in between as soon as they can be: the same frames.

    Except that a pause, while nothing is known to follow it, is asked for only up to its start: what is
    given beyond is rest, from which the face then leaves later than it would have, had the next phone
    been known (see the test below).
    """
    phones = timed(data.draw(turns(lang)), 22050)
    track, got, i = FaceTrack(lang, 22050, fps), [], 0
    while i < len(phones):
        n = data.draw(st.integers(1, 6))
        track.add(phones[i : i + n])
        i += n
        last = phones[min(i, len(phones)) - 1]
        asked = last.start if last.phone.name == SILENCE and i < len(phones) else last.end
        got += track.frames(data.draw(st.integers(0, asked)))
        got += track.frames(asked)
    whole = run(phones, lang, 22050, fps)
    assert [f.sample for f in got] == [f.sample for f in whole]
    assert np.array_equal(stacked(got), stacked(whole))


@settings(max_examples=40, deadline=None)
@given(turns("en"), turns("en"))
def test_a_pause_given_out_before_its_end_changes_only_how_the_face_leaves_it(
    first: list[Phone], second: list[Phone]
) -> None:
    """The slope at the first keyframe after the pause may differ too, and so what lies before the second."""
    phones = timed([*first, *second], 16000)
    border = phones[len(first) - 1].end
    track = FaceTrack("en", 16000, 50)
    track.add(phones[: len(first)])
    got = track.frames(border)
    assert track.ready_until() == border
    track.add(phones[len(first) :])
    got += track.frames(phones[-1].end)
    whole = run(phones, "en", fps=50)
    after = [t.end for t in phones[len(first) :]]
    settled = after[1] if len(after) > 1 else after[0]
    for a, b in zip(got, whole, strict=True):
        if a.sample < border - 120 * 16 or a.sample >= settled:
            assert np.array_equal(a.values, b.values)
    in_pause = [f for f in got if phones[len(first) - 1].start + 120 * 16 <= f.sample < border]
    assert not stacked(in_pause)[:, MOUTH].any()


@settings(max_examples=40, deadline=None)
@given(turns("el"), st.sampled_from([25, 50]))
def test_the_face_is_a_smooth_spline_through_the_keyframes(phones: list[Phone], fps: int) -> None:
    """C1 across keyframes: scipy's Hermite spline with PCHIP's slopes, and none where the face rests."""
    said = timed(phones, 16000)
    keys = [Keyframe(-1, np.zeros(68), rest=True)]
    for key in (k for t in said for k in keyframes(t, "el", 16000)):
        if key.sample > keys[-1].sample:
            keys.append(key)
    samples = np.array([k.sample for k in keys])
    values = np.array([k.values for k in keys])
    slopes = PchipInterpolator(samples, values).derivative()(samples)
    slopes[[k.rest for k in keys]] = 0
    spline = CubicHermiteSpline(samples, values, slopes)
    for frame in run(said, "el", fps=fps):
        expected = spline(min(frame.sample, samples[-1]))
        assert frame.values[MOUTH] == pytest.approx(expected[MOUTH], abs=0.51)


@pytest.mark.parametrize("fps", [25, 50])
@pytest.mark.parametrize("lang", LANGUAGES)
@pytest.mark.parametrize(("closing", "viseme"), [("p", 1), ("b", 1), ("m", 1), ("f", 2), ("v", 2)])
def test_lips_close_wherever_the_frames_fall(lang: str, closing: str, viseme: int, fps: int) -> None:
    """Any vowels around it, from 50 ms on: one frame at least shows exactly the closure."""
    rng = np.random.default_rng(1)
    for rate in (16000, 22050):
        for before in VOWELS[lang]:
            for after in VOWELS[lang]:
                lead, length = rng.uniform(40, 90), rng.choice([50.0, 60.0, 85.0, 140.0])
                phones = timed(
                    [Phone(SILENCE, lead), Phone(before, 90.0, stress=1), Phone(closing, length),
                     Phone(after, 60.0, stress=1), Phone(SILENCE, 200.0)], rate,
                )  # fmt: skip
                shut = [
                    f for f in run(phones, lang, rate, fps)
                    if np.array_equal(f.values[LIPS], np.rint(visemes()[viseme])[LIPS])
                ]  # fmt: skip
                assert shut, (before, after, rate, lead, length)
                assert all(phones[2].start <= f.sample <= phones[2].end for f in shut)


@pytest.mark.parametrize("name", EXPRESSIONS)
def test_an_expression_reaches_its_full_value_and_goes_back_to_rest(name: str) -> None:
    phones = timed(
        [Phone("a", 100.0), Phone(SILENCE, 1000.0, expression=name), Phone(SILENCE, 400.0)],  # type: ignore[arg-type]
        16000,
    )
    frames = run(phones, "el")
    full = np.rint(expressions()[name])[MOUTH]
    shown = [f.sample for f in frames if np.array_equal(f.values[MOUTH], full)]
    assert len(shown) >= 10
    assert all(1600 + 4000 <= s <= 17600 - 4000 for s in shown)
    assert all(not f.values[MOUTH].any() for f in frames if f.sample >= 17600)


def test_a_short_expression_still_shows() -> None:
    phones = timed([Phone(SILENCE, 120.0, expression="surprise"), Phone(SILENCE, 100.0)], 16000)
    full = np.rint(expressions()["surprise"])[MOUTH]
    assert any(np.array_equal(f.values[MOUTH], full) for f in run(phones, "en"))


def test_no_frame_is_given_before_its_neighbours_are_known() -> None:
    phones = timed([Phone("a", 200.0), Phone("i", 200.0), Phone("u", 200.0), Phone(SILENCE, 200.0)], 16000)
    track = FaceTrack("el", 16000, 25)
    assert track.ready_until() == 0
    ready = []
    for phone in phones:
        track.add([phone])
        ready.append(track.ready_until())
    assert ready == [-1, 1600, 4800, 12800]
    assert [f.sample for f in track.frames(10**9)] == list(range(0, 12800, 640))
    assert track.frames(10**9) == []
    assert track.next_sample == 12800


def test_silence_alone_is_rest() -> None:
    frames = run(timed([Phone(SILENCE, 500.0)], 16000), "en")
    assert len(frames) == 13
    assert not stacked(frames)[:, MOUTH].any()


def test_seed_decides_what_the_face_does_unasked() -> None:
    phones = timed([Phone(SILENCE, 3000.0)], 16000)
    made = []
    for seed in (1, 1, 2):
        track = FaceTrack("en", 16000, 25, seed)
        track.add(phones)
        made.append(stacked(track.frames(48000)))
    assert np.array_equal(made[0], made[1])
    assert not np.array_equal(made[0], made[2])
