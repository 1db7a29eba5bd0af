"""Appendix B's trajectories: against the functional itself, and windows against one solution for all."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from fapstream.motion.spline import (
    AFTER,
    AT_ONCE,
    BEFORE,
    STEP_S,
    UNSEEN,
    Segments,
    Smoothness,
    observed,
    smooth,
    windowed,
)

HOW = Smoothness(0.08, 1.0)


def talk(seed: int, n: int = 300) -> tuple[np.ndarray, np.ndarray]:
    """Means that change from state to state, every 40 to 80 ms, without order, and precisions."""
    rng = np.random.default_rng(seed)
    state = np.repeat(np.arange(n), rng.integers(2, 5, n))[:n]
    return rng.normal(size=(n, 6))[state], rng.uniform(2, 40, (n, 6))[state]


def test_it_minimises_the_functional() -> None:
    """sum (a - mu)^2 / sigma^2 + lambda |a|_K^2, where |a|_K^2 = a K^-1 a at the instants."""
    mean, precision = talk(1, 12)
    t = np.arange(12) * STEP_S
    how = Smoothness(0.03, 0.7)
    kernel = np.exp(-0.5 * ((t[:, None] - t) / how.width_s) ** 2)
    inverse = np.linalg.inv(kernel)

    def functional(a: np.ndarray) -> float:
        return float((precision[:, 0] * (a - mean[:, 0]) ** 2).sum() + how.weight * a @ inverse @ a)

    found = smooth(mean, precision, how)[:, 0]
    best = minimize(functional, np.zeros(12), method="BFGS").x
    assert found == pytest.approx(best, abs=1e-4)
    assert functional(found) <= functional(best) + 1e-9


def test_it_is_the_dense_solution_of_the_paper() -> None:
    mean, precision = talk(2, 80)
    t = np.arange(80) * STEP_S
    kernel = np.exp(-0.5 * ((t[:, None] - t) / HOW.width_s) ** 2)
    for k in range(6):
        b = np.linalg.solve(kernel + HOW.weight * np.diag(1 / precision[:, k]), mean[:, k])
        assert smooth(mean, precision, HOW)[:, k] == pytest.approx(kernel @ b, abs=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_windows_agree_with_one_solution_for_all(seed: int) -> None:
    """Rougher here than anything that is learned; for that see test_hmm."""
    mean, precision = talk(seed)
    whole = smooth(mean, precision, HOW)
    starts = np.arange(BEFORE, len(mean) - AT_ONCE - AFTER, AT_ONCE)
    pieces = np.stack([starts, np.full_like(starts, len(mean))], axis=1)
    rows = windowed((mean, precision), pieces, HOW).reshape(-1, 6)
    error = rows - whole[BEFORE : BEFORE + len(rows)]
    assert np.sqrt((error**2).mean()) < 0.08
    assert np.abs(error).max() < 1.0


def test_a_window_does_not_see_what_lies_beyond_its_end() -> None:
    mean, precision = talk(5)
    other = mean.copy()
    other[60:] += 100.0
    pieces = np.array([[52, 60]])
    seen = windowed((mean, precision), pieces, HOW)
    assert np.array_equal(seen, windowed((other, precision), pieces, HOW))
    assert not np.allclose(seen, windowed((other, precision), np.array([[52, 62]]), HOW))


def test_states_share_an_instant_by_how_much_of_it_they_take() -> None:
    """Instant 1 stands for 10 to 30 ms: half of it the first state's, half the second's, a frame each."""
    segments = Segments(
        np.array([0.0, 0.02]), np.array([0.02, 0.05]), np.array([[1.0], [3.0]]), np.array([[5.0], [3.0]])
    )
    mean, precision = observed(segments, 0, 4)
    assert precision[:, 0] == pytest.approx([1.0, 4.0, 6.0, UNSEEN])
    assert mean[:, 0] == pytest.approx([5.0, 8 / 4, 1.0, 0.0])


def test_more_weight_is_smoother_and_nearer_to_the_mean() -> None:
    mean, precision = talk(6, 100)
    rough = [
        np.abs(np.diff(smooth(mean, precision, Smoothness(0.08, w)), 2, axis=0)).mean() for w in (0.1, 1, 10)
    ]
    assert rough == sorted(rough, reverse=True)
    assert np.abs(smooth(mean, precision, Smoothness(0.08, 1e9))).max() < 1e-3
