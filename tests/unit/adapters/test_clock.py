"""The machine's clock. The only sleeps here are shorter than its tick."""

from __future__ import annotations

from fapstream.adapters.clock import MonotonicClock


async def test_time_goes_forward_and_nobody_wakes_early() -> None:
    clock = MonotonicClock()
    start = clock.now()
    await clock.sleep_until(start + 0.002)
    assert clock.now() >= start + 0.002


async def test_the_past_is_not_waited_for() -> None:
    clock = MonotonicClock()
    before = clock.now()
    await clock.sleep_until(before - 1000)
    assert clock.now() - before < 0.5
