"""What the card is given: every sample once, in order, softly begun and ended, and told of to the sample."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fapstream.records import Pcm
from fapstream.stream.heard import HeardMap, Report
from fapstream.stream.jitter import FLOOR_S, SLACK_S
from fapstream.stream.player import BEHIND_S, STARVED_FALL_S, Player
from fapstream.stream.stretch import LONGEST_S
from fapstream.stream.voice import FADE_BACK_S, FADE_IN_S, FADE_OUT_S

RATE = 16_000
PACKET = RATE // 25
BLOCK = 160
FADE = round(FADE_IN_S * RATE)
BACK = round(FADE_BACK_S * RATE)
FALL = round(STARVED_FALL_S * RATE)
STEEPEST = 12_000 * 2 * np.pi * 440 / RATE
"""The largest step from one sample of the tone to the next."""


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
            self.player.push(turn, at, tone(at, at + PACKET), hold and k == packets - 1)
        return start + packets * PACKET

    def states(self) -> list[tuple[str, int, int]]:
        return [(r.state, r.turn, r.sample) for r in self.reports]

    def heard(self) -> list[float]:
        """The sample heard at every frame, -1 where none is."""
        heard = HeardMap()
        for report in self.reports:
            heard.apply(report)
        found = [heard.at(frame) for frame in range(len(self.out))]
        return [-1.0 if h is None else h.sample for h in found]

    def steepest(self) -> int:
        return int(np.abs(np.diff(self.out.astype(int))).max())


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
    assert PACKET < FLOOR_S * RATE <= 2 * PACKET


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


def test_where_a_packet_is_missing_it_dies_away_and_goes_on_with_the_next_sample(
    rig: Rig,
) -> None:
    rig.player.begin(1)
    after = rig.feed(1, 10)
    rig.run(0.8)
    rig.feed(1, 10, after)
    rig.run(0.2)
    states = rig.states()
    assert (states[0], states[-2], states[-1]) == (
        ("playing", 1, 0),
        ("starved", 1, after),
        ("playing", 1, after),
    )
    dry, again = rig.reports[-2].frame, rig.reports[-1].frame
    levels = [np.abs(rig.out[k : k + 40]).max() for k in range(dry, dry + FALL, 40)]
    assert levels[0] > 10_000
    assert all(a >= b for a, b in pairwise(levels))
    assert not rig.out[dry + FALL : again].any()
    assert np.array_equal(rig.out[again + BACK : again + 1000], tone(after + BACK, after + 1000))
    assert rig.steepest() < 1.1 * STEEPEST
    assert rig.player.stats.underruns == 1


def test_a_late_packet_is_counted_and_more_is_kept_in_store_from_then_on(rig: Rig) -> None:
    rig.player.begin(1)
    after = rig.feed(1, 3)
    rig.run(0.3)
    before = rig.player.stats.target_ms
    after = rig.feed(1, 1, after)
    assert rig.player.stats.late == 1
    assert rig.player.stats.target_ms > before + 100
    rig.run(0.1)
    assert rig.reports[-1].state == "starved"
    rig.feed(1, 12, after)
    rig.run(0.01)
    assert rig.reports[-1].state == "playing"


def test_running_dry_after_a_hold_is_no_fault(rig: Rig) -> None:
    rig.player.begin(1)
    after = rig.feed(1, 3, hold=True)
    rig.run(0.5)
    rig.feed(1, 3, after)
    rig.run(0.05)
    assert rig.states()[1:] == [("waiting", 1, after), ("playing", 1, after)]
    assert rig.player.stats.underruns == rig.player.stats.late == rig.player.stats.stretched_ms == 0


@pytest.mark.parametrize("turns", [1, 3])
@pytest.mark.parametrize("playing", [False, True])
def test_a_card_that_stood_still_goes_on_with_what_is_said_now(rig: Rig, turns: int, playing: bool) -> None:
    """A live talk is never more than some seconds late, and costs no more memory than that."""
    rig.player.begin(1, live=True)
    at = rig.feed(1, 10 if playing else 0)
    rig.run(0.1)
    for turn in range(1, turns + 1):
        if turn > 1:
            rig.player.end(turn - 1)
            rig.player.begin(turn, live=True)
            at = 0
        at = rig.feed(turn, 400, at)
        assert rig.player.stats.store_ms <= 1000 * BEHIND_S
    rig.run(0.5)
    last = rig.reports[-1]
    assert (last.turn, last.state) == (turns, "playing")
    assert last.sample >= at - (BEHIND_S + 0.5) * RATE
    assert rig.steepest() < 1.1 * STEEPEST


def test_a_talk_that_is_not_live_is_played_whole(rig: Rig) -> None:
    rig.player.begin(1)
    rig.feed(1, 400)
    rig.run(0.01)
    assert rig.player.stats.store_ms > 15_000


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


def test_a_pause_fades_and_goes_on_exactly_where_it_stopped(rig: Rig) -> None:
    rig.player.begin(1)
    total = rig.feed(1, 25)
    rig.player.end(1)
    rig.run(0.3)
    rig.player.pause(True)
    rig.run(0.5)
    paused = rig.reports[-1]
    assert (paused.state, paused.sample) == ("paused", 4800 + round(FADE_OUT_S * RATE))
    assert not rig.out[paused.frame : paused.frame + RATE // 4].any()
    rig.player.pause(False)
    rig.run(1.0)
    again, over = rig.reports[-2:]
    assert (again.state, again.sample) == ("playing", paused.sample)
    assert np.array_equal(rig.out[again.frame + BACK : over.frame], tone(again.sample + BACK, total)), (
        "no sample is lost or said twice"
    )
    assert rig.steepest() < 1.1 * STEEPEST


def test_a_pause_keeps_turns_from_beginning_and_may_be_taken_back_within_its_fade(rig: Rig) -> None:
    rig.player.begin(1)
    rig.feed(1, 10)
    rig.player.end(1)
    rig.player.pause(True)
    rig.run(0.1)
    assert not rig.reports
    rig.player.pause(False)
    rig.run(0.1)
    rig.player.pause(True)
    rig.run(0.01)
    rig.player.pause(False)
    rig.run(0.05)
    assert rig.states() == [("playing", 1, 0)]
    rig.player.pause(True)
    rig.run(0.1)
    rig.player.stop(1)
    rig.run(0.01)
    assert [state for state, *_ in rig.states()] == ["playing", "paused", "over"]


def test_what_is_paused_while_it_waits_waits_afterwards(rig: Rig) -> None:
    rig.player.begin(1)
    after = rig.feed(1, 3, hold=True)
    rig.run(0.3)
    rig.player.pause(True)
    rig.run(0.3)
    rig.player.pause(False)
    rig.feed(1, 5, after)
    rig.run(0.05)
    assert [state for state, *_ in rig.states()] == ["playing", "waiting", "paused", "waiting", "playing"]


def test_what_the_server_revises_is_cut_softly_and_goes_on_there(rig: Rig) -> None:
    rig.player.begin(1)
    rig.feed(1, 25)
    rig.run(0.2)
    rig.player.discard(1, 8000)
    other = np.full(PACKET, 3000, np.int16)
    rig.player.push(1, 8000, other)
    rig.player.end(1)
    rig.run(1.0)
    start, end = rig.reports[0].frame, rig.reports[-1].frame
    assert end - start == 8000 + PACKET
    assert np.array_equal(rig.out[start + FADE : start + 8000], tone(FADE, 8000))
    assert (rig.out[start + 8080 : end] == 3000).all()
    assert rig.steepest() < 1.2 * STEEPEST
    assert rig.reports[-1].sample == 8000 + PACKET


def test_what_is_revised_too_late_is_heard_as_it_was_and_no_sample_twice(rig: Rig) -> None:
    rig.player.begin(1)
    rig.feed(1, 25)
    rig.run(0.5)
    rig.player.discard(1, 1000)
    rig.run(0.1)
    assert rig.reports[-1].state == "starved"
    assert rig.reports[-1].sample == 8000
    rig.player.push(1, 1000, np.full(9000, 3000, np.int16))
    rig.player.end(1)
    rig.run(0.5)
    again, over = rig.reports[-2:]
    assert (again.sample, over.sample, over.frame - again.frame) == (8000, 10_000, 2000)
    assert (rig.out[again.frame + BACK : over.frame] == 3000).all()


def test_where_some_was_skipped_the_heard_sample_leaps_and_nothing_clicks(rig: Rig) -> None:
    rig.player.begin(1, live=True)
    rig.feed(1, 5, 32_000)
    rig.feed(1, 5, 64_000)
    rig.player.end(1)
    rig.run(0.6)
    assert rig.states() == [("playing", 1, 32_000), ("playing", 1, 64_000), ("over", 1, 67_200)]
    assert rig.reports[1].frame - rig.reports[0].frame == 3200
    assert rig.steepest() < 1.1 * STEEPEST


def test_what_comes_twice_is_heard_once(rig: Rig) -> None:
    rig.player.begin(1)
    rig.feed(1, 10)
    rig.feed(1, 15)
    rig.player.end(1)
    rig.run(0.8)
    assert rig.states() == [("playing", 1, 0), ("over", 1, 15 * PACKET)]
    start = rig.reports[0].frame
    assert np.array_equal(rig.out[start + FADE : start + 15 * PACKET], tone(FADE, 15 * PACKET))


def run_live(rig: Rig, seconds: float, ahead: int, ppm: float = 0.0) -> list[float]:
    """A live talk whose sender has `ahead` packets ready and a clock of its own: the store (ms) over time."""
    rig.player.begin(1, live=True)
    sent = rig.feed(1, ahead)
    stores = []
    for k in range(round(100 * seconds)):
        while sent <= ahead * PACKET + k * BLOCK * (1 + 1e-6 * ppm):
            sent = rig.feed(1, 1, sent)
        rig.run(0.01)
        stores.append(rig.player.stats.store_ms)
    return stores


def test_a_live_talk_gets_rid_of_a_store_that_is_too_large(rig: Rig) -> None:
    stores = run_live(rig, 16.0, 10)
    assert max(stores[:100]) > 350
    assert max(stores[-100:]) <= 1000 * (FLOOR_S + SLACK_S + LONGEST_S)
    assert min(stores[-100:]) > 0
    stats = rig.player.stats
    assert stats.underruns == 0
    assert 200 < stats.stretched_ms < 0.06 * 16_000, "at most 5 % in sound"
    heard = np.array(rig.heard())
    assert (np.diff(heard[heard >= 0]) >= 0).all()
    lead = heard[-1] - heard[RATE]
    assert lead == pytest.approx(15 * RATE - 1 + 16 * stats.stretched_ms, abs=0.06 * RATE)
    assert rig.steepest() < 1.3 * STEEPEST


def test_an_own_turn_keeps_its_store(rig: Rig) -> None:
    rig.player.begin(1)
    sent = rig.feed(1, 35)
    for _ in range(50):
        sent = rig.feed(1, 1, sent)
        rig.run(0.04)
    assert rig.player.stats.stretched_ms == 0
    assert rig.states() == [("playing", 1, 0)]


def test_a_turn_whose_packets_do_not_come_gains_time_before_it_runs_dry(rig: Rig) -> None:
    rig.player.begin(1)
    total = rig.feed(1, 20)
    rig.run(1.0)
    starved = rig.reports[-1]
    assert (starved.state, starved.sample) == ("starved", total)
    gained = starved.frame - rig.reports[0].frame - total
    assert gained == round(rig.player.stats.stretched_ms * RATE / 1000) > 0
    heard = rig.heard()
    assert all(b >= a for a, b in pairwise(heard[: starved.frame]))
    assert rig.steepest() < 1.2 * STEEPEST


@pytest.mark.parametrize("ppm", [-200.0, 200.0])
def test_the_store_of_a_live_talk_stays_though_clocks_drift(ppm: float) -> None:
    rig = Rig()
    rig.player.begin(1, live=True)
    sent, stores = rig.feed(1, 2), []
    for k in range(50 * 300):
        while sent <= 2 * PACKET + 320 * k * (1 + 1e-6 * ppm):
            rig.player.push(1, sent, tone(sent, sent + PACKET))
            sent += PACKET
        rig.player.render(320, 320 * k)
        stores.append(rig.player.stats.store_ms)
    assert rig.player.stats.underruns == 0
    assert min(stores[100:]) > 0
    assert max(stores) <= 1000 * (FLOOR_S + 2 * SLACK_S + LONGEST_S)
    assert 40 < rig.player.stats.stretched_ms < 180, "60 ms are needed, and as much as the target moves"


def test_what_is_said_to_unknown_turns_is_no_matter(rig: Rig) -> None:
    rig.player.push(7, 0, tone(0, 10))
    rig.player.discard(7, 0)
    rig.player.end(7)
    rig.player.stop(7)
    rig.player.pause(False)
    assert not rig.player.render(BLOCK, 0).any()
    assert rig.player.render(0, BLOCK).shape == (0,)


STEPS = st.one_of(
    st.tuples(st.just("push"), st.integers(1, 700), st.sampled_from([0, 0, 0, 0, -300, 5000])),
    st.tuples(st.just("run"), st.integers(1, 900), st.just(0)),
    st.tuples(st.just("discard"), st.integers(0, 3000), st.just(0)),
    st.tuples(st.just("pause"), st.booleans(), st.just(0)),
)


@settings(max_examples=60, deadline=None)
@example([("push", 1, 0), ("push", 1, 0), ("push", 1, 0), ("push", 401, 0), ("push", 1, 5000)], False)
@given(st.lists(STEPS, min_size=5, max_size=60), st.booleans())
def test_whatever_happens_nothing_clicks_and_what_is_heard_never_goes_back(
    steps: list[tuple[str, int, int]], live: bool
) -> None:
    """Pushes with gaps and overlaps, blocks of any size, revisions and pauses, of an endless tone."""
    rig = Rig()
    rig.player.begin(1, live=live)
    end = 0
    for what, n, leap in steps:
        if what == "push":
            start = max(0, end + leap)
            rig.player.push(1, start, tone(start, start + n))
            end = max(end, start + n)
        elif what == "run":
            block = rig.player.render(n, len(rig.out))
            assert block.shape == (n,)
            rig.out = np.concatenate([rig.out, block])
        elif what == "discard":
            rig.player.discard(1, end - n)
            end = max(0, end - n)
        else:
            rig.player.pause(bool(n))
    rig.player.pause(False)
    rig.player.end(1)
    rig.out = np.concatenate([rig.out, rig.player.render(60_000, len(rig.out))])
    assert rig.reports[-1].state == "over"
    assert np.abs(rig.out.astype(int)).max() <= 32_767
    assert rig.steepest() < 2.5 * STEEPEST + 12_000 / min(BACK, 80)
    heard = [sample for sample in rig.heard() if sample >= 0]
    assert all(b >= a for a, b in pairwise(heard))
