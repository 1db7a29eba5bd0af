"""Learning to hear: gradients, a relation that was planted, and other microphones."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.errors import ClipError
from fapstream.learn.hearing import HearingFit, _error, paired, stacked, warp
from fapstream.motion.hearing import BANDS, DEEP, STACKED, centres
from tests.unit.voicing import voicing


def test_the_gradient_is_that_of_the_error() -> None:
    rng = np.random.default_rng(0)
    x, y = rng.normal(size=(60, 5)).astype(np.float32), rng.normal(size=(60, 2)).astype(np.float32)
    shapes = (6, 4), (5, 2)
    weights = rng.normal(size=6 * 4 + 5 * 2)
    _, gradient = _error(weights, x, y, shapes)
    way = rng.normal(size=weights.size)
    up, down = (_error(weights + h * way, x, y, shapes)[0] for h in (1e-2, -1e-2))
    assert (up - down) / 2e-2 == pytest.approx(gradient @ way, rel=2e-2)


def test_a_planted_relation_is_found() -> None:
    rng = np.random.default_rng(1)
    x = rng.normal(size=(1500, 8)) * 3 + 1
    y = np.stack([np.tanh(x[:, 0] - x[:, 1]), 0.3 * x[:, 2]], axis=1)
    fit = HearingFit(units=10, iterations=200).fit(x, y)
    other = rng.normal(size=(300, 8)) * 3 + 1
    wanted = np.stack([np.tanh(other[:, 0] - other[:, 1]), 0.3 * other[:, 2]], axis=1)
    made = fit.heard_.parameters(other)
    for k in range(2):
        assert np.corrcoef(made[:, k], wanted[:, k])[0, 1] > 0.95
    again = HearingFit(units=10, iterations=200).fit(x, y)
    assert np.array_equal(again.heard_.out, fit.heard_.out)


def test_every_instant_has_what_is_heard_around_it() -> None:
    rows = stacked(voicing(1.0))
    assert rows.shape[1] == STACKED * BANDS
    assert len(rows) in (50, 51)
    assert (rows[0, : BANDS * (STACKED // 2)] == -DEEP).all(), "before the beginning it was silent"


def test_another_microphone_hears_something_else_of_the_same() -> None:
    pcm = voicing(1.0)
    plain, other = stacked(pcm), stacked(pcm, np.random.default_rng(2))
    assert not np.allclose(plain, other)
    middle = slice(15, 35)
    assert np.corrcoef(plain[middle].ravel(), other[middle].ravel())[0, 1] > 0.5
    assert np.array_equal(stacked(pcm, np.random.default_rng(2)), other)


def test_formants_move_with_the_vocal_tract() -> None:
    """A band's energy is found where one so many times as high is, and nothing is made of silence."""
    hump = np.exp(-0.5 * ((centres() - 1000) / 150) ** 2)
    assert (hump @ warp(1.0)) == pytest.approx(hump)
    for times in (0.85, 1.2):
        moved = hump @ warp(times)
        assert (moved @ centres()) / moved.sum() == pytest.approx(times * 1000, rel=0.05)
    assert np.full(BANDS, -DEEP) @ warp(1.1) == pytest.approx(np.full(BANDS, -DEEP))


def test_clips_are_paired_with_what_their_faces_did() -> None:
    pcm = voicing(1.0)
    parameters = np.arange(200.0).reshape(100, 2)
    x, y = paired([pcm], [parameters], [slice(20, 60)])
    assert len(x) == len(y) == 2 * 20
    assert y[0, 0] == parameters[20, 0]
    assert x[0] == pytest.approx(stacked(pcm)[10])


def test_without_sound_there_is_nothing_to_learn() -> None:
    with pytest.raises(ClipError, match="no sound"):
        HearingFit().fit(np.zeros((0, 4)), np.zeros((0, 2)))
