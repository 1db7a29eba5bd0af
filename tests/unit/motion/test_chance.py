"""Chance that can be asked again: flat, bell-shaped, smooth, and the same numbers every time."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from fapstream.motion.chance import Events, bits, log_normal, minimum_jerk, noise, normal, uniform

N = 20_000


def test_numbers_are_flat_and_bell_shaped() -> None:
    assert stats.kstest([uniform(3, 1, k) for k in range(N)], "uniform").pvalue > 0.01
    assert stats.kstest([normal(3, 1, k) for k in range(N)], "norm").pvalue > 0.01


def test_seeds_channels_and_neighbours_have_nothing_to_do_with_each_other() -> None:
    base = np.array([uniform(3, 1, k) for k in range(N)])
    others = ([uniform(4, 1, k) for k in range(N)], [uniform(3, 2, k) for k in range(N)], np.roll(base, 1))
    for other in others:
        assert abs(np.corrcoef(base, other)[0, 1]) < 0.03


@given(st.integers(0, 2**63), st.integers(0, 1000), st.integers(-(2**31), 2**40))
def test_any_key_gives_32_bits(seed: int, channel: int, index: int) -> None:
    assert 0 <= bits(seed, channel, index) < 2**32
    assert bits(seed, channel, index) == bits(seed % 2**32, channel, index % 2**32)


def test_log_normal_has_its_median_and_its_ends() -> None:
    law = {"median": 2.0, "sigma": 0.5, "least": 1.0, "most": 6.0}
    found = np.array([log_normal(1, 1, k, law) for k in range(N)])
    assert np.median(found) == pytest.approx(2.0, rel=0.02)
    assert (found.min(), found.max()) == (1.0, 6.0)
    inside = found[(found > 1) & (found < 6)]
    assert stats.skew(inside) > 0.5


def test_noise_is_smooth_and_passes_through_its_nodes() -> None:
    at = np.arange(0, 200, 0.01)
    track = np.array([noise(1, 1, x) for x in at])
    assert np.abs(track).max() <= 1
    assert np.abs(np.diff(track)).max() <= 2 * 1.875 * 0.01, "steepest: twice the size of a minimum jerk"
    assert track[::100] == pytest.approx([2 * uniform(1, 1, k) - 1 for k in range(200)])
    assert track.std() == pytest.approx(0.5, abs=0.06)


def test_minimum_jerk_starts_and_ends_without_speed_or_acceleration() -> None:
    x = np.linspace(0, 1, 1001)
    y = np.array([minimum_jerk(v) for v in x])
    assert (y[0], y[-1], minimum_jerk(-3), minimum_jerk(3)) == (0, 1, 0, 1)
    speed = np.gradient(y, x)
    assert speed.max() == pytest.approx(1.875, abs=1e-3)
    for end in (0, -1):
        assert abs(speed[end]) < 1e-4


@given(st.lists(st.floats(-1, 40), min_size=1, max_size=12))
def test_events_do_not_depend_on_the_order_of_questions(times: list[float]) -> None:
    events = Events(lambda k: 0.5 + k % 3)
    starts = -1 + np.cumsum([0.0, *(0.5 + k % 3 for k in range(60))])
    for t in times:
        k, since = events.at(t)
        assert starts[k] <= t < starts[k + 1]
        assert since == pytest.approx(t - starts[k])
