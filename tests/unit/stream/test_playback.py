"""Player, reports and clock together: the sample heard at a time."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.stream.playback import Playback

RATE = 16_000
LATENCY_S = 0.2


def test_what_is_heard_lags_behind_what_was_fetched_by_the_cards_latency() -> None:
    playback = Playback(RATE)
    assert playback.heard(0.0) is None
    playback.player.begin(1)
    playback.player.push(1, 0, np.full(RATE, 900, np.int16))
    playback.player.end(1)
    for k in range(60):
        playback.render(160, k * 0.01 + LATENCY_S)
    assert playback.heard(0.1) == playback.heard(0.0), "nothing has arrived yet"
    heard = playback.heard(0.5)
    assert heard is not None
    assert heard.sample == pytest.approx((0.5 - LATENCY_S) * RATE)
    late = playback.heard(99.0)
    assert late is not None
    assert late.sample == 9600, "never beyond what was fetched"
    for k in range(60, 120):
        playback.render(160, k * 0.01 + LATENCY_S)
    end = playback.heard(99.0)
    assert end is not None
    assert (end.sample, end.state) == (RATE, "over")
    assert playback.player.stats.underruns == 0


def test_running_dry_is_counted() -> None:
    playback = Playback(RATE)
    playback.player.begin(1)
    playback.player.push(1, 0, np.ones(2000, np.int16))
    for k in range(40):
        playback.render(160, k * 0.01)
    assert playback.player.stats.underruns == 1
