"""Trees that tie states: every split against all questions, one by one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.stats import multivariate_normal

from fapstream.learn.clustering import grow
from fapstream.learn.gaussians import Counts
from fapstream.motion.trees import Tree

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]
FLOOR = np.array([0.05, 0.05])


def frames(rng: np.random.Generator, states: int, most: int = 30) -> list[Floats]:
    """Of each state, about somewhere of its own."""
    return [
        rng.normal(rng.normal(size=2), rng.uniform(0.3, 2), (int(rng.integers(2, most)), 2))
        for _ in range(states)
    ]


def counted(of: list[Floats]) -> Counts:
    counts = Counts.none(len(of), 2)
    for k, x in enumerate(of):
        counts.add(np.array([k]), np.ones((len(x), 1)), np.array([0.0]), x)
    return counts


def log_likelihood(x: Floats) -> float:
    """Of frames under their own Gaussian: what a split gains is the difference of these."""
    if not len(x):
        return 0.0
    return float(multivariate_normal(x.mean(axis=0), np.diag(x.var(axis=0))).logpdf(x).sum())


def gains(of: list[Floats], answers: Bools, members: list[int], least: float) -> Floats:
    """Of every question, -inf where too few frames fall to one side."""
    found = []
    for question in range(answers.shape[1]):
        sides = [[of[m] for m in members if answers[m, question] == side] for side in (True, False)]
        yes, no = (np.concatenate(side) if side else np.empty((0, 2)) for side in sides)
        enough = min(len(yes), len(no)) >= least
        gain = log_likelihood(yes) + log_likelihood(no) - log_likelihood(np.concatenate([yes, no]))
        found.append(gain if enough else -np.inf)
    return np.array(found)


def visit(tree: Tree, answers: Bools, node: int, members: list[int]) -> list[tuple[int, list[int]]]:
    """Every node and the states that come there."""
    question, yes, no = tree.nodes[node]
    here = [(node, members)]
    if question >= 0:
        here += visit(tree, answers, yes, [m for m in members if answers[m, question]])
        here += visit(tree, answers, no, [m for m in members if not answers[m, question]])
    return here


@pytest.mark.parametrize("seed", range(12))
def test_every_split_is_the_best_and_every_leaf_has_none(seed: int) -> None:
    rng = np.random.default_rng(seed)
    of, answers = frames(rng, 25), rng.random((25, 6)) < 0.5
    tree = grow(counted(of), answers, (15.0, 8.0), np.full(2, 1e-9))
    assert tree.n_leaves > 2
    for node, members in visit(tree, answers, 0, list(range(25))):
        gain, question = gains(of, answers, members, 15.0), tree.nodes[node, 0]
        if question < 0:
            assert gain.max() <= 8 + 1e-6
        else:
            assert gain[question] == pytest.approx(gain.max())
            assert gain[question] > 8


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.floats(1, 100), st.floats(0, 50))
def test_no_leaf_is_smaller_than_asked_and_leaves_are_numbered_through(
    seed: int, least: float, gain: float
) -> None:
    rng = np.random.default_rng(seed)
    of, answers = frames(rng, 12), rng.random((12, 5)) < 0.5
    tree = grow(counted(of), answers, (least, gain), FLOOR)
    leaves = [tree.leaf(row) for row in answers]
    assert sorted(set(leaves)) == list(range(tree.n_leaves))
    occupied = [sum(len(of[i]) for i in range(12) if leaves[i] == leaf) for leaf in range(tree.n_leaves)]
    assert tree.n_leaves == 1 or min(occupied) >= least


def test_a_leaf_is_where_its_answers_lead() -> None:
    """Through every node by hand, whatever the answers."""
    rng = np.random.default_rng(3)
    of, answers = frames(rng, 30), rng.random((30, 6)) < 0.5
    tree = grow(counted(of), answers, (5.0, 1.0), FLOOR)
    everywhere = {m: tree.nodes[node, 1] for node, members in visit(tree, answers, 0, list(range(30)))
                  if tree.nodes[node, 0] < 0 for m in members}  # fmt: skip
    assert [tree.leaf(row) for row in answers] == [everywhere[m] for m in range(30)]
    for bits in range(64):
        given_ = np.array([bits >> k & 1 for k in range(6)], bool)
        assert 0 <= tree.leaf(given_) < tree.n_leaves


def test_a_question_that_tells_the_states_apart_is_found_among_others() -> None:
    rng = np.random.default_rng(4)
    answers = rng.random((40, 9)) < 0.5
    of = [rng.normal(3.0 * answers[k, 7], 1, (20, 2)) for k in range(40)]
    tree = grow(counted(of), answers, (50.0, 40.0), FLOOR)
    assert tree.nodes[0, 0] == 7
    assert tree.n_leaves == 2


def test_a_context_that_was_never_met_goes_the_same_way() -> None:
    """Its answers decide, and its own counts, of which there are none, do not."""
    rng = np.random.default_rng(5)
    answers = rng.random((20, 3)) < 0.5
    of = [rng.normal(4.0 * answers[k, 1], 1, (20, 2)) for k in range(20)]
    alone = grow(counted(of), answers, (30.0, 20.0), FLOOR)
    with_unseen = grow(
        counted([*of, np.empty((0, 2))]), np.vstack([answers, [True, True, False]]), (30.0, 20.0), FLOOR
    )
    np.testing.assert_array_equal(alone.nodes, with_unseen.nodes)
    assert alone.leaf(np.array([True, True, False])) == alone.leaf(answers[np.flatnonzero(answers[:, 1])[0]])


@pytest.mark.parametrize("states", [0, 1, 5])
def test_nothing_to_split_is_one_leaf(states: int) -> None:
    """No states at all, one, and several that no question is asked of or that nobody was in."""
    rng = np.random.default_rng(6)
    for of, questions in (
        (frames(rng, states), 3),
        (frames(rng, states), 0),
        ([np.empty((0, 2))] * states, 3),
    ):
        tree = grow(counted(of), np.ones((states, questions), bool), (1.0, 0.0), FLOOR)
        assert tree.nodes.tolist() == [[-1, 0, 0]]
        assert tree.leaf(np.zeros(questions, bool)) == 0


def test_the_floor_keeps_a_few_alike_frames_from_gaining_much() -> None:
    """Two states that stand still at places hardly apart gain without end, but for the floor."""
    of = [np.full((30, 2), 0.0), np.full((30, 2), 0.01)]
    answers = np.array([[True], [False]])
    assert grow(counted(of), answers, (1.0, 40.0), np.full(2, 1e-9)).n_leaves == 2
    assert grow(counted(of), answers, (1.0, 40.0), np.full(2, 0.01)).n_leaves == 1
