"""Outputs of states against scipy, and what is counted for them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import multivariate_normal

from fapstream.learn.gaussians import LEAST_FRAMES, STAY, Counts, Gaussians


def some(rng: np.random.Generator, m: int, d: int) -> Gaussians:
    return Gaussians(rng.normal(size=(m, d)), rng.uniform(0.1, 3, (m, d)), rng.uniform(0.1, 0.9, m))


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 6))
def test_densities_are_scipys(seed: int, d: int) -> None:
    rng = np.random.default_rng(seed)
    states, x = rng.integers(0, 5, 7), 3 * rng.normal(size=(11, d))
    of = some(rng, 5, d)
    found = of.log_density(x, states)
    expected = [multivariate_normal(of.mean[s], np.diag(of.var[s])).logpdf(x) for s in states]
    np.testing.assert_allclose(found, np.transpose(expected), atol=1e-9)


def test_densities_far_from_a_narrow_state_are_exact_enough() -> None:
    """Parameters have unit variance; a state a hundredth as wide, ten of these away."""
    of = Gaussians(np.array([[10.0]]), np.array([[1e-4]]), np.array([0.5]))
    x = np.array([[10.0], [10.01], [0.0]])
    expected = multivariate_normal([10.0], [[1e-4]]).logpdf(x)
    np.testing.assert_allclose(of.log_density(x, np.array([0]))[:, 0], expected, rtol=1e-9, atol=1e-8)


def test_counted_frames_give_back_their_mean_variance_and_stay() -> None:
    """A sentence whose places are known: two places of state 1 are counted as one."""
    rng = np.random.default_rng(0)
    x = rng.normal(size=(60, 3))
    place = np.repeat([0, 1, 2], [10, 20, 30])
    gamma = np.eye(3)[place]
    counts = Counts.none(4, 3)
    counts.add(np.array([1, 3, 1]), gamma, np.array([9.0, 19, 29]), x)
    np.testing.assert_allclose(counts.occupancy, [0, 40, 0, 20])
    found = counts.gaussians(np.full(3, 1e-6), some(rng, 4, 3))
    one, three = x[place != 1], x[place == 1]
    np.testing.assert_allclose(found.mean[[1, 3]], [one.mean(axis=0), three.mean(axis=0)])
    np.testing.assert_allclose(found.var[[1, 3]], [one.var(axis=0), three.var(axis=0)])
    np.testing.assert_allclose(found.stay[[1, 3]], [38 / 40, 19 / 20])


def test_frames_count_as_much_as_they_are_probable() -> None:
    rng = np.random.default_rng(1)
    x, gamma = rng.normal(size=(30, 2)), rng.dirichlet(np.ones(3), 30)
    counts = Counts.none(3, 2)
    counts.add(np.arange(3), gamma, np.zeros(3), x)
    found = counts.gaussians(np.zeros(2), some(rng, 3, 2))
    for k in range(3):
        mean = np.average(x, axis=0, weights=gamma[:, k])
        np.testing.assert_allclose(found.mean[k], mean)
        np.testing.assert_allclose(found.var[k], np.average((x - mean) ** 2, axis=0, weights=gamma[:, k]))


def test_sentences_counted_by_turns_are_counted_together() -> None:
    rng = np.random.default_rng(2)
    parts = [(rng.dirichlet(np.ones(2), n), rng.random(2), rng.normal(size=(n, 2))) for n in (5, 9)]
    turns, whole = Counts.none(2, 2), Counts.none(2, 2)
    for gamma, stays, x in parts:
        turns.add(np.arange(2), gamma, stays, x)
    whole.add(np.arange(2), np.vstack([p[0] for p in parts]), parts[0][1] + parts[1][1],
              np.vstack([p[2] for p in parts]))  # fmt: skip
    for name in ("occupancy", "stays", "x", "x2"):
        np.testing.assert_allclose(getattr(turns, name), getattr(whole, name))


def drawn(rng: np.random.Generator, m: int, d: int) -> Counts:
    return Counts(rng.uniform(1, 9, m), rng.random(m), rng.normal(size=(m, d)), rng.uniform(9, 20, (m, d)))


@settings(max_examples=30, deadline=None)
@given(st.lists(st.integers(0, 3), min_size=1, max_size=12), st.integers(0, 10**6))
def test_pooled_counts_are_sums_over_their_groups(groups: list[int], seed: int) -> None:
    counts = drawn(np.random.default_rng(seed), len(groups), 2)
    found, belongs = counts.pooled(np.array(groups), 5), np.array(groups)
    for name in ("occupancy", "stays", "x", "x2"):
        expected = [getattr(counts, name)[belongs == g].sum(axis=0) for g in range(5)]
        np.testing.assert_allclose(getattr(found, name), expected, atol=1e-12)


def test_counts_of_some_states_are_theirs() -> None:
    counts = drawn(np.random.default_rng(3), 5, 2)
    found = counts.of(np.array([4, 1]))
    np.testing.assert_array_equal(found.x2, counts.x2[[4, 1]])
    np.testing.assert_array_equal(found.occupancy, counts.occupancy[[4, 1]])
    np.testing.assert_array_equal(found.stays, counts.stays[[4, 1]])


def test_no_variance_is_below_the_floor() -> None:
    """Also where all frames were the same, or rounding makes a variance negative."""
    counts = Counts.none(2, 2)
    x = np.full((1000, 2), 1e4 + 0.1)
    counts.add(np.array([0]), np.ones((1000, 1)), np.array([999.0]), x)
    counts.add(
        np.array([1]), np.ones((1000, 1)), np.array([500.0]), np.random.default_rng(4).normal(size=x.shape)
    )
    found = counts.gaussians(np.array([0.01, 2.0]), some(np.random.default_rng(5), 2, 2))
    assert found.var[0].tolist() == [0.01, 2.0]
    assert found.var[1, 0] == pytest.approx(1, abs=0.1)
    assert found.var[1, 1] == 2.0


def test_nobody_is_sure_to_stay_or_to_go() -> None:
    counts = Counts(np.array([10.0, 10.0]), np.array([0.0, 10.0]), np.zeros((2, 1)), np.ones((2, 1)))
    found = counts.gaussians(np.zeros(1), some(np.random.default_rng(6), 2, 1))
    assert tuple(found.stay) == STAY


def test_states_that_were_never_met_stay_as_they_were() -> None:
    rng = np.random.default_rng(7)
    before, counts = some(rng, 3, 2), Counts.none(3, 2)
    gamma = np.zeros((20, 2))
    gamma[:, 0], gamma[0, 1] = 1, LEAST_FRAMES / 2
    counts.add(np.array([0, 2]), gamma, np.array([19.0, 0]), rng.normal(size=(20, 2)))
    found = counts.gaussians(np.full(2, 5.0), before)
    for name in ("mean", "var", "stay"):
        np.testing.assert_array_equal(getattr(found, name)[1:], getattr(before, name)[1:])
        assert (getattr(found, name)[0] != getattr(before, name)[0]).all()
