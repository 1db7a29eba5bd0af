"""Nods and brows on accents, nods and blinks at phrase ends: where, how often, how far."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from fapstream.motion.gestures import Gestures, accent, table
from fapstream.motion.mixer import AU
from fapstream.records import SILENCE, Phone, TimedPhone
from tests.unit.fakes import timed

RATE = 16000
RISING = ((0.0, 120.0), (50.0, 138.0))
ACCENTED = Phone("a", 180.0, RISING, stress=1)
PHRASE = [
    Phone("m", 80.0),
    Phone("a", 90.0),
    ACCENTED,
    Phone("t", 70.0),
    Phone("i", 90.0),
    Phone(SILENCE, 350.0),
]


def gestures(phones: list[Phone], seed: int = 1) -> tuple[Gestures, tuple[TimedPhone, ...]]:
    said = timed(phones, RATE)
    stream = Gestures(seed, RATE)
    for phone in said:
        stream.add(phone)
    return stream, said


Track = tuple[NDArray[np.float64], NDArray[np.float64]]


def track(stream: Gestures, seconds: float, rate: int = 100) -> Track:
    rows = [stream.at(k / rate) for k in range(int(seconds * rate))]
    return np.array([r[0] for r in rows]), np.array([r[1] for r in rows])


@pytest.mark.parametrize(
    ("phone", "least", "most"),
    [(ACCENTED, 0.9, 1.0), (Phone("a", 90.0, ((0.0, 120.0), (50.0, 121.0)), stress=1), 0, 0),
     (Phone("a", 90.0, RISING, stress=0), 0, 0), (Phone("a", 90.0, RISING, stress=2), 0, 0),
     (Phone("a", 90.0, ((0.0, 120.0), (50.0, 129.0)), stress=1), 0.3, 0.7),
     (Phone("a", 90.0, stress=1), 0.5, 0.5),
     (Phone("a", 90.0, ((0.0, 120.0),), stress=1), 0, 0)],
)  # fmt: skip
def test_an_accent_is_a_stressed_vowel_whose_melody_rises(phone: Phone, least: float, most: float) -> None:
    assert least <= accent(phone) <= most


def test_about_so_many_accents_move_head_and_brows() -> None:
    phrases = 200
    stream, said = gestures(PHRASE * phrases)
    values, _ = track(stream, said[-1].end / RATE, 50)
    starts = [p.start / RATE for p in said if p.phone == ACCENTED]
    nods = sum(values[round(50 * (s + 0.12)), 47] > 500 for s in starts)
    brows = sum(values[round(50 * (s + 0.16)), 32] > 20 for s in starts)
    assert 0.5 <= nods / phrases <= 0.8, "on the accent, or still going on from the phrase end"
    assert 0.3 <= brows / phrases <= 0.5


def test_gestures_are_small_soft_and_nothing_else_moves() -> None:
    stream, said = gestures(PHRASE * 60)
    values, shut = track(stream, said[-1].end / RATE + 2)
    moved = set(np.flatnonzero(values.any(axis=0)) + 1)
    assert moved == {48, *range(31, 37)}
    assert 0.02 < values[:, 47].max() * AU < 0.08
    assert 60 < values[:, 30:36].max() <= table()["brows"]["raise"][1] + 1e-6
    assert (values >= -1e-9).all()
    assert np.abs(np.diff(values[:, 47])).max() * AU < 0.006, "radians in 10 ms"
    assert not values[-1].any()
    assert 0 <= shut.min() <= shut.max() == pytest.approx(1)


def test_people_blink_at_phrase_ends_and_not_within() -> None:
    stream, said = gestures(PHRASE * 100)
    _, shut = track(stream, said[-1].end / RATE)
    onsets = (np.flatnonzero(np.diff((shut > 0).astype(int)) == 1)) / 100
    ends = np.array([p.start / RATE for p in said if p.phone.name == SILENCE])
    assert all(np.abs(ends - t).min() <= 0.03 for t in onsets)
    assert 35 <= len(onsets) <= 65


def test_a_gesture_begins_no_earlier_than_the_phone_that_calls_for_it() -> None:
    """Frames up to a phone's start may have been shown when it comes."""
    said = timed(PHRASE * 5, RATE)
    known, stream = Gestures(3, RATE), Gestures(3, RATE)
    for phone in said:
        known.add(phone)
    for phone in said:
        stream.add(phone)
        for sample in np.linspace(phone.start, phone.end, 4):
            got, expected = stream.at(sample / RATE), known.at(sample / RATE)
            assert np.array_equal(got[0], expected[0])
            assert got[1] == expected[1]


def test_seeded() -> None:
    first, second, other = (track(gestures(PHRASE * 10, seed)[0], 8.0) for seed in (1, 1, 2))
    assert np.array_equal(first[0], second[0])
    assert not np.array_equal(first[0], other[0])


def test_silence_calls_for_nothing() -> None:
    stream, _ = gestures([Phone(SILENCE, 500.0)] * 10)
    values, shut = track(stream, 5.0)
    assert not values.any()
    assert not shut.any()


def test_old_gestures_are_forgotten() -> None:
    stream, said = gestures(PHRASE * 100)
    stream.at(said[-1].end / RATE)
    assert len(stream._gestures) < 20
    assert len(stream._blinks) < 10


def test_a_cut_makes_void_what_begins_later_and_ends_what_has_begun() -> None:
    whole, said = gestures(PHRASE * 20)
    at = 7.3
    stream, _ = gestures(PHRASE * 20)
    stream.at(at + 3.0)
    stream.cut(at)
    before = np.arange(at - 1.0, at, 0.01)
    assert np.array_equal(stream.at(before)[0], whole.at(before)[0])
    values, _ = stream.at(np.arange(at, at + 3, 0.01))
    assert np.abs(np.diff(values[:, 47])).max() * AU < 0.006
    assert not values[150:].any()
    assert not stream.at(np.arange(at + 1.5, at + 3, 0.01))[1]
    assert said[-1].end / RATE > at + 3
    for phone in timed(PHRASE, RATE, round(at * RATE)):
        stream.add(phone)
    assert stream._gestures[-1].start >= at
