"""Blinks that close the eye (19 and 21 add up to ES0, 1024 units) and a head that stays near where it was."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from fapstream.motion.idle import AU, HEAD_AMPLITUDE_RAD, IdleLife

RATE = 16000
LIDS = (19, 20, 21, 22)
FINE = RATE // 200


def life(seed: int, seconds: float, rate: int = RATE, step: int = FINE) -> NDArray[np.float64]:
    """FAPs of a face that does nothing else, shape (n, 68)."""
    idle = IdleLife(seed, rate)
    rows = []
    for sample in range(0, int(seconds * rate), step):
        values = np.zeros(68)
        idle.add_to(values, sample)
        rows.append(values)
    return np.array(rows)


def test_seeded() -> None:
    assert np.array_equal(life(5, 20), life(5, 20))
    assert not np.array_equal(life(5, 20), life(6, 20))


def test_it_is_a_function_of_time_and_not_of_the_frames_asked_for() -> None:
    assert np.array_equal(life(3, 30)[::8], life(3, 30, step=8 * FINE))
    assert life(3, 30) == pytest.approx(life(3, 30, rate=2 * RATE, step=2 * FINE))


def blinks(rows: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Runs of rows in which the eye is not open."""
    shut = rows[:, 18] > 0
    edges = np.flatnonzero(np.diff(np.concatenate([[False], shut, [False]]).astype(int)))
    return [rows[a:b] for a, b in zip(edges[::2], edges[1::2], strict=True)]


@pytest.mark.parametrize("seed", range(4))
def test_every_blink_closes_the_eye_and_opens_it_again(seed: int) -> None:
    rows = life(seed, 60)
    found = blinks(rows[: len(rows) - 200])
    assert 8 <= len(found) <= 50
    for blink in found:
        assert (blink[:, 18] + blink[:, 20]).max() == pytest.approx(1024)
        assert np.array_equal(blink[:, 18], blink[:, 19])
        assert np.array_equal(blink[:, 20], blink[:, 21])
        assert 0.2 <= len(blink) / 200 <= 0.3
    assert ((rows[:, 18] >= 0) & (rows[:, 18] <= 900) & (rows[:, 20] >= 0) & (rows[:, 20] <= 124)).all()


def test_a_blink_closes_lids_that_stand_elsewhere() -> None:
    """Fear opens the eyes wide (19 = -180); they meet all the same and never go past each other."""
    idle, lids = IdleLife(1, RATE), []
    for sample in range(0, 30 * RATE, FINE):
        values = np.zeros(68)
        values[[18, 19]] = -180
        idle.add_to(values, sample)
        lids.append(values[18] + values[20])
    assert max(lids) == pytest.approx(1024)
    assert min(lids) == -180


@pytest.mark.parametrize("seed", range(4))
def test_the_head_moves_within_its_amplitude_and_starts_from_the_front(seed: int) -> None:
    rows = life(seed, 60)
    for fap, amplitude in HEAD_AMPLITUDE_RAD.items():
        track = rows[:, fap - 1]
        assert track[0] == 0
        assert np.abs(track).max() <= amplitude / AU
        assert np.abs(track).max() >= 0.2 * amplitude / AU
        assert np.abs(np.diff(track)).max() <= 0.03 * amplitude / AU, "no jerk within 5 ms"


def test_nothing_else_moves() -> None:
    moving = {i + 1 for i in np.flatnonzero(life(2, 60).any(axis=0))}
    assert moving == {*LIDS, *HEAD_AMPLITUDE_RAD}
