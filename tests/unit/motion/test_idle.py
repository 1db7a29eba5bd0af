"""Idle life has the statistics of people, over minutes: the numbers and sources of data/life.json."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from math import degrees, hypot

import numpy as np
import pytest
from numpy.typing import NDArray

from fapstream.motion.idle import Blinks, Gaze, Idle, IdleLife, Mode, blink, life, sway

FINE = 100
"""Looks a second."""


@cache
def track(seed: int, mode: Mode = "talk", seconds: int = 200, rate: int = FINE) -> list[Idle]:
    alive = IdleLife(seed, mode)
    return [alive.at(k / rate) for k in range(seconds * rate)]


@cache
def shut(seed: int, mode: Mode) -> NDArray[np.float64]:
    """Ten minutes."""
    return np.asarray(Blinks(seed, mode).shut(np.arange(600 * FINE) / FINE))


@pytest.mark.parametrize("mode", ["talk", "listen"])
def test_many_instants_are_the_same_as_each_alone(mode: Mode) -> None:
    alone, together = IdleLife(7, mode), IdleLife(7, mode)
    for first, n in ((0, 1), (1, 400), (401, 2), (403, 997)):
        times = (first + np.arange(n)) / 25
        many = together.at(times)
        rows = np.array([many.shut, many.look.yaw, many.look.pitch, many.look.nearness, *many.head]).T
        for t, row in zip(times.tolist(), rows, strict=True):
            one = alone.at(t)
            look = one.look
            assert row == pytest.approx([one.shut, look.yaw, look.pitch, look.nearness, *one.head], abs=1e-12)


def blinks(seed: int, mode: Mode) -> list[NDArray[np.float64]]:
    """Runs of looks at which the eye is not open, each whole."""
    found = shut(seed, mode)
    edges = np.flatnonzero(np.diff((found > 0).astype(int))) + 1
    runs = np.split(found, edges)
    return [run for run in runs[1:-1] if run[0] > 0]


def onsets(seed: int, mode: Mode) -> NDArray[np.float64]:
    """When blinks begin, s."""
    return (np.flatnonzero(np.diff((shut(seed, mode) > 0).astype(int)) == 1) + 1) / FINE


def test_seeded_and_a_function_of_time_in_any_order() -> None:
    whole = track(5, seconds=60)
    assert whole != track(6, seconds=60)
    alive = IdleLife(5)
    for k in (4500, 17, 2400, 2401, 200, 5999):
        assert alive.at(k / FINE) == whole[k]


@pytest.mark.parametrize(("mode", "least", "most"), [("talk", 3.3, 4.4), ("listen", 3.1, 4.1)])
def test_blinks_come_at_human_intervals(mode: Mode, least: float, most: float) -> None:
    """14 to 18 a minute, skewed to the right as in Bentivoglio et al.; never in each other's way."""
    intervals = np.concatenate([np.diff(onsets(seed, mode)) for seed in (1, 2, 3)])
    assert least <= intervals.mean() <= most
    assert np.median(intervals) < intervals.mean()
    assert 0.4 <= np.log(intervals).std() <= 0.75
    assert intervals.min() >= life()["blink"]["interval_s"][mode]["least"] - 1 / FINE


def test_a_blink_goes_down_twice_as_fast_as_it_comes_up() -> None:
    for run in blinks(1, "talk"):
        deepest = int(run.argmax()) / FINE
        assert 0.06 <= deepest <= 0.14
        assert 0.22 <= len(run) / FINE <= 0.34
        assert run.max() == pytest.approx(1) or run.max() == pytest.approx(0.75, abs=0.01)
        assert np.abs(np.diff(run)).max() < 0.3
        down, up = (run[: int(run.argmax())] > 0.02).sum(), (run[int(run.argmax()) :] > 0.02).sum()
        assert up > down
    deep = [run.max() > 0.9 for seed in (1, 2, 3) for run in blinks(seed, "talk")]
    assert 0.8 <= np.mean(deep) < 1, "about one in ten is not complete"


def test_the_course_of_a_blink_is_continuous_and_ends() -> None:
    for k in range(50):
        course = np.array([blink(1, k, t) for t in np.arange(0, 0.5, 0.001)])
        assert (course[0], course[-1], course.max()) == (0, 0, 1)
        assert np.abs(np.diff(course)).max() < 0.04


def world(seed: int, mode: Mode) -> NDArray[np.float64]:
    """Where the eyes aim for ten minutes, degrees, shape (n, 2)."""
    aim = Gaze(seed, mode).at(np.arange(600 * 20) / 20)[0]
    return np.degrees([aim.yaw, aim.pitch]).T


