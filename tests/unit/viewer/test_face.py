"""The turn's face and idle life, and what lies between."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.records import FapFrame, Packet
from fapstream.stream import Heard, TurnBuffer
from fapstream.stream.heard import State
from fapstream.viewer.face import FaceMixer

JAW, PITCH = 2, 47


def at(sample: float, state: State = "playing") -> Heard:
    return Heard(1, sample, state)


@pytest.fixture
def buffer() -> TurnBuffer:
    found = TurnBuffer(16_000)
    for k in range(10):
        values = np.zeros(68, np.int32)
        values[JAW], values[PITCH] = 100 * k, 5000
        found.push(Packet(1, 640 * k, np.zeros(640, np.int16), (FapFrame(640 * k, values),)))
    return found


def test_lips_are_those_of_the_heard_sample_from_the_first_on(buffer: TurnBuffer) -> None:
    mixer = FaceMixer(1)
    mixer.show(None, None, 0)
    for k in range(10):
        assert mixer.show(buffer, at(640 * k), 0.04 * (k + 1))[JAW] == pytest.approx(100 * k)


def test_a_turn_met_in_its_middle_is_caught_up_with(buffer: TurnBuffer) -> None:
    mixer = FaceMixer(1)
    mixer.show(None, None, 0)
    assert mixer.show(buffer, at(640 * 5), 0.01)[JAW] < 100
    assert mixer.show(buffer, at(640 * 5), 0.17)[JAW] == 500


def test_the_head_is_taken_over_softly_wholly_after_its_time(buffer: TurnBuffer) -> None:
    mixer = FaceMixer(1)
    idle = [mixer.show(None, None, t)[PITCH] for t in np.arange(0, 10, 0.02)][-1]
    assert abs(mixer.show(buffer, at(100), 10.02)[PITCH] - idle) < 0.1 * 5000
    assert mixer.show(buffer, at(3200), 10.8)[PITCH] == 5000


def test_it_never_jumps_where_a_turn_begins_waits_goes_on_and_ends(buffer: TurnBuffer) -> None:
    """100 pictures a second; FAP 19 may step as far as in a blink."""

    def heard(t: float) -> Heard | None:
        return None if t < 3 or t > 6 else at(3200, "waiting" if 4 < t < 5 else "playing")

    mixer = FaceMixer(1)
    shown = np.array([mixer.show(buffer if heard(t) else None, heard(t), t) for t in np.arange(0, 9, 0.01)])
    most = np.abs(np.diff(shown, axis=0)).max(axis=0)
    assert most[JAW] < 70
    assert most[PITCH] < 250
    assert most[18] < 350
    assert (most[mixer._alive] > 0).all()


@pytest.mark.parametrize("state", ["starved", "paused"])
def test_the_mouth_comes_to_rest_where_the_sound_stops_and_softly_back(
    buffer: TurnBuffer, state: State
) -> None:
    mixer = FaceMixer(1)
    mixer.show(buffer, at(5000), 0)
    silent = [mixer.show(buffer, at(5120, state), t)[JAW] for t in np.arange(0.01, 1, 0.01)]
    assert max(-np.diff([800, *silent])) < 50
    assert silent[2] > 700, "not at once"
    assert silent[-1] == 0
    heads = [mixer.show(buffer, at(5120, state), t)[PITCH] for t in (2, 3)]
    assert heads[0] != heads[1], "it lives"
    back = [mixer.show(buffer, at(5120 + 160 * k), 3 + k / 100)[JAW] for k in range(17)]
    assert max(np.abs(np.diff([0, *back]))) < 320
    assert back[7] == buffer.face(5120 + 160 * 7)[JAW], "soon"
    assert back[-1] == 900


def test_lips_that_stood_where_they_rest_are_on_time_when_the_sound_comes_back(buffer: TurnBuffer) -> None:
    mixer = FaceMixer(1)
    mixer.show(buffer, at(0), 0)
    for t in np.arange(0.01, 1, 0.03):
        mixer.show(buffer, at(0, "starved"), t)
    for k in range(1, 10):
        assert mixer.show(buffer, at(320 * k), 1 + k / 50)[JAW] == 50 * k


def test_a_frame_is_held_for_a_moment_where_others_are_missing_then_the_mouth_rests(
    buffer: TurnBuffer,
) -> None:
    mixer = FaceMixer(1)
    shown = [mixer.show(buffer, at(5760 + 16_000 * t), t)[JAW] for t in np.arange(0, 1, 0.01)]
    assert shown[11] == 900
    assert shown[60] == 0
    assert max(np.abs(np.diff(shown))) < 60


def test_a_leap_of_what_is_heard_is_no_leap_of_the_lips(buffer: TurnBuffer) -> None:
    for k in range(50, 60):
        values = np.zeros(68, np.int32)
        values[JAW] = 800
        buffer.push(Packet(1, 640 * k, np.zeros(640, np.int16), (FapFrame(640 * k, values),)))
    mixer = FaceMixer(1)
    mixer.show(buffer, at(0), 0)
    shown = [mixer.show(buffer, at(640 * 50 + 160 * k), 0.01 * (k + 1))[JAW] for k in range(20)]
    assert shown[0] < 50
    assert max(np.diff(shown)) < 280
    assert shown[-1] == 800


def test_it_lives_while_the_text_has_run_dry(buffer: TurnBuffer) -> None:
    mixer = FaceMixer(1)
    mixer.show(buffer, at(640), 0)
    mixer.show(buffer, at(640), 1)
    mixer.show(buffer, at(640, "waiting"), 10)
    dry = mixer.show(buffer, at(640, "waiting"), 11)
    assert dry[PITCH] != 5000
    assert dry[JAW] == 100


def test_lips_ease_to_neutral_when_the_turn_lets_go(buffer: TurnBuffer) -> None:
    mixer = FaceMixer(1)
    last = mixer.show(buffer, at(640 * 8), 0)[JAW]
    for k in range(1, 37):
        now = mixer.show(buffer, at(640 * 8, "over"), k / 100)[JAW]
        assert -1e-6 <= last - now < 110
        last = now
    assert last == pytest.approx(0, abs=1e-6)


def test_between_turns_it_lives_and_the_same_seed_lives_the_same(buffer: TurnBuffer) -> None:
    one, two, other = FaceMixer(1), FaceMixer(1), FaceMixer(2)
    times = np.arange(0, 20, 0.05)
    lives = [np.array([mixer.show(None, None, t) for t in times]) for mixer in (one, two, other)]
    assert np.array_equal(lives[0], lives[1])
    assert not np.array_equal(lives[0], lives[2])
    assert lives[0][:, 18].max() > 500, "no blink in 20 s"
    assert not np.delete(lives[0], one._alive, axis=1).any()


def test_without_idle_life_the_frames_are_shown_as_they_are(buffer: TurnBuffer) -> None:
    mixer = FaceMixer(None)
    for k in range(10):
        assert np.array_equal(mixer.show(buffer, at(640 * k), k / 25), buffer.face(640 * k))
    mixer.show(None, None, 9)
    assert not mixer.show(None, None, 10).any()


def test_lids_never_go_through_each_other(buffer: TurnBuffer) -> None:
    """A blink of the turn that ends in one of idle life."""
    mixer, shut = FaceMixer(1), np.zeros(68, np.int32)
    shut[18] = 2000
    turn = TurnBuffer(16_000)
    turn.push(Packet(1, 0, np.zeros(640, np.int16), (FapFrame(0, shut),)))
    assert mixer.show(turn, at(0), 0)[18] == mixer._shut[0]


def test_after_a_halt_it_does_not_catch_up_on_its_life() -> None:
    halted, other = FaceMixer(1), FaceMixer(1)
    halted.show(None, None, 0)
    other.show(None, None, 0)
    late = halted.show(None, None, 1000)
    assert np.array_equal(late, other.show(None, None, 0.25))
