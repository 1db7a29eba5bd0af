"""Pitch periods found, left out, said twice, and continued."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.stream import stretch

RATE = 16_000


def vowel(f0: float, seconds: float, rate: int = RATE) -> stretch.Sound:
    """Pulses through three formants: what a voice is to a correlator."""
    t = np.arange(round(seconds * rate)) / rate
    sound = np.zeros(len(t))
    for k in range(1, int(3500 / f0)):
        gain = sum(1 / (1 + ((k * f0 - f) / 120) ** 2) for f in (600, 1200, 2500))
        sound += gain * np.cos(2 * np.pi * k * f0 * t + k * k)
    return 0.3 * sound / np.abs(sound).max()


@pytest.mark.parametrize("rate", [16_000, 22_050, 48_000])
@pytest.mark.parametrize("f0", [80.0, 113.0, 190.0, 310.0])
@pytest.mark.parametrize("way", [1, -1])
def test_the_period_of_a_voice_is_found_or_some_of_them(rate: int, f0: float, way: int) -> None:
    sound = vowel(f0, 0.2, rate)
    lag, alike = stretch.period(sound, len(sound) // 2, way, rate)
    periods = lag * f0 / rate
    assert alike > 0.96
    assert abs(periods - round(periods)) * rate / f0 <= 1.5, "samples from a whole number of periods"


def test_noise_has_no_period_and_little_sound_none_to_be_found() -> None:
    noise = np.random.default_rng(1).normal(0, 0.1, 2000)
    assert stretch.period(noise, 1000, 1, RATE)[1] < stretch.ALIKE
    assert stretch.period(noise[:200], 100, 1, RATE) == (0, 0.0)
    assert stretch.period(noise, 10, -1, RATE) == (0, 0.0)
    assert stretch.period(noise, 1990, 1, RATE) == (0, 0.0)


def test_quiet_is_what_nobody_misses() -> None:
    assert stretch.is_quiet(np.zeros(100))
    assert stretch.is_quiet(np.full(100, 0.003))
    assert not stretch.is_quiet(vowel(100, 0.02))


def test_a_fade_goes_from_one_to_the_other() -> None:
    mixed = stretch.fade(np.ones(9), np.zeros(9))
    assert mixed == pytest.approx(np.linspace(0.9, 0.1, 9))
    assert len(stretch.fade(np.zeros(0), np.zeros(0))) == 0


@pytest.mark.parametrize("f0", [90.0, 200.0])
def test_a_voice_that_breaks_off_dies_away_at_its_own_pitch(f0: float) -> None:
    past = vowel(f0, 0.1)
    gone = stretch.fall(past, RATE, 0.04)
    assert len(gone) == 640
    joined = np.concatenate([past, gone])
    assert np.abs(np.diff(joined[len(past) - 1 :])).max() <= 1.3 * np.abs(np.diff(past)).max(), "no click"
    assert abs(gone[-1]) < 0.01
    further = vowel(f0, 0.12)[len(past) : len(past) + 160]
    assert np.corrcoef(gone[:160], further)[0, 1] > 0.95, "it goes on as it would have"


def test_noise_that_breaks_off_does_not_buzz() -> None:
    noise = np.random.default_rng(2).normal(0, 0.1, 1000)
    gone = stretch.fall(noise, RATE, 0.04)
    assert len(gone) == round(stretch.NOISE_FALL_S * RATE)
    assert len(gone) < stretch.periods(RATE)[1], "less than what is repeated"


def test_a_step_or_nothing_at_all_dies_away_at_once() -> None:
    assert not stretch.fall(np.zeros(0), RATE, 0.04).any()
    assert not stretch.fall(np.zeros(5000), RATE, 0.04).any()
    gone = stretch.fall(np.full(10, 0.5), RATE, 0.04)
    assert (np.diff(np.concatenate([[0.5], gone])) <= 0).all()
    assert -np.diff(gone).min() < 0.03
    assert gone[-1] < 1e-3
