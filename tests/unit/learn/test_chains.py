"""Forward, backward and the best path against all paths, one by one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from fapstream.learn.chains import NEVER, Arcs, Chains, arcs, best_path, posterior

Floats = NDArray[np.float64]
Path = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Row:
    """One sentence: its states, places to jump to and from where, and log densities (t, s)."""

    states: tuple[int, ...]
    jumps: dict[int, int]
    log_b: Floats


def batch(rows: list[Row], rng: np.random.Generator) -> tuple[Chains, Floats]:
    """Padded; what the padding holds is nobody's business, so there is anything in it."""
    s, t = max(len(row.states) for row in rows), max(len(row.log_b) for row in rows)
    state, jump = np.full((len(rows), s), -1), np.full((len(rows), s), -1)
    log_b = rng.normal(size=(len(rows), t, s))
    for i, row in enumerate(rows):
        state[i, : len(row.states)] = row.states
        for to, origin in row.jumps.items():
            jump[i, to] = origin
        log_b[i, : len(row.log_b), : len(row.states)] = row.log_b
    lengths = np.array([(len(row.states), len(row.log_b)) for row in rows])
    return Chains(state, jump, lengths), log_b


def drawn(rng: np.random.Generator, m: int, holes: float = 0.0) -> Row:
    """A row of up to five places and seven frames with jumps here and there, over m states."""
    s = int(rng.integers(1, 6))
    jumps = {to: to - int(rng.integers(2, to + 1)) for to in range(2, s) if rng.random() < 0.5}
    jumps = {to: origin for i, (to, origin) in enumerate(jumps.items())
             if origin not in list(jumps.values())[:i]}  # fmt: skip
    log_b = rng.normal(size=(int(rng.integers(s, 8)), s))
    log_b[rng.random(log_b.shape) < holes] = NEVER
    return Row(tuple(rng.integers(0, m, s).tolist()), jumps, log_b)


def paths(row: Row) -> Iterator[Path]:
    """Every way from the first place to the last, a place a frame."""

    def walk(path: Path) -> Iterator[Path]:
        if len(path) == len(row.log_b):
            if path[-1] == len(row.states) - 1:
                yield path
            return
        here = path[-1]
        onward = [here, here + 1, *(to for to, origin in row.jumps.items() if origin == here)]
        for place in onward:
            if place < len(row.states):
                yield from walk((*path, place))

    yield from walk((0,))


def log_probability(row: Row, path: Path, stay: Floats) -> float:
    """Of a path and the frames, by the definition; a jump is as likely as going on where it begins."""
    total = sum(row.log_b[t, place] for t, place in enumerate(path))
    forked = set(row.jumps.values())
    for here, there in zip(path, (*path[1:], len(row.states)), strict=True):
        p = stay[row.states[here]]
        total += np.log(p) if here == there else np.log((1 - p) / (2 if here in forked else 1))
    return float(total)


def enumerated(row: Row, stay: Floats) -> tuple[float, Floats, Floats, Path]:
    """Log likelihood, gamma, stays and the best path, by going through all paths."""
    gamma, stays = np.zeros(row.log_b.shape), np.zeros(len(row.states))
    total, best = NEVER, NEVER
    walked: Path = ()
    for path in paths(row):
        log_p = log_probability(row, path, stay)
        total = np.logaddexp(total, log_p)
        if log_p > best:
            best, walked = log_p, path
        gamma[np.arange(len(path)), path] += np.exp(log_p)
        for here, there in pairwise(path):
            stays[here] += np.exp(log_p) * (here == there)
    scale = np.exp(total) if np.isfinite(total) else 1.0
    return float(total), gamma / scale, stays / scale, walked


@pytest.mark.parametrize("holes", [0.0, 0.25])
@pytest.mark.parametrize("seed", range(25))
def test_all_is_as_all_paths_one_by_one_have_it(seed: int, holes: float) -> None:
    """Sentences of different lengths side by side, with jumps, repeated states and frames that may not be."""
    rng = np.random.default_rng(seed)
    stay = rng.uniform(0.1, 0.9, 4)
    rows = [drawn(rng, 4, holes) for _ in range(6)]
    chains, log_b = batch(rows, rng)
    of = arcs(chains, stay)
    found, walked = posterior(chains, of, log_b), best_path(chains, of, log_b)
    for i, row in enumerate(rows):
        (t, s), (total, gamma, stays, best) = row.log_b.shape, enumerated(row, stay)
        assert found.log_likelihood[i] == pytest.approx(total, abs=1e-9)
        np.testing.assert_allclose(found.gamma[i, :t, :s], gamma, atol=1e-9)
        np.testing.assert_allclose(found.stays[i, :s], stays, atol=1e-9)
        assert not found.gamma[i, t:].any()
        assert not found.gamma[i, :, s:].any()
        assert not found.stays[i, s:].any()
        assert walked[i, : len(best)].tolist() == list(best)
        assert (walked[i, len(best) :] == -1).all()


