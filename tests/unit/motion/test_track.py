"""Timed phones to frames: smooth, on the clock, with lips that close, and the same however phones arrive."""

from __future__ import annotations

from itertools import product
from typing import Literal

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

from fapstream.fap import EXPRESSIONS, expressions, visemes
from fapstream.motion.closure import BITTEN, LOWER, UPPER, VERTICAL
from fapstream.motion.feeling import GO_S
from fapstream.motion.keyframed import KeyframedMouth
from fapstream.motion.learned import REST_S
from fapstream.motion.mouths import DEFAULT_MODEL, MODELS, Model, Motion
from fapstream.motion.speech import Speaking
from fapstream.motion.track import FaceTrack
from fapstream.motion.visemes import N_CHANNELS, Keyframe, keyframes
from fapstream.records import SILENCE, FapFrame, Phone, TimedPhone
from fapstream.tts import LANGUAGES, phone_set
from tests.unit.fakes import timed

IDLE = [*range(18, 26), *range(30, 36), 47, 48, 49]
"""Columns of the FAPs that blinks, gaze, head motion and gestures also move."""

MOUTH = [i for i in range(2, 68) if i not in IDLE]
LIPS = [3, 4, 7, 8, 9, 10, 11, 12, 50, 51, 54, 55, 56, 57, 58, 59]
"""Columns of FAPs 4, 5, 8-13, 51, 52, 55-60: the lips' own lines."""

VOWELS = {lang: [p for p, i in phone_set(lang).items() if i.kind == "vowel"] for lang in LANGUAGES}


MODEL = pytest.mark.parametrize("model", MODELS)


def run(
    phones: tuple[TimedPhone, ...], lang: str, rate: int = 16000, fps: int = 25, model: Model = DEFAULT_MODEL
) -> list[FapFrame]:
    track = FaceTrack(lang, rate, fps, motion=Motion(model))
    track.add(phones)
    return track.frames(phones[-1].end)


def contact(values: NDArray[np.int32], viseme: int) -> int:
    """How far, FAP units, the lips are from where they have to meet, or the lower lip from the teeth."""
    wanted = np.rint(visemes()[viseme])
    if viseme == BITTEN:
        return int(np.abs((values - wanted)[LOWER[VERTICAL]]).max())
    apart = (values - wanted)[UPPER[VERTICAL]] + (values - wanted)[LOWER[VERTICAL]]
    return int(np.abs(apart).max())


def stacked(frames: list[FapFrame]) -> NDArray[np.int32]:
    return np.array([f.values for f in frames]).reshape(-1, 68)


