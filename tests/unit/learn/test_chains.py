"""Forward, backward and best path against every path there is, on tiny chains."""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np
import pytest

from fapstream.learn.chains import Arcs, Chains, arcs, best_path, posterior


def tiny(seed: int) -> tuple[Chains, Arcs, np.ndarray, np.ndarray]:
    """Two sentences of other lengths, one with a place that may be jumped over, and densities for each."""
    rng = np.random.default_rng(seed)
    state = np.array([[0, 1, 2, 3, -1], [2, 0, 1, 3, 1]])
    jump = np.full((2, 5), -1)
    jump[1, 3] = 1
    lengths = np.array([[4, 6], [5, 7]])
    stay = rng.uniform(0.2, 0.8, 4)
    chains = Chains(state, jump, lengths)
    log_b = rng.normal(size=(2, 7, 5))
    log_b[0, 2, 1] = -np.inf
    return chains, arcs(chains, stay), log_b, stay


def paths(chains: Chains, of: Arcs, log_b: np.ndarray, i: int) -> list[tuple[float, tuple[int, ...]]]:
    """Log probability of every path of sentence i, and the path."""
    s, t = chains.lengths[i]
    found = []
    for path in product(range(s), repeat=int(t)):
        if path[0] != 0 or path[-1] != s - 1:
            continue
        total = log_b[i, 0, 0] + of.leave[i, s - 1]
        for frame, (a, b) in enumerate(pairwise(path), 1):
            if b == a:
                step = of.stay[i, a]
            elif b == a + 1 or chains.jump[i, b] == a:
                step = of.leave[i, a]
            else:
                step = -np.inf
            total += step + log_b[i, frame, b]
        if total > -np.inf:
            found.append((float(total), path))
    return found


@pytest.mark.parametrize("seed", range(5))
def test_posteriors_are_sums_over_all_paths(seed: int) -> None:
    chains, of, log_b, _ = tiny(seed)
    found = posterior(chains, of, log_b)
    for i in range(2):
        every = paths(chains, of, log_b, i)
        weights = np.exp([w for w, _ in every])
        assert found.log_likelihood[i] == pytest.approx(np.log(weights.sum()))
        gamma, stays = np.zeros((7, 5)), np.zeros(5)
        for w, path in zip(weights / weights.sum(), (p for _, p in every), strict=True):
            for frame, place in enumerate(path):
                gamma[frame, place] += w
            for a, b in pairwise(path):
                stays[a] += w * (a == b)
        assert found.gamma[i] == pytest.approx(gamma, abs=1e-9)
        assert found.stays[i] == pytest.approx(stays, abs=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_the_best_path_is_the_best_of_all(seed: int) -> None:
    chains, of, log_b, _ = tiny(seed)
    found = best_path(chains, of, log_b)
    for i in range(2):
        t = chains.lengths[i, 1]
        assert tuple(found[i, :t]) == max(paths(chains, of, log_b, i))[1]
        assert (found[i, t:] == -1).all()


def test_a_sentence_that_no_path_fits_is_no_news() -> None:
    """Fewer frames than places, and none may be jumped over."""
    chains = Chains(np.array([[0, 1, 2]]), np.full((1, 3), -1), np.array([[3, 2]]))
    of = arcs(chains, np.full(3, 0.5))
    found = posterior(chains, of, np.zeros((1, 2, 3)))
    assert found.log_likelihood[0] == -np.inf
    assert not found.gamma.any()
    assert not found.stays.any()
    assert (best_path(chains, of, np.zeros((1, 2, 3))) == -1).all()


def test_steps_from_a_place_are_one_of_all_there_are() -> None:
    """Over all lengths of sound a chain ends with certainty."""
    chains, of, _, stay = tiny(1)
    assert np.exp(of.stay[0, :4]) == pytest.approx(stay[[0, 1, 2, 3]])
    total = 0.0
    for t in range(2, 120):
        one = Chains(chains.state[1:], chains.jump[1:], np.array([[5, t]]))
        total += np.exp(posterior(one, arcs(one, stay), np.zeros((1, t, 5))).log_likelihood[0])
    assert total == pytest.approx(1, abs=1e-6)
