"""Frames of the card to samples of turns."""

from __future__ import annotations

from fapstream.stream.heard import Heard, HeardMap, Report


def started() -> HeardMap:
    heard = HeardMap()
    heard.apply(Report("playing", 1, 1000, 0))
    return heard


def test_nothing_is_heard_before_the_first_sound() -> None:
    assert HeardMap().at(0) is None
    assert started().at(999) is None


def test_samples_pass_with_the_frames_also_between_two() -> None:
    assert started().at(1000) == Heard(1, 0.0, "playing")
    assert started().at(1001.5) == Heard(1, 1.5, "playing")


def test_it_stands_still_while_the_sound_waits() -> None:
    heard = started()
    heard.apply(Report("starved", 1, 4000, 3000))
    assert heard.at(3999) == Heard(1, 2999.0, "playing")
    assert heard.at(9000) == Heard(1, 3000.0, "starved")
    heard.apply(Report("playing", 1, 10_000, 3000))
    assert heard.at(9999) == Heard(1, 3000.0, "starved")
    assert heard.at(10_001) == Heard(1, 3001.0, "playing")


def test_it_goes_over_to_the_next_turn_when_that_is_heard_not_when_it_is_reported() -> None:
    heard = started()
    heard.apply(Report("over", 1, 4000, 3000))
    heard.apply(Report("playing", 2, 4000, 0))
    assert heard.at(3999) == Heard(1, 2999.0, "playing")
    assert heard.at(4002) == Heard(2, 2.0, "playing")
    heard.apply(Report("over", 2, 5000, 1000))
    assert heard.at(60_000) == Heard(2, 1000.0, "over")


def test_where_a_period_is_left_out_or_said_twice_it_passes_twice_as_fast_or_stands() -> None:
    heard = started()
    for frame, sample, pace in ((2000, 1000, 2), (2100, 1200, 1), (3000, 2100, 0), (3100, 2100, 1)):
        heard.apply(Report("playing", 1, frame, sample, pace))
    found = [heard.at(frame) for frame in (1999, 2050, 2100, 2999, 3050, 3101)]
    assert [h.sample for h in found if h] == [999, 1100, 1200, 2099, 2100, 2101]


def test_a_pause_stands_where_it_stopped() -> None:
    heard = started()
    heard.apply(Report("paused", 1, 4000, 3000, 0))
    assert heard.at(9000) == Heard(1, 3000.0, "paused")