def turns(lang: str, shortest: float = 15) -> st.SearchStrategy[list[Phone]]:
    """Phones with pauses and expressions among them; the last is a pause."""
    name = st.sampled_from([n for n in phone_set(lang) if n != SILENCE])
    sound = st.builds(
        lambda name, ms, stress: Phone(name, ms, stress=stress),
        name,
        st.floats(shortest, 250),
        st.integers(0, 2),
    )
    pause = st.builds(
        lambda ms, expression: Phone(SILENCE, ms, expression=expression),
        st.floats(10, 900),
        st.sampled_from([None, None, *EXPRESSIONS]),
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


@MODEL
@settings(max_examples=40, deadline=None)
@given(data=st.data(), lang=st.sampled_from(LANGUAGES), fps=st.sampled_from([25, 50]))
def test_batches_do_not_matter(data: st.DataObject, lang: str, fps: Literal[25, 50], model: Model) -> None:
    """Phones in any batches, frames taken in between as soon as they can be: the same frames.

    Except that a pause, while nothing is known to follow it, is asked for only up to its start: what is
    given beyond is rest, from which the face then leaves later than it would have, had the next phone
    been known (see the test below).
    """
    phones = timed(data.draw(turns(lang)), 22050)
    track, got, i = FaceTrack(lang, 22050, fps, motion=Motion(model)), [], 0
    while i < len(phones):
        n = data.draw(st.integers(1, 6))
        track.add(phones[i : i + n])
        i += n
        last = phones[min(i, len(phones)) - 1]
        asked = last.start if last.phone.name == SILENCE and i < len(phones) else last.end
        got += track.frames(data.draw(st.integers(0, asked)))
        got += track.frames(asked)
    whole = run(phones, lang, 22050, fps, model)
    assert [f.sample for f in got] == [f.sample for f in whole]
    assert np.array_equal(stacked(got), stacked(whole))


@MODEL
@settings(max_examples=40, deadline=None)
@given(first=turns("en"), second=turns("en"))
def test_a_pause_given_out_before_its_end_changes_only_how_the_face_leaves_it(
    first: list[Phone], second: list[Phone], model: Model
) -> None:
    """The slope at the first keyframe after the pause may differ too, and so what lies before the second; a
    learned mouth is where it would have been after a tenth of a second."""
    phones = timed([*first, *second], 16000)
    border = phones[len(first) - 1].end
    track = FaceTrack("en", 16000, 50, motion=Motion(model))
    track.add(phones[: len(first)])
    got = track.frames(border)
    assert track.ready_until() == border
    track.add(phones[len(first) :])
    got += track.frames(phones[-1].end)
    whole = run(phones, "en", fps=50, model=model)
    rest = 120 * 16 if model == "keyframes" else REST_S * 16000
    after = [t.end for t in phones[len(first) :]]
    settled = max(after[:2][-1], border + 1600)
    for a, b in zip(got, whole, strict=True):
        if a.sample < border - rest or a.sample >= settled:
            assert np.array_equal(a.values, b.values)
    pause = phones[len(first) - 1]
    if not any(t.phone.expression for t in phones[: len(first)]):
        in_pause = [f for f in got if pause.start + rest <= f.sample < border]
        assert not stacked(in_pause)[:, MOUTH].any()


@settings(max_examples=40, deadline=None)
@given(turns("el", shortest=50))
def test_speech_is_a_smooth_spline_through_the_keyframes(phones: list[Phone]) -> None:
    """C1 across keyframes: scipy's Hermite spline with PCHIP's slopes, and none where the mouth rests."""
    said = timed(phones, 16000)
    keys = [Keyframe(-1, np.zeros(N_CHANNELS), rest=True)]
    track = KeyframedMouth(Speaking("en", 16000), 50)
    for phone in said:
        found = list(keyframes(phone, "el", 16000))
        track.add_keys(found, phone.end)
        keys += [key for key in found if key.sample > keys[-1].sample]
    samples = np.array([k.sample for k in keys])
    values = np.array([k.values for k in keys])
    slopes = PchipInterpolator(samples, values).derivative()(samples)
    slopes[[k.rest for k in keys]] = 0
    spline = CubicHermiteSpline(samples, values, slopes)
    for sample in range(0, said[-1].end, 320):
        mouth, expected = track.at(sample), spline(min(sample, samples[-1]))
        assert mouth.values == pytest.approx(expected[:68], abs=1e-6)
        assert [mouth.speaks, mouth.seal, mouth.bite] == pytest.approx(expected[68:], abs=1e-6)


@MODEL
@pytest.mark.parametrize("fps", [25, 50])
@pytest.mark.parametrize("lang", LANGUAGES)
@pytest.mark.parametrize(("closing", "viseme"), [("p", 1), ("b", 1), ("m", 1), ("f", 2), ("v", 2)])
def test_lips_close_wherever_the_frames_fall(
    lang: str, closing: str, viseme: int, fps: int, model: Model
) -> None:
    """Any vowels around it, however short: one frame at least shows exactly the closure, near its phone."""
    rng = np.random.default_rng(1)
    for before, after in list(product(VOWELS[lang], VOWELS[lang]))[::3]:
        rate = int(rng.choice([16000, 22050]))
        lead, length = rng.uniform(40, 90), rng.choice([20.0, 30.0, 40.0, 60.0, 85.0, 140.0])
        phones = timed(
            [Phone(SILENCE, lead), Phone(before, 90.0, stress=1), Phone(closing, length),
             Phone(after, 60.0, stress=1), Phone(SILENCE, 200.0)], rate,
        )  # fmt: skip
        early, late = phones[2].start - rate / fps / 2, phones[2].end + rate / fps / 2
        near = [f for f in run(phones, lang, rate, fps, model) if early <= f.sample <= late]
        assert min(contact(f.values, viseme) for f in near) <= 1, (before, after, rate, lead, length)


NAMES = st.sampled_from(["p", "m", "f", "a", "i", "s", "u"])
QUICK = st.lists(
    st.builds(lambda name, ms: Phone(name, ms), NAMES, st.floats(25, 120)), min_size=1, max_size=12
)


@MODEL
@settings(max_examples=40, deadline=None)
@given(phones=QUICK, fps=st.sampled_from([25, 50]))
@example(phones=[Phone("p", 25.0), Phone("f", 25.0)], fps=25)
@example(phones=[Phone("f", 30.0), Phone("p", 25.0)], fps=25)
def test_every_closure_of_quick_speech_is_seen(phones: list[Phone], fps: int, model: Model) -> None:
    """Phones down to 25 ms, several closures in a row: each is seen, or shares the frame of its neighbour."""
    said = timed([Phone(SILENCE, 50.0), *phones, Phone(SILENCE, 200.0)], 16000)
    frames = run(said, "el", fps=fps, model=model)
    near = 1.5 * 16000 / fps
    for phone in said:
        viseme = {"p": 1, "m": 1, "f": 2}.get(phone.phone.name)
        if viseme is None:
            continue
        around = [f for f in frames if phone.start - near <= f.sample <= phone.end + near]
        assert min(contact(f.values, viseme) for f in around) <= 1


def test_an_expression_is_whole_in_its_pause_and_goes_after_the_phrase() -> None:
    phones = timed(
        [Phone("a", 100.0), Phone(SILENCE, 1000.0, expression="sadness"), Phone("i", 200.0),
         Phone("a", 300.0), Phone(SILENCE, 2000.0)], 16000,
    )  # fmt: skip
    frames = run(phones, "el")
    brows = [36, 37]
    full = expressions()["sadness"][brows]
    share = {f.sample: (f.values[brows] / full).min() for f in frames}
    assert all(v == pytest.approx(1, abs=0.02) for s, v in share.items() if 9000 <= s <= 17600)
    assert all(v > 0.6 for s, v in share.items() if 17600 <= s < phones[3].end)
    assert all(v == 0 for s, v in share.items() if s > phones[3].end + GO_S * 16000)


@pytest.mark.parametrize(
    ("model", "expected"),
    [
        ("keyframes", [-1, 1600, 4800, 12800]),
        ("hmm", [0, 0, 3200, 12800]),
        ("ohman", [0, 0, 0, 12800]),
    ],
)
def test_no_frame_is_given_before_its_neighbours_are_known(model: Model, expected: list[int]) -> None:
    phones = timed([Phone("a", 200.0), Phone("i", 200.0), Phone("u", 200.0), Phone(SILENCE, 200.0)], 16000)
    track = FaceTrack("el", 16000, 25, motion=Motion(model))
    assert track.ready_until() == 0
    ready = []
    for phone in phones:
        track.add([phone])
        ready.append(track.ready_until())
    assert [max(0, r) for r in ready] == [max(0, r) for r in expected]
    assert [f.sample for f in track.frames(10**9)] == list(range(0, 12800, 640))
    assert track.frames(10**9) == []
    assert track.next_sample == 12800


@MODEL
def test_silence_alone_is_rest(model: Model) -> None:
    frames = run(timed([Phone(SILENCE, 500.0)], 16000), "en", model=model)
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


def sentence(n: int) -> list[Phone]:
    return [Phone(name, 90.0, stress=k % 2) for k, name in enumerate("mapitoka" * n)]


@pytest.mark.parametrize("fps", [25, 50])
@pytest.mark.parametrize("at", [8000, 12345, 15999, 16000, 20001])
@MODEL
def test_a_cut_goes_on_from_what_was_shown(at: int, fps: int, model: Model) -> None:
    """Frames given beyond it are given again, on the turn's grid; the face moves no faster than speech."""
    track = FaceTrack("el", 16000, fps, 3, Motion(model))
    track.add(timed([*sentence(3), Phone(SILENCE, 300.0)], 16000))
    old = track.frames(32000)
    track.cut(at)
    assert track.frames(10**9) == []
    track.add(timed([*sentence(2), Phone(SILENCE, 300.0)], 16000, at))
    new = track.frames(at + 12000)
    assert [f.sample for f in new] == [s for s in range(0, at + 12000, 16000 // fps) if s >= at]
    kept = [f for f in old if f.sample < at]
    usual = np.abs(np.diff(stacked(old), axis=0)).max()
    seam = np.abs(np.diff(stacked(kept[-1:] + new[: fps // 5]), axis=0)).max()
    assert seam <= usual
    alone = FaceTrack("el", 16000, fps, 3, Motion(model))
    alone.add(timed([Phone(SILENCE, at / 16), *sentence(2), Phone(SILENCE, 300.0)], 16000))
    expected = {f.sample: f.values for f in alone.frames(at + 12000)}
    for frame in new:
        if frame.sample >= at + 3200:
            assert np.abs((frame.values - expected[frame.sample])[MOUTH]).max() <= 1


def test_a_cut_beyond_what_was_given_gives_the_rest_first() -> None:
    """Also where the old track could not be told so far: there the face waits."""
    phones = timed(sentence(3), 16000)
    whole, track = FaceTrack("el", 16000, 25, 3), FaceTrack("el", 16000, 25, 3)
    for made in (whole, track):
        made.add(phones)
    first = track.frames(9600)
    ready = track.ready_until()
    track.cut(phones[-1].end)
    track.add(timed([*sentence(1), Phone(SILENCE, 200.0)], 16000, phones[-1].end))
    rest = track.frames(10**9)
    assert [f.sample for f in first + rest] == list(range(0, rest[-1].sample + 1, 640))
    expected = whole.frames(ready)
    assert np.array_equal(stacked(first + rest)[: len(expected)], stacked(expected))


def test_cut_again_and_again() -> None:
    track, at, shown = FaceTrack("en", 16000, 25, 1), 0, dict[int, NDArray[np.int32]]()
    for k in range(30):
        track.add(timed([*sentence(1 + k % 3), Phone(SILENCE, 150.0)], 16000, at))
        frames = track.frames(at + 10000)
        shown |= {f.sample: f.values for f in frames}
        at += 1234 + 517 * (k % 5)
        track.cut(at)
        shown = {s: v for s, v in shown.items() if s < at}
    assert sorted(shown) == list(range(0, max(shown) + 1, 640))


@MODEL
def test_nothing_grows_with_the_turn(model: Model) -> None:
    track, at = FaceTrack("en", 16000, 25, 1, Motion(model)), 0
    sizes = []
    for _ in range(60):
        phones = timed([*sentence(4), Phone(SILENCE, 300.0)], 16000, at)
        track.add(phones)
        at = phones[-1].end
        track.frames(at)
        mouth = track._speech
        own = [mouth._keys] if isinstance(mouth, KeyframedMouth) else [mouth._units, mouth._rows]
        kept = (track._shown, track._made, *own, track._gestures._gestures,
                track._gestures._blinks, track._feeling._episodes)  # fmt: skip
        sizes.append(sum(map(len, kept)))
    assert max(sizes[30:]) <= max(sizes[5:30]) + 5
