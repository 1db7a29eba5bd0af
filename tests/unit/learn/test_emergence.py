"""When a consonant shows: k by the paper's formula, and the curve nearest to it."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.learn.emergence import AXIS, Emergence, measured, stylised
from fapstream.motion.ohman import emergence

CURVE = np.array([[0.4, 0.1, 0.14, 0.2], [0.6, 0.07, 0.07, 0.0]])
WEIGHT, TARGET = np.array([0.8, 0.5]), np.array([-2.0, 1.0])


def instances(n: int = 30, noise: float = 0.0) -> list[tuple[np.ndarray, np.ndarray, float, float]]:
    """A consonant of 100 ms between vowels of any height, as the formula has it."""
    rng = np.random.default_rng(0)
    found = []
    for _ in range(n):
        carrier = np.linspace(rng.normal(size=2), rng.normal(size=2), 80)
        k = emergence(np.arange(80) / 100, np.array([[0.35, 0.45]]), CURVE[None])[:, 0]
        moved = carrier + k * WEIGHT * (TARGET - carrier)
        found.append((carrier, moved + rng.normal(0, noise, moved.shape), 35.0, 45.0))
    return found


def test_k_is_measured_as_it_was_made() -> None:
    found = measured(instances(), WEIGHT, TARGET)
    wanted = emergence(AXIS, np.array([[-0.05, 0.05]]), CURVE[None])[:, 0]
    assert found.k == pytest.approx(wanted, abs=1e-6)
    assert found.length == pytest.approx(0.1)


@pytest.mark.parametrize("noise", [0.0, 0.2])
def test_the_curve_that_was_made_is_found(noise: float) -> None:
    found = stylised(measured(instances(60, noise), WEIGHT, TARGET))
    assert found.shape == (2, 4)
    made, wanted = (emergence(AXIS, np.array([[-0.05, 0.05]]), c[None])[:, 0] for c in (found, CURVE))
    assert np.abs(made - wanted).max() < (0.01 if not noise else 0.3)


def test_what_lies_beyond_a_sentence_does_not_count() -> None:
    carrier, moved, _, _ = instances(1)[0]
    found = measured([(carrier, moved, 0.0, 10.0)], WEIGHT, TARGET)
    assert not found.sure[: len(AXIS) // 2 - 5].any()
    assert np.isfinite(stylised(found)).all()


def test_a_consonant_that_was_never_said_has_some_curve() -> None:
    found = measured([], WEIGHT, TARGET)
    assert np.isfinite(found.k).all()
    assert stylised(found).shape == (2, 4)


def test_times_that_are_better_known_count_more() -> None:
    k = np.clip(1 - np.abs(AXIS) / 0.1, 0, 1)[:, None]
    wrong = k.copy()
    wrong[-8:] = 1.0
    sure = np.ones_like(k)
    sure[-8:] = 1e-9
    assert np.array_equal(stylised(Emergence(wrong, sure, 0.1)), stylised(Emergence(k, sure, 0.1)))
