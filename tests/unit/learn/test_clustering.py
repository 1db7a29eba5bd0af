"""The split that is found is the best of all, and trees stop where they should."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.learn.clustering import grow
from fapstream.learn.gaussians import Counts

FLOOR = np.full(2, 1e-3)


def counted(x: np.ndarray, n: int = 50, seed: int = 0) -> Counts:
    """Of states with those means (s, 2): n frames each."""
    rng = np.random.default_rng(seed)
    counts = Counts.none(len(x), 2)
    for state, mean in enumerate(x):
        counts.add(np.array([state]), np.ones((n, 1)), np.zeros(1), rng.normal(mean, 0.3, (n, 2)))
    return counts


def likelihood(counts: Counts, members: np.ndarray) -> float:
    n, x, x2 = counts.occupancy[members].sum(), counts.x[members].sum(axis=0), counts.x2[members].sum(axis=0)
    return float(-0.5 * n * (np.log(np.maximum(x2 / n - (x / n) ** 2, FLOOR)) + 1).sum())


@pytest.mark.parametrize("seed", range(6))
def test_the_first_split_has_the_greatest_gain(seed: int) -> None:
    rng = np.random.default_rng(seed)
    answers = rng.random((12, 9)) < 0.5
    counts = counted(rng.normal(size=(12, 2)), seed=seed)
    tree = grow(counts, answers, (1, 0), FLOOR)
    everyone = np.arange(12)
    gains = [
        likelihood(counts, everyone[yes]) + likelihood(counts, everyone[~yes])
        if 0 < yes.sum() < 12
        else -np.inf
        for yes in answers.T
    ]
    assert tree.nodes[0, 0] == int(np.argmax(gains))


def test_states_that_differ_are_told_apart_and_equal_ones_are_one() -> None:
    answers = np.array([[1, 0, 0], [1, 0, 1], [0, 1, 0], [0, 1, 1]], bool)
    counts = counted(np.array([[0, 0], [0, 0], [5, 5], [5, 5.0]]))
    tree = grow(counts, answers, (10, 30), FLOOR)
    assert tree.n_leaves == 2
    leaves = [tree.leaf(row) for row in answers]
    assert leaves[0] == leaves[1] != leaves[2] == leaves[3]


def test_nothing_smaller_than_asked_for_is_split_off() -> None:
    answers = np.eye(4, dtype=bool)
    counts = counted(np.array([[0, 0], [5, 5], [9, 0], [0, 9.0]]), n=50)
    assert grow(counts, answers, (51, 0), FLOOR).n_leaves == 1
    assert grow(counts, answers, (1, 1e9), FLOOR).n_leaves == 1
    assert grow(counts, answers, (1, 0), FLOOR).n_leaves == 4


def test_a_context_that_was_never_met_has_a_leaf() -> None:
    answers = np.array([[1, 0], [0, 1]], bool)
    tree = grow(counted(np.array([[0, 0], [5, 5.0]])), answers, (1, 0), FLOOR)
    for row in ([0, 0], [1, 1]):
        assert 0 <= tree.leaf(np.array(row, bool)) < tree.n_leaves


def test_states_that_were_never_met_say_nothing() -> None:
    counts = Counts.none(3, 2)
    counts.add(np.array([0]), np.ones((40, 1)), np.zeros(1), np.zeros((40, 2)))
    assert grow(counts, np.eye(3, dtype=bool), (1, 0), FLOOR).n_leaves == 1
