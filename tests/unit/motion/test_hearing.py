"""What is heard at any rate and loudness, in any fragments, and what a mouth makes of it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.motion.articulation import COLUMNS
from fapstream.motion.hearing import BANDS, DEEP, STACKED, Heard, HearingMouth, Listener
from fapstream.motion.speaker import hearing_mouth, speaker
from fapstream.records import Pcm
from tests.unit.voicing import voicing

RATES = (8000, 11025, 16000, 22050, 44100, 48000)


def frames(pcm: Pcm, rate: int) -> tuple[np.ndarray, np.ndarray]:
    listener = Listener(rate)
    listener.add(pcm)
    found = listener.frames(last=True)
    return np.concatenate([bands for bands, _ in found]), np.array([level for _, level in found])


def made(pcm: Pcm, rate: int = 16000, cuts: list[int] | None = None) -> tuple[np.ndarray, np.ndarray]:
    """FAPs of jaw and lips and how much is spoken, 50 a second."""
    mouth = hearing_mouth(rate)
    for part in np.split(pcm, sorted(cuts or [])):
        mouth.hear(part)
    mouth.end()
    found = mouth.at(np.arange(-(-len(pcm) * 50 // rate)) * rate // 50)
    return found.values[:, COLUMNS], np.asarray(found.speaks)


@pytest.mark.parametrize("rate", RATES)
def test_a_tone_is_heard_in_its_band_whatever_the_rate(rate: int) -> None:
    t = np.arange(rate // 2) / rate
    heard = {}
    for hz in (300, 1000, 3000):
        pcm = (8000 * np.sin(2 * np.pi * hz * t)).astype(np.int16)
        bands, _ = frames(pcm, rate)
        heard[hz] = int(bands[10:40].mean(axis=0).argmax())
    assert heard[300] < heard[1000] < heard[3000]
    assert heard == {300: 3, 1000: 11, 3000: 21} or abs(heard[1000] - 11) <= 1


@pytest.mark.parametrize("rate", [8000, 22050, 48000])
def test_the_same_sound_is_heard_alike_at_every_rate(rate: int) -> None:
    one, _ = frames(voicing(1.0, 16000), 16000)
    other, _ = frames(voicing(1.0, rate), rate)
    n = min(len(one), len(other))
    loud = one[5 : n - 5] > -5
    assert np.abs(one[5 : n - 5] - other[5 : n - 5])[loud].mean() < 0.6


def test_who_speaks_softly_is_heard_alike() -> None:
    loud, soft = (frames((voicing(2.0) * gain).astype(np.int16), 16000)[0] for gain in (1.0, 0.15))
    heard = loud[40:] > -5
    assert np.abs(loud[40:] - soft[40:])[heard].mean() < 0.5


def test_frames_are_bounded_whatever_comes() -> None:
    rng = np.random.default_rng(0)
    for pcm in (
        np.zeros(8000),
        rng.integers(-32768, 32768, 8000),
        np.full(8000, -32768),
        np.full(8000, 32767),
    ):
        bands, levels = frames(pcm.astype(np.int16), 16000)
        assert np.isfinite(bands).all()
        assert np.isfinite(levels).all()
        assert bands.min() >= -DEEP
        assert bands.max() < DEEP


@settings(max_examples=20, deadline=None)
@given(st.lists(st.integers(0, 16000), max_size=20))
def test_fragments_do_not_matter(cuts: list[int]) -> None:
    pcm = voicing(1.0)
    assert np.array_equal(made(pcm)[0], made(pcm, cuts=cuts)[0])


def test_one_sample_at_a_time_is_a_fragment_too() -> None:
    pcm = voicing(0.1)
    assert np.array_equal(made(pcm)[0], made(pcm, cuts=list(range(1, len(pcm))))[0])


@pytest.mark.parametrize("rate", RATES)
def test_what_can_be_told_lies_behind_by_the_delay(rate: int) -> None:
    mouth = hearing_mouth(rate)
    assert mouth.delay_s <= 0.3
    pcm = voicing(1.0, rate)
    for at in range(0, len(pcm), rate // 100):
        mouth.hear(pcm[at : at + rate // 100])
        heard = min(at + rate // 100, len(pcm))
        assert heard - mouth.ready_until() <= (mouth.delay_s + 0.02) * rate + 2
    mouth.end()
    assert mouth.ready_until() >= len(pcm)


@pytest.mark.parametrize(
    "pcm",
    [
        np.zeros(32000, np.int16),
        np.full(32000, 700, np.int16),
        np.random.default_rng(1).normal(0, 200, 32000).astype(np.int16),
        (300 * np.sin(2 * np.pi * 50 * np.arange(32000) / 16000)).astype(np.int16),
    ],
    ids=["silence", "offset", "noise", "hum"],
)
def test_what_is_no_speech_moves_nothing_to_speak_of(pcm: Pcm) -> None:
    """But for the clicks with which it begins and ends."""
    rows, speaks = made(pcm)
    assert np.abs(rows[15:-15]).max() < 25
    assert speaks[15:-15].max() < 0.1


def test_it_comes_from_rest_and_goes_to_it_without_a_step() -> None:
    silence = np.zeros(8000, np.int16)
    rows, speaks = made(np.concatenate([silence, voicing(1.5), silence]))
    assert np.abs(np.diff(rows, axis=0)).max() < 250
    assert not rows[:10].any()
    assert not rows[-8:].any()
    assert speaks[30:90].mean() > 0.7


def test_nothing_grows_with_the_turn() -> None:
    mouth = hearing_mouth(16000)
    sizes = []
    for second in range(20):
        mouth.hear(voicing(1.0, seed=second))
        until = mouth.ready_until()
        mouth.at(np.arange(max(0, until - 8000), until, 320) // 320 * 320)
        sizes.append(len(mouth._rows) + len(mouth._listener._kept))
    assert max(sizes[10:]) <= max(sizes[3:10]) + 400


def test_it_makes_what_its_network_says() -> None:
    """A network that always says the same: the mouth is there while somebody speaks."""
    n = speaker().articulation.n
    said = np.zeros((2, n))
    said[1] = [1, 0, 0, 0, 0, 0]
    heard = Heard(
        np.zeros(STACKED * BANDS), np.ones(STACKED * BANDS), np.zeros((STACKED * BANDS + 1, 1)), said
    )
    mouth = HearingMouth(16000, heard, speaker().articulation)
    mouth.hear(voicing(2.0, syllable_s=10.0))
    mouth.end()
    rows = mouth.at(np.arange(0, 32000, 320)).values[:, COLUMNS]
    assert rows[50] == pytest.approx(speaker().articulation.faps(said[1]), abs=1e-6)


def test_what_the_ear_cannot_tell_is_left_alone() -> None:
    mouth = hearing_mouth(16000)
    mouth.hear(voicing(0.5))
    mouth.end()
    found = mouth.at(np.arange(0, 8000, 320))
    others = np.setdiff1d(np.arange(68), COLUMNS)
    assert not found.values[:, others].any()
    assert (found.seal, found.bite, found.jaw) == (0.0, 0.0, False)
