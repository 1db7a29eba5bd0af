"""The clock that the picture follows: steady under jitter, quick after a stall."""

from __future__ import annotations

import math

import pytest

from fapstream.stream.clock import OutputClock


def test_it_knows_nothing_before_it_is_told() -> None:
    assert OutputClock().heard(1000.0, 5.0) == 0.0


def test_it_runs_on_between_timestamps_but_never_past_what_was_rendered() -> None:
    clock = OutputClock()
    clock.observe(2.0, 1.0)
    assert clock.heard(1.5, 10.0) == pytest.approx(2.5)
    assert clock.heard(1.5, 2.1) == 2.1
    assert clock.heard(-9.0, 10.0) == 0.0


def test_it_smooths_jitter_and_follows_a_stall_at_once() -> None:
    clock = OutputClock()
    errors = []
    for k in range(500):
        clock.observe(k / 60 + (0.004 if k % 2 else -0.004), k / 60)
        if k > 100:
            errors.append(abs(clock.heard(k / 60, math.inf) - k / 60))
    assert max(errors) < 0.001
    clock.observe(500 / 60 - 0.3, 500 / 60)
    assert clock.heard(500 / 60, math.inf) == pytest.approx(500 / 60 - 0.3, abs=1e-3)