def test_some_of_those_have_jumps_and_some_no_path() -> None:
    """Lest the test above tell nothing."""
    rows = []
    for seed in range(25):
        rng = np.random.default_rng(seed)
        rng.uniform(0.1, 0.9, 4)
        rows += [drawn(rng, 4, 0.25) for _ in range(6)]
    assert sum(bool(row.jumps) for row in rows) > 30
    fits = [np.isfinite(enumerated(row, np.full(4, 0.5))[0]) for row in rows]
    assert 20 < sum(fits) < len(fits) - 20


def test_a_chain_that_no_path_fits_counts_for_nothing_and_harms_no_other() -> None:
    """More places than frames; and one whose last frame may be nowhere."""
    rng = np.random.default_rng(1)
    good = Row((0, 1), {}, rng.normal(size=(4, 2)))
    closed = Row((0, 1), {}, np.vstack([rng.normal(size=(2, 2)), [[NEVER, NEVER]]]))
    rows = [Row((0, 1, 2), {}, rng.normal(size=(2, 3))), good, closed]
    stay = np.array([0.3, 0.6, 0.5])
    chains, log_b = batch(rows, rng)
    found = posterior(chains, arcs(chains, stay), log_b)
    assert found.log_likelihood[[0, 2]].tolist() == [NEVER, NEVER]
    assert found.log_likelihood[1] == pytest.approx(enumerated(good, stay)[0])
    assert not found.gamma[[0, 2]].any()
    assert not found.stays[[0, 2]].any()
    walked = best_path(chains, arcs(chains, stay), log_b)
    assert (walked[[0, 2]] == -1).all()


@pytest.mark.parametrize("jumps", [{}, {2: 0}, {3: 0, 4: 2}])
def test_over_all_lengths_the_probabilities_sum_to_one(jumps: dict[int, int]) -> None:
    """Where every frame has density 1 they are how likely it is to leave after t frames."""
    rng, stay = np.random.default_rng(0), np.array([0.3, 0.7, 0.55])
    lengths = range(1, 150)
    rows = [Row((0, 1, 2, 0, 1), jumps, np.zeros((t, 5))) for t in lengths]
    chains, log_b = batch(rows, rng)
    found = posterior(chains, arcs(chains, stay), log_b)
    leaving = np.exp(found.log_likelihood)
    assert leaving.sum() == pytest.approx(1, abs=1e-9)
    if not jumps:
        expected = (1 / (1 - stay[[0, 1, 2, 0, 1]])).sum()
        assert (leaving * np.array(lengths)).sum() == pytest.approx(expected, rel=1e-9)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6))
def test_a_frame_is_somewhere_and_the_path_is_no_likelier_than_all(seed: int) -> None:
    rng = np.random.default_rng(seed)
    stay = rng.uniform(0.02, 0.98, 4)
    rows = [drawn(rng, 4) for _ in range(3)]
    chains, log_b = batch(rows, rng)
    of = arcs(chains, stay)
    found, walked = posterior(chains, of, 50 * log_b), best_path(chains, of, 50 * log_b)
    for i, row in enumerate(rows):
        if not np.isfinite(found.log_likelihood[i]):
            continue
        t = len(row.log_b)
        np.testing.assert_allclose(found.gamma[i, :t].sum(axis=1), 1, atol=1e-9)
        assert (found.stays[i] <= found.gamma[i].sum(axis=0) + 1e-9).all()
        scaled = Row(row.states, row.jumps, 50 * row.log_b)
        assert log_probability(scaled, tuple(walked[i, :t]), stay) <= found.log_likelihood[i] + 1e-9


def test_long_sentences_and_small_densities_neither_run_over_nor_under() -> None:
    rng, n = np.random.default_rng(2), 400
    rows = [Row(tuple(range(n // 4)), {}, rng.uniform(-5000, -1000, (n, n // 4)))]
    chains, log_b = batch(rows, rng)
    found = posterior(chains, arcs(chains, np.full(n, 0.98)), log_b)
    assert np.isfinite(found.log_likelihood).all()
    np.testing.assert_allclose(found.gamma.sum(axis=2), 1, atol=1e-6)


def test_one_frame_in_one_place() -> None:
    chains, log_b = batch([Row((0,), {}, np.array([[-2.0]]))], np.random.default_rng(0))
    found = posterior(chains, arcs(chains, np.array([0.25])), log_b)
    assert found.log_likelihood[0] == pytest.approx(np.log(0.75) - 2)
    assert (found.gamma.item(), found.stays.item()) == (1.0, 0.0)


def test_where_a_jump_begins_going_on_and_jumping_are_as_probable() -> None:
    chains = Chains(np.array([[0, 1, 2, -1]]), np.array([[-1, -1, 0, -1]]), np.array([[3, 5]]))
    of = arcs(chains, np.array([0.2, 0.4, 0.6]))
    assert isinstance(of, Arcs)
    np.testing.assert_allclose(np.exp(of.stay[0, :3]), [0.2, 0.4, 0.6])
    np.testing.assert_allclose(np.exp(of.leave[0, :3]), [0.4, 0.6, 0.4])
