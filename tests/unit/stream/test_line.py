"""Sound in order: joined, cut, shortened and stretched, and which sample of the turn is where."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.records import Pcm
from fapstream.stream.line import Line
from tests.unit.stream.test_stretch import vowel

RATE = 16_000
VOICE = np.rint(20_000 * vowel(100, 2.0) / 0.3).astype(np.int16)


def drained(line: Line) -> tuple[Pcm, list[int]]:
    """All that is left, and the sample of the turn at each place."""
    parts, samples = [np.zeros(0, np.int16)], []
    while line.queued:
        first, pace = line.sample, line.knot.pace
        part = line.take(1000)
        samples += [first + pace * k for k in range(len(part))]
        parts.append(part)
    return np.concatenate(parts), samples


def filled(n: int = 8000, start: int = 0) -> Line:
    line = Line(RATE)
    assert line.push(start, VOICE[start : start + n]) == n
    return line


def test_what_goes_in_comes_out_with_its_samples() -> None:
    line = Line(RATE)
    for k in range(10):
        line.push(5000 + 100 * k, VOICE[100 * k : 100 * k + 100])
        line.take(60)
    assert (line.queued, line.sample, line.next) == (400, 5600, 6000)
    pcm, samples = drained(line)
    assert np.array_equal(pcm, VOICE[600:1000])
    assert samples == list(range(5600, 6000))


def test_what_is_here_already_is_ignored() -> None:
    line = filled(1000)
    assert line.push(0, VOICE[:400]) == 0
    assert line.push(900, VOICE[900:1300]) == 300
    assert np.array_equal(drained(line)[0], VOICE[:1300])


def test_packets_shorter_than_the_bridge_are_bridged_as_one_is() -> None:
    whole, pieces = filled(3200), filled(3200)
    whole.push(16_050, VOICE[16_050:16_250])
    for k in range(16_050, 16_250):
        pieces.push(k, VOICE[k : k + 1])
    expected, found = drained(whole)[0], drained(pieces)[0]
    assert len(found) == 3400
    assert np.abs(found.astype(int) - expected).max() <= 2


def test_what_is_left_out_is_bridged() -> None:
    """And later leaps keep their places."""
    line = filled(8000)
    line.push(10_000, VOICE[10_000:12_000])
    line.take(1000)
    line.skip(2500)
    assert line.next == 12_000
    pcm, samples = drained(line)
    assert samples == [*range(7500, 8000), *range(10_000, 12_000)]
    assert np.array_equal(pcm[80:500], VOICE[7580:8000])
    assert np.array_equal(pcm[580:], VOICE[10_080:12_000])
    heard = np.concatenate([VOICE[900:1000], pcm]).astype(int)
    assert np.abs(np.diff(heard)).max() <= 1.1 * np.abs(np.diff(VOICE.astype(int))).max()
    line.skip(0)
    assert line.queued == 0


def test_nothing_is_left_out_of_what_is_not_there() -> None:
    line = filled(1000)
    line.skip(1000)
    line.skip(2000)
    assert np.array_equal(drained(line)[0], VOICE[:1000])


def test_a_gap_is_bridged_and_the_sample_leaps() -> None:
    line = filled(3200)
    line.take(3100)
    line.push(16_000, VOICE[16_000:19_200])
    pcm, samples = drained(line)
    assert samples == [*range(3100, 3200), *range(16_000, 19_200)]
    assert np.array_equal(pcm[180:], VOICE[16_080:19_200])
    assert np.abs(np.diff(pcm.astype(int))).max() <= 1.1 * np.abs(np.diff(VOICE.astype(int))).max()


def test_what_is_discarded_gives_way_within_5_ms() -> None:
    line = filled(8000)
    line.take(1000)
    line.discard(4000)
    assert (line.next, line.queued) == (4000, 3000)
    line.push(4000, np.zeros(800, np.int16))
    pcm, samples = drained(line)
    assert np.array_equal(pcm[:3000], VOICE[1000:4000])
    assert samples == list(range(1000, 4800))
    assert pcm[3000:3080].any()
    assert not pcm[3080:].any()


def test_what_was_played_cannot_be_discarded() -> None:
    line = filled(8000)
    line.take(5000)
    line.discard(100)
    assert (line.next, line.queued) == (5000, 0)
    assert line.push(100, VOICE[100:6000]) == 1000
    line.discard(9999)
    assert line.next == 6000
    assert drained(line)[1] == list(range(5000, 6000))


@pytest.mark.parametrize("way", [-1, 1])
def test_a_period_is_left_out_or_said_twice(way: int) -> None:
    """Where it is mixed the sample runs at twice its pace, or stands."""
    line = filled(8000)
    line.take(2000)
    change = line.alter(way)
    assert change is not None
    lag = way * change.samples
    assert lag % 160 in (0, 1, 159), "100 Hz"
    assert not change.quiet
    pcm, samples = drained(line)
    assert len(pcm) == 6000 + way * lag
    assert samples == [
        *(2000 + (1 - way) * k for k in range(lag)), *range(2000 + (1 - way) * lag, 8000)
    ]  # fmt: skip
    assert np.abs(pcm[:lag] - VOICE[2000 : 2000 + lag].astype(float)).max() < 0.1 * 20_000, "as the voice is"
    assert np.array_equal(pcm[lag:], VOICE[2000 + (1 - way) * lag : 8000])


def test_changes_lie_apart_and_noise_is_left_alone() -> None:
    line = filled(8000)
    line.take(2000)
    assert line.alter(-1)
    assert line.alter(-1) is None
    noise = Line(RATE)
    noise.push(0, np.random.default_rng(3).integers(-9000, 9000, 8000).astype(np.int16))
    noise.take(2000)
    assert noise.alter(-1) is noise.alter(1) is None


def test_of_a_pause_as_much_as_may_be() -> None:
    line = Line(RATE)
    line.push(0, np.zeros(8000, np.int16))
    line.take(1000)
    change = line.alter(-1)
    assert change == (-240, True)
    assert line.queued == 7000 - 240


def test_with_little_sound_nothing_is_changed() -> None:
    line = filled(100)
    assert line.alter(-1) is line.alter(1) is None
    assert Line(RATE).alter(1) is None


def test_a_leap_behind_a_change_moves_with_it() -> None:
    line = filled(4000)
    line.push(16_000, VOICE[16_000:20_000])
    line.take(1000)
    change = line.alter(-1)
    assert change is not None
    assert drained(line)[1][-4001:] == [3999, *range(16_000, 20_000)]


def test_a_cut_within_a_change_leaves_no_sample_out() -> None:
    line = filled(8000)
    line.take(2000)
    change = line.alter(-1)
    assert change is not None
    line.discard(2100)
    assert line.next == 2100
    line.push(2100, VOICE[2100:3000])
    assert drained(line)[1] == [*range(2000, 2100, 2), *range(2100, 3000)]


def test_it_forgets_what_was_played() -> None:
    line = Line(RATE)
    for k in range(2000):
        line.push(640 * k, np.zeros(640, np.int16))
        line.take(600 if k < 50 else 640)
    assert len(line._data) < 4000
