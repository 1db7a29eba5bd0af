"""How much has to be in store, from when packets arrive. Both languages run protocol/vectors/jitter.json."""

from __future__ import annotations

import random
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.stream.jitter import DECAY_S, FLOOR_S, GROW_S, MARGIN_S, MOST_S, Jitter, steer

PACKET_S = 0.04


def run(jitter: Jitter, delays: list[float], start: int = 0) -> list[float]:
    """Packets sent every 40 ms, in order, each held up for so long; the target after each."""
    targets, before = [], 0.0
    for k, delay in enumerate(delays, start):
        end = (k + 1) * PACKET_S
        before = max(before, end + delay)
        jitter.observe(end, before)
        targets.append(jitter.target_s)
    return targets


def test_a_steady_network_needs_a_packet_and_a_little() -> None:
    assert run(Jitter(), [0.3] * 1000) == pytest.approx([FLOOR_S] * 1000)


def test_it_is_as_late_as_the_jitter_and_no_more() -> None:
    chance = random.Random(1)
    targets = run(Jitter(), [chance.uniform(0, 0.08) for _ in range(2000)])
    assert FLOOR_S + 0.07 < targets[-1] < FLOOR_S + 0.08


def test_bursts_count_by_their_first_packet() -> None:
    """One second's packets at once, second for second: as much has to be in store."""
    delays = [0.96 - PACKET_S * (k % 25) for k in range(25 * 20)]
    assert run(Jitter(), delays)[-1] == pytest.approx(FLOOR_S + 0.96, abs=0.01)


def test_one_stall_is_no_habit() -> None:
    delays = [0.0] * 250 + [2.0] + [0.0] * 500
    assert max(run(Jitter(), delays)) == pytest.approx(FLOOR_S)


def test_an_underrun_counts_at_once_within_bounds_and_is_slowly_forgotten() -> None:
    jitter = Jitter()
    run(jitter, [0.0] * 10)
    jitter.underrun(0.07)
    assert jitter.target_s == pytest.approx(FLOOR_S + 0.07 + MARGIN_S)
    jitter.underrun(9.0)
    assert jitter.target_s == pytest.approx(FLOOR_S + 0.07 + MARGIN_S + GROW_S)
    top = jitter.target_s
    targets = run(jitter, [0.0] * 1600, 10)
    assert targets[round(DECAY_S / PACKET_S)] == pytest.approx(FLOOR_S + (top - FLOOR_S) / 2.72, rel=0.05)
    assert all(b <= a for a, b in pairwise(targets))
    for _ in range(20):
        jitter.underrun(9.0)
    assert jitter.target_s == MOST_S


def test_a_clock_that_was_stopped_or_turned_makes_nobody_late() -> None:
    jitter = Jitter()
    run(jitter, [0.0] * 100)
    jitter.restart()
    assert jitter.observe(0.04, 60.0) == 0.0
    assert jitter.observe(0.08, 60.05) == pytest.approx(0.01)
    assert jitter.target_s == pytest.approx(FLOOR_S)


def test_a_longer_way_is_no_jitter_for_long() -> None:
    assert run(Jitter(), [0.0] * 500 + [0.1] * 6000)[-1] < FLOOR_S + 0.02


def test_the_store_is_steered_within_a_band() -> None:
    assert [steer(level, 0.1) for level in (0.05, 0.094, 0.096, 0.119, 0.121, 2.0)] == [1, 1, 0, 0, -1, -1]


@given(st.lists(st.tuples(st.floats(0, 3), st.floats(0, 1)), max_size=200))
def test_whatever_comes_the_target_has_bounds(steps: list[tuple[float, float]]) -> None:
    jitter, end, now = Jitter(), 0.0, 0.0
    for on, later in steps:
        end, now = end + on, now + later
        assert jitter.observe(end, now) >= 0
        assert FLOOR_S - 1e-9 <= jitter.target_s <= MOST_S


@pytest.mark.parametrize("ppm", [-200.0, 200.0])
def test_over_four_hours_the_store_stays_though_clocks_drift(ppm: float) -> None:
    """On numbers: the store changes by 10 ms a change, at most every 0.2 s, as speech allows."""
    chance, jitter = random.Random(2), Jitter()
    shift, free, stores = 0.08, 0.0, []
    for k in range(4 * 3600 * 25):
        end = (k + 1) * PACKET_S
        now = end * (1 + 1e-6 * ppm) + chance.uniform(0.0, 0.01)
        late = jitter.observe(end, now)
        store = shift + end - now
        stores.append(store - PACKET_S)
        way = steer(store + late, jitter.target_s) if now > free else 0
        if way:
            shift, free = shift + 0.01 * way, now + 0.2
    assert min(stores) > 0, "not even right before a packet came"
    assert max(stores) < 0.08
