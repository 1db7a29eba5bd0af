"""Densities against scipy's, and what is counted for them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from fapstream.learn.gaussians import STAY, Counts, Gaussians

RNG = np.random.default_rng(0)


def test_densities_are_those_of_diagonal_gaussians() -> None:
    some = Gaussians(RNG.normal(size=(3, 4)), RNG.uniform(0.2, 3, (3, 4)), np.full(3, 0.5))
    x = RNG.normal(size=(5, 4))
    for state in range(3):
        wanted = multivariate_normal(some.mean[state], np.diag(some.var[state])).logpdf(x)
        assert some.log_density(x, np.array([2, state]))[:, 1] == pytest.approx(wanted)


def test_what_was_counted_gives_mean_variance_and_stay() -> None:
    x = RNG.normal(2.0, 3.0, (400, 2))
    counts = Counts.none(2, 2)
    counts.add(np.array([1]), np.ones((400, 1)), np.array([300.0]), x)
    before = Gaussians(np.zeros((2, 2)), np.ones((2, 2)), np.full(2, 0.6))
    found = counts.gaussians(np.full(2, 1e-3), before)
    assert found.mean[1] == pytest.approx(x.mean(axis=0))
    assert found.var[1] == pytest.approx(x.var(axis=0))
    assert found.stay[1] == 0.75
    assert np.array_equal(found.mean[0], before.mean[0]), "a state that was never met stays as it was"
    assert (found.var[0], found.stay[0]) == (pytest.approx([1, 1]), 0.6)


def test_no_variance_is_less_than_the_floor_and_no_stay_is_sure() -> None:
    counts = Counts.none(1, 1)
    counts.add(np.array([0]), np.ones((5, 1)), np.array([5.0]), np.full((5, 1), 7.0))
    found = counts.gaussians(np.array([0.25]), Gaussians(np.zeros((1, 1)), np.ones((1, 1)), np.ones(1)))
    assert found.var[0, 0] == 0.25
    assert found.stay[0] == STAY[1]


def test_states_are_pooled_and_picked() -> None:
    counts = Counts.none(3, 1)
    for state in range(3):
        counts.add(np.array([state]), np.ones((2, 1)), np.array([1.0]), np.full((2, 1), float(state)))
    pooled = counts.pooled(np.array([1, 0, 1]), 2)
    assert pooled.occupancy.tolist() == [2, 4]
    assert pooled.x[:, 0].tolist() == [2, 4]
    assert pooled.x2[:, 0].tolist() == [2, 8]
    assert counts.of(np.array([2])).x[:, 0].tolist() == [4]


def test_a_state_that_comes_twice_in_a_sentence_counts_twice() -> None:
    counts = Counts.none(2, 1)
    counts.add(np.array([0, 1, 0]), np.ones((4, 3)) / 3, np.zeros(3), np.ones((4, 1)))
    assert counts.occupancy == pytest.approx([8 / 3, 4 / 3])
