"""Expressions come softly, last under the phrase that follows, and go at its end or for another."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from fapstream.fap import EXPRESSIONS, expressions
from fapstream.motion.feeling import COME_S, GO_S, LASTING, LONGEST_S, Feeling
from fapstream.records import SILENCE, ExpressionName, Phone, TimedPhone
from tests.unit.fakes import timed

RATE = 16000


def feeling(*phones: Phone) -> tuple[Feeling, list[TimedPhone]]:
    said = list(timed(list(phones), RATE))
    stream = Feeling(RATE)
    for phone in said:
        stream.add(phone)
    return stream, said


def level(stream: Feeling, name: str, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """How much of an expression is seen, 0 to 1."""
    whole = expressions()[name]
    return np.array([stream.at(t) @ whole / (whole @ whole) for t in times])


def smiley(name: ExpressionName, ms: float = 1000.0) -> Phone:
    return Phone(SILENCE, ms, expression=name)


SPEECH = [Phone("a", 150.0, stress=1), Phone("m", 80.0)] * 6


@pytest.mark.parametrize("name", EXPRESSIONS)
def test_it_comes_whole_and_lasts_under_the_phrase_and_goes_at_its_end(name: ExpressionName) -> None:
    stream, said = feeling(smiley(name), *SPEECH, Phone(SILENCE, 350.0), *SPEECH)
    end = said[len(SPEECH)].end / RATE
    assert level(stream, name, np.array([0.0, COME_S, 1.0, end])) == pytest.approx([0, 1, 1, LASTING])
    assert level(stream, name, np.array([end + GO_S, end + 3])) == pytest.approx([0, 0])


def test_it_never_jumps() -> None:
    stream, said = feeling(
        *SPEECH, Phone(SILENCE, 100.0), smiley("joy"), *SPEECH, Phone(SILENCE, 300.0), smiley("anger", 400.0),
        smiley("surprise", 300.0), *SPEECH, Phone(SILENCE, 300.0)
    )  # fmt: skip
    times = np.arange(0, said[-1].end / RATE, 0.01)
    track = np.array([stream.at(t) for t in times])
    scale = np.max([np.abs(v) for v in expressions().values()], axis=0) + 1e-9
    assert (np.abs(np.diff(track, axis=0)).max(axis=0) / scale).max() < 0.16


def test_speech_before_it_and_the_pause_between_do_not_end_it() -> None:
    stream, _ = feeling(*SPEECH, smiley("joy", 500.0), Phone(SILENCE, 200.0), *SPEECH)
    said = 6 * 0.23
    assert level(stream, "joy", np.array([said + 0.5, said + 1.6])) == pytest.approx([1, LASTING], abs=0.01)


def test_short_pauses_within_a_phrase_do_not_end_it() -> None:
    stream, said = feeling(smiley("joy"), *SPEECH, Phone(SILENCE, 60.0), *SPEECH)
    assert level(stream, "joy", np.array([said[-1].end / RATE]))[0] == pytest.approx(LASTING)


def test_it_goes_of_itself_under_speech_without_end() -> None:
    stream, _ = feeling(smiley("joy"), *SPEECH * 8)
    assert level(stream, "joy", np.array([1 + LONGEST_S + GO_S]))[0] == pytest.approx(0)


def test_another_takes_over() -> None:
    stream, _ = feeling(smiley("joy"), smiley("anger"), *SPEECH)
    assert stream.at(1 + GO_S + 0.1) == pytest.approx(expressions()["anger"])


def test_a_short_one_still_shows() -> None:
    stream, _ = feeling(smiley("surprise", 120.0), Phone(SILENCE, 100.0))
    assert level(stream, "surprise", np.array([0.12]))[0] == pytest.approx(1)


def test_what_comes_later_changes_nothing_before_it() -> None:
    """Frames up to a phone's start may have been shown when it comes."""
    phones = timed([smiley("joy"), *SPEECH, Phone(SILENCE, 350.0), smiley("fear"), *SPEECH], RATE)
    known, stream = Feeling(RATE), Feeling(RATE)
    for phone in phones:
        known.add(phone)
    for phone in phones:
        times = np.linspace(phone.start, phone.end, 5) / RATE
        stream.add(phone)
        assert np.array([stream.at(t) for t in times]) == pytest.approx(
            np.array([known.at(t) for t in times])
        )


def test_old_ones_are_forgotten() -> None:
    stream, said = feeling(*[smiley(EXPRESSIONS[k % 6], 500.0) for k in range(50)])
    stream.at(said[-1].end / RATE)
    assert len(stream._episodes) < 15


def test_a_cut_lets_it_go_and_makes_void_what_comes_later() -> None:
    stream, _ = feeling(smiley("joy", 500.0), *SPEECH, smiley("anger", 500.0))
    plain, _ = feeling(smiley("joy", 500.0), *SPEECH)
    before = level(stream, "joy", np.arange(0, 1.2, 0.05))
    stream.cut(1.2)
    assert level(stream, "joy", np.array([1.2])) == pytest.approx(level(plain, "joy", np.array([1.2])))
    assert level(plain, "joy", np.arange(0, 1.2, 0.05)) == pytest.approx(before)
    track = level(stream, "joy", np.arange(1.2, 3.0, 0.02))
    assert np.abs(np.diff(track)).max() < 0.1
    assert track[-1] == 0
    assert not level(stream, "anger", np.arange(2.1, 4, 0.1)).any()
