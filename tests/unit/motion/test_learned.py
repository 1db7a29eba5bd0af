"""A learned mouth in time: at rest where nothing is said, without a step, and as large as was asked for."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings

from fapstream.motion.articulation import COLUMNS
from fapstream.motion.learned import REST_S, nearly
from fapstream.motion.mouths import Model, Motion, mouth_track
from fapstream.motion.visemes import keyframes
from fapstream.records import SILENCE, Phone, TimedPhone
from tests.unit.fakes import timed
from tests.unit.motion.test_track import turns

RATE, STEP = 16000, 320
LEARNED = pytest.mark.parametrize("model", ["hmm", "ohman"])
SAID = [
    Phone(name, ms, stress=1)
    for name, ms in zip("hElpmifaInd", (80, 90, 70, 80, 60, 120, 90, 150, 60, 80, 70), strict=True)
]
SAID = [Phone(p.name if p.name != "a" else "A", p.duration_ms, stress=p.stress) for p in SAID]


def rows(phones: tuple[TimedPhone, ...], motion: Motion, lang: str = "en") -> np.ndarray:
    """FAPs of jaw and lips, 50 a second."""
    mouth = mouth_track(motion, lang, RATE, 50, phones[0].start)
    for phone in phones:
        mouth.add(phone)
    return mouth.at(np.arange(phones[0].start, phones[-1].end, STEP)).values[:, COLUMNS]


@LEARNED
def test_a_long_pause_is_rest(model: Model) -> None:
    phones = timed([Phone(SILENCE, 500.0), *SAID, Phone(SILENCE, 900.0), *SAID, Phone(SILENCE, 600.0)], RATE)
    made = rows(phones, Motion(model))
    rest = int(REST_S * 50) + 1
    pause = phones[len(SAID) + 1]
    for start, end in ((0, 500 * 16 // STEP - rest), (pause.start // STEP + rest, pause.end // STEP - rest)):
        assert not made[start:end].any()
    assert not made[phones[-1].start // STEP + rest :].any()
    assert np.abs(made[:, 0]).max() > 50


@LEARNED
def test_a_short_pause_is_hardly_rest(model: Model) -> None:
    """Between words without a breath the mouth stays where speech has it."""
    phones = timed([*SAID, Phone(SILENCE, 60.0), *SAID, Phone(SILENCE, 300.0)], RATE)
    pause = phones[len(SAID)]
    assert np.abs(rows(phones, Motion(model))[(pause.start + pause.end) // 2 // STEP]).max() > 10


@LEARNED
@settings(max_examples=30, deadline=None)
@given(turns("en", shortest=40))
def test_nothing_jumps(model: Model, phones: list[Phone]) -> None:
    """No FAP of jaw or lips goes further in 20 ms than 12 mm would be: a person's fastest closing is 8."""
    made = rows(timed(phones, RATE), Motion(model))
    assert np.abs(np.diff(made, axis=0)).max() < 12 * 1024 / 20


@LEARNED
def test_a_phrase_that_comes_after_its_pause_was_shown_does_not_jump(model: Model) -> None:
    phones = timed(
        [*SAID, Phone(SILENCE, 150.0), Phone("A", 200.0, stress=1), *SAID, Phone(SILENCE, 300.0)], RATE
    )
    border = len(SAID) + 1
    mouth = mouth_track(Motion(model), "en", RATE, 50)
    for phone in phones[:border]:
        mouth.add(phone)
    shown = [mouth.at(np.arange(0, phones[border].start, STEP)).values]
    for phone in phones[border:]:
        mouth.add(phone)
    shown.append(mouth.at(np.arange(-(-phones[border].start // STEP) * STEP, phones[-1].end, STEP)).values)
    got = np.concatenate(shown)[:, COLUMNS]
    whole = rows(phones, Motion(model))
    at = phones[border].start // STEP
    usual = np.abs(np.diff(whole, axis=0)).max()
    assert np.abs(np.diff(got[at - 2 : at + 6], axis=0)).max() <= 1.5 * usual
    assert got[at + 8 :] == pytest.approx(whole[at + 8 :], abs=1e-6)


@LEARNED
@pytest.mark.parametrize("gain", [0.5, 1.6])
def test_a_gain_multiplies_what_was_learned(model: Model, gain: float) -> None:
    phones = timed([Phone(SILENCE, 100.0), *SAID, Phone(SILENCE, 300.0)], RATE)
    assert rows(phones, Motion(model, gain)) == pytest.approx(gain * rows(phones, Motion(model)))


@LEARNED
def test_what_the_camera_does_not_see_is_the_keyframes(model: Model) -> None:
    phones = timed([Phone(SILENCE, 100.0), *SAID, Phone(SILENCE, 300.0)], RATE)
    mouths = []
    for name in (model, "keyframes"):
        mouth = mouth_track(Motion(name), "en", RATE, 50)
        for phone in phones:
            mouth.add(phone)
        mouths.append(mouth.at(np.arange(0, phones[-1].end, STEP)))
    others = np.setdiff1d(np.arange(68), COLUMNS)
    assert np.array_equal(mouths[0].values[:, others], mouths[1].values[:, others])
    assert np.array_equal(mouths[0].speaks, mouths[1].speaks)
    assert not mouths[0].jaw
    assert mouths[1].jaw


def test_contacts_are_helped_late_and_wholly() -> None:
    shares = np.array([0.0, 0.5, 0.8, 0.9, 1.0])
    assert nearly(shares) == pytest.approx([0, 0, 0, 0.5, 1])
    assert next(iter(keyframes(timed([Phone("p", 80.0)], RATE)[0], "en", RATE))).contact


@LEARNED
@pytest.mark.parametrize("rate", [8000, 11025, 16000, 22050, 44100, 48000])
def test_any_sample_rate_will_do(model: Model, rate: int) -> None:
    phones = timed([Phone(SILENCE, 100.0), *SAID, Phone(SILENCE, 300.0)], rate)
    mouth = mouth_track(Motion(model), "en", rate, 25)
    for phone in phones:
        mouth.add(phone)
    n = phones[-1].end * 25 // rate
    made = mouth.at(np.arange(n) * rate // 25).values[:, COLUMNS]
    assert made == pytest.approx(
        rows(timed([Phone(SILENCE, 100.0), *SAID, Phone(SILENCE, 300.0)], RATE), Motion(model))[::2][:n],
        abs=12,
    )
