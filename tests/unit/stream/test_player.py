"""What the card is given: every sample once, in order, softly begun and ended."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from fapstream.records import Pcm
from fapstream.stream.heard import Report
from fapstream.stream.player import FADE_IN_S, FADE_OUT_S, PREBUFFER_S, Player

RATE = 16_000
PACKET = RATE // 25
BLOCK = 160
FADE = round(FADE_IN_S * RATE)


class Rig:
    """A player whose time passes by `run`; a packet is 40 ms of a tone."""

    def __init__(self) -> None:
        self.reports: list[Report] = []
        self.player = Player(RATE, self.reports.append)
        self.out = np.zeros(0, np.int16)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds * RATE / BLOCK)):
            self.out = np.concatenate([self.out, self.player.render(BLOCK, len(self.out))])

    def feed(self, turn: int, packets: int, start: int = 0, hold: bool = False) -> int:
        for k in range(packets):
            at = start + k * PACKET
            self.player.push(turn, tone(at, at + PACKET), hold and k == packets - 1)
        return start + packets * PACKET

    def states(self) -> list[tuple[str, int, int]]:
        return [(r.state, r.turn, r.sample) for r in self.reports]


def tone(start: int, end: int) -> Pcm:
    return np.rint(12_000 * np.sin(2 * np.pi * 440 * np.arange(start, end) / RATE)).astype(np.int16)


@pytest.fixture
def rig() -> Rig:
    return Rig()


def test_a_whole_turn_comes_out_as_it_is(rig: Rig) -> None:
    rig.player.begin(1)
    total = rig.feed(1, 50)
    rig.player.end(1)
    rig.run(2.2)
    assert rig.states() == [("playing", 1, 0), ("over", 1, total)]
    start, end = rig.reports[0].frame, rig.reports[1].frame
    assert end - start == total
    assert np.array_equal(rig.out[start + FADE : end], tone(FADE, total))
    assert not rig.out[end + 500 :].any()


def test_it_waits_for_some_sound_in_store(rig: Rig) -> None:
    rig.player.begin(1)
    rig.feed(1, 1)
    rig.run(0.2)
    assert not rig.reports
    rig.feed(1, 1, PACKET)
    rig.run(0.01)
    assert rig.states() == [("playing", 1, 0)]
    assert PREBUFFER_S * RATE <= 2 * PACKET


@pytest.mark.parametrize("why", ["end", "hold"])
def test_less_is_enough_where_no_more_is_to_be_expected(rig: Rig, why: str) -> None:
    rig.player.begin(1)
    rig.feed(1, 1, hold=why == "hold")
    if why == "end":
        rig.player.end(1)
    rig.run(0.1)
    assert rig.states() == [("playing", 1, 0), ("over" if why == "end" else "waiting", 1, PACKET)]


def test_turns_follow_without_a_gap(rig: Rig) -> None:
    for turn in (1, 2):
        rig.player.begin(turn)
        rig.feed(turn, 5)
        rig.player.end(turn)
    rig.run(0.5)
    assert rig.states() == [("playing", 1, 0), ("over", 1, 3200), ("playing", 2, 0), ("over", 2, 3200)]
    assert rig.reports[1].frame == rig.reports[2].frame


def test_a_turn_without_sound_is_over_at_once(rig: Rig) -> None:
    rig.player.begin(1)
    rig.player.end(1)
    rig.run(0.01)
    assert rig.states() == [("playing", 1, 0), ("over", 1, 0)]


def test_after_a_late_packet_it_goes_on_with_the_very_next_sample_and_does_not_click(rig: Rig) -> None:
    rig.player.begin(1)
    after = rig.feed(1, 10)
    rig.run(0.8)
    rig.feed(1, 10, after)
    rig.run(0.2)
    assert rig.states() == [("playing", 1, 0), ("starved", 1, after), ("playing", 1, after)]
    pause, again = rig.reports[1].frame, rig.reports[2].frame
    assert not rig.out[pause + 500 : again].any()
    assert np.array_equal(rig.out[again + FADE : again + 1000], tone(after + FADE, after + 1000))
    steps = np.abs(np.diff(rig.out.astype(int)))
    assert steps.max() < 1.1 * 12_000 * 2 * np.pi * 440 / RATE


def test_running_dry_after_a_hold_is_no_fault(rig: Rig) -> None:
    rig.player.begin(1)
    after = rig.feed(1, 3, hold=True)
    rig.run(0.5)
    rig.feed(1, 3, after)
    rig.run(0.1)
    assert rig.states()[1:] == [("waiting", 1, after), ("playing", 1, after)]


def test_stop_fades_out_and_lets_the_next_turn_begin(rig: Rig) -> None:
    for turn in (1, 2):
        rig.player.begin(turn)
        rig.feed(turn, 50)
    rig.run(0.5)
    at = len(rig.out)
    rig.player.stop(1)
    rig.run(0.1)
    over = rig.reports[1]
    assert (over.state, over.turn) == ("over", 1)
    assert 0.9 * FADE_OUT_S * RATE <= over.frame - at <= FADE_OUT_S * RATE + 1
    peaks = [np.abs(rig.out[k : k + 64]).max() for k in range(at, over.frame - 64, 64)]
    assert all(a >= b for a, b in pairwise(peaks))
    assert rig.states()[2] == ("playing", 2, 0)


def test_stop_drops_a_turn_that_waits_at_once(rig: Rig) -> None:
    rig.player.begin(1)
    rig.feed(1, 1)
    rig.player.stop(1)
    rig.run(0.01)
    assert rig.states() == [("over", 1, 0)]
    assert not rig.out.any()


def test_what_is_said_to_unknown_turns_is_no_matter(rig: Rig) -> None:
    rig.player.push(7, tone(0, 10))
    rig.player.end(7)
    rig.player.stop(7)
    assert not rig.player.render(BLOCK, 0).any()
    assert rig.player.render(0, BLOCK).shape == (0,)