@pytest.mark.parametrize(("mode", "least", "most"), [("talk", 0.68, 0.86), ("listen", 0.88, 0.98)])
def test_the_eyes_are_on_the_viewer_most_of_the_time(mode: Mode, least: float, most: float) -> None:
    """Lee, Badler and Badler: 77 of 100 while talking, 95 while listening."""
    aim = np.concatenate([world(seed, mode) for seed in (1, 2, 3)])
    middle = [0, degrees(life()["gaze"]["viewer"]["pitch_rad"])]
    near = np.hypot(*(aim - middle).T) < 3.2
    assert least <= near.mean() <= most
    assert np.abs(aim).max() < 18


def saccades(seed: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Size in degrees and duration in s of the saccades that stand alone, looked at 1000 times a second."""
    gaze, rate = Gaze(seed, "talk"), 1000
    look = gaze.at(np.arange(60 * rate) / rate)[0]
    aim = np.array([look.yaw, look.pitch]).T
    speed = np.hypot(*np.diff(np.degrees(aim), axis=0).T) * rate
    edges = np.flatnonzero(np.diff((speed > 1e-6).astype(int)))
    runs = [(a, b) for a, b in pairwise(edges) if speed[a + 1] > 1e-6]
    size = np.array([hypot(*np.degrees(aim[b + 1] - aim[a])) for a, b in runs])
    return size, np.array([(b - a) / rate for a, b in runs])


def test_saccades_keep_the_main_sequence_and_are_mostly_small() -> None:
    """Duration = 21 ms + 2.2 ms a degree (Carpenter); two that overlap are longer, and rare."""
    size, duration = saccades(1)
    assert len(size) >= 40
    alone = np.abs(duration - 0.021 - 0.0022 * size) < 0.004
    assert alone.mean() > 0.9
    assert size.max() > 5
    assert np.median(size) < 3
    assert (size < 0.6).mean() > 0.15, "some stay at the point they looked at"


def test_fixations_last_a_fifth_of_a_second_to_two() -> None:
    gaze, rate = Gaze(2, "listen"), 500
    aim = np.asarray(gaze.at(np.arange(120 * rate) / rate)[0].yaw)
    still = np.abs(np.diff(aim)) < 1e-12
    edges = np.flatnonzero(np.diff(still.astype(int)))
    spans = np.diff(edges) / rate
    fixations = spans[spans > 0.06]
    assert 0.5 <= fixations.mean() <= 0.95
    assert (fixations < 2.01).all()


def test_eyes_converge_on_the_viewer_and_less_on_what_is_far() -> None:
    nearness = np.array([idle.look.nearness for idle in track(1)])
    assert nearness.max() == 1 / life()["gaze"]["viewer"]["distance_m"]
    assert nearness.min() == pytest.approx(1 / life()["gaze"]["far_m"])
    assert np.abs(np.diff(nearness)).max() < 0.05, "vergence is slow"


def test_the_head_starts_in_front_and_never_jerks() -> None:
    heads = np.degrees([idle.head for idle in track(1)])
    assert (heads[0] == 0).all()
    assert (np.abs(heads).max(axis=0) < [5, 7, 2]).all()
    assert (np.abs(np.diff(heads, axis=0)).max(axis=0) * FINE < 25).all(), "degrees a second"
    assert (heads.std(axis=0) > 0.25).all()


def _power(x: NDArray[np.float64], length: int) -> NDArray[np.float64]:
    """Power by frequency, the mean over pieces of that length."""
    pieces = x.reshape(-1, length)
    return (np.abs(np.fft.rfft(pieces - pieces.mean(axis=1, keepdims=True))) ** 2).mean(axis=0)


def test_the_head_drifts_like_one_over_f_and_breathes() -> None:
    """Slope of the spectrum between posture's slow drift and tremor; a bump where people breathe."""
    rate, seconds = 10, 1800
    pitch, yaw, _ = sway(4, 2 + np.arange(rate * seconds) / rate)
    hz = np.fft.rfftfreq(rate * 100, 1 / rate)
    power = [
        np.mean([abs(np.fft.rfft(part - part.mean())) ** 2 for part in np.split(x, 18)], axis=0)
        for x in (pitch, yaw)
    ]
    band = (hz > 0.07) & (hz < 1.5)
    slope = np.polyfit(np.log(hz[band]), np.log(power[1][band]), 1)[0]
    assert -3.5 < slope < -0.8
    share = [p[(hz > 0.2) & (hz < 0.3)].sum() / p[(hz > 0.35) & (hz < 0.6)].sum() for p in power]
    assert share[0] > 1.3 * share[1]
