"""Fitting coarticulation: gradients, planted numbers, and a regression with a known answer."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.errors import ClipError
from fapstream.learn.measured import RATE
from fapstream.learn.ohman import (
    FIRST_CURVE,
    LEAST_WEIGHT,
    OhmanFit,
    OhmanRecipe,
    _carrier,
    _Numbers,
    _order,
    _regression,
    _squared_error,
    _talks,
    regressed,
)
from fapstream.learn.sentences import Sentence
from fapstream.motion.ohman import Ohman, emerged, emergence
from fapstream.motion.units import SIL

VOWELS, CONSONANTS = ("AA1", "IY1", "UW1"), ("B", "T", "W")
TARGETS = (*VOWELS, SIL, "ready")
PLANTED = Ohman(
    TARGETS,
    np.array([[2.0, 0.0], [-1.0, 1.5], [-0.5, -2.0], [0.0, 0.0], [0.2, 0.1]]),
    CONSONANTS,
    np.array([[0.9, 0.4], [0.5, 0.3], [0.4, 0.9]]),
    np.array([[-2.0, 0.5], [0.3, 0.8], [-0.5, -2.5]]),
    np.tile((0.5, 0.09, 0.1, 0.2), (3, 2, 1)),
)


def talk(seed: int, noise: float = 0.0) -> Sentence:
    """Vowels and consonants by turns, as the planted model moves."""
    rng = np.random.default_rng(seed)
    units, times, at = [SIL], [(0.0, 40.0)], 40.0
    for k in range(8):
        units.append(str(rng.choice(VOWELS if k % 2 else CONSONANTS)))
        length = float(rng.uniform(12, 20) if k % 2 else rng.uniform(7, 11))
        times.append((at, at + length))
        at += length
    units.append(SIL)
    times.append((at, at + 40))
    n = int(at + 40)
    sentence = Sentence("s", np.zeros((n, 2)), tuple(units), np.array(times), (False,) * len(units))
    return Sentence("s", moved(sentence, PLANTED) + rng.normal(0, noise, (n, 2)), *_rest(sentence))


def _rest(s: Sentence) -> tuple[tuple[str, ...], np.ndarray, tuple[bool, ...]]:
    return s.units, s.times, s.optional


def moved(sentence: Sentence, model: Ohman) -> np.ndarray:
    """A sentence as a model has it, by the formula."""
    carrier = _carrier(sentence, model) @ model.values
    t = np.arange(len(carrier)) / RATE
    found = [i for i, u in enumerate(sentence.units) if u in model.consonants]
    rows = [model.consonants.index(sentence.units[i]) for i in found]
    weight = model.weight[rows]
    shown = emergence(t, sentence.seconds()[found], model.curve[rows]) * weight
    order = np.argsort(weight, axis=0, kind="stable")
    target = np.take_along_axis(model.target[rows], order, axis=0)
    return emerged(carrier, np.take_along_axis(shown, order[None], axis=1), target)


TALKS = [talk(k) for k in range(30)]


def test_the_gradient_is_that_of_the_error() -> None:
    model = regressed(TALKS[:6])
    talks = _talks(TALKS[:6], model)
    x, order = _Numbers.of(model).flat(), _order(talks, model.weight)
    _, gradient = _squared_error(x, talks, model, order)
    rng = np.random.default_rng(0)
    for _ in range(4):
        way = rng.normal(size=x.size)
        up, down = (_squared_error(x + h * way, talks, model, order)[0] for h in (1e-5, -1e-5))
        assert (up - down) / 2e-5 == pytest.approx(gradient @ way, rel=1e-4)


def test_the_error_is_that_of_the_formula() -> None:
    model = PLANTED
    talks = _talks(TALKS[:3], model)
    x = _Numbers.of(model).flat()
    assert _squared_error(x, talks, model, _order(talks, model.weight))[0] == pytest.approx(0, abs=1e-9)


def test_planted_coarticulation_is_found_again() -> None:
    """Not each number, for they may stand in for each other, but what they do, also in unknown sentences."""
    fit = OhmanFit(OhmanRecipe(rounds=3, iterations=80, pull=1e-3)).fit(TALKS)
    assert fit.error_[-1] < 0.01 < fit.error_[0] * 1e6
    for k in range(100, 104):
        other = talk(k)
        inside = slice(35, -35)
        error = (moved(other, fit.model_) - other.parameters)[inside]
        assert np.sqrt((error**2).mean()) < 0.2 * other.parameters[inside].std()


def test_regression_gives_w_and_c_where_the_answer_is_known() -> None:
    """p* = a + b v with w = 1 - b and c = a / w: a closure that takes 0.8, at -2."""
    v = np.random.default_rng(1).normal(size=(50, 1))
    weight, target = _regression(v, v + 0.8 * (-2.0 - v))
    assert weight == pytest.approx([0.8])
    assert target == pytest.approx([-2.0])


def test_a_consonant_that_shows_nothing_has_a_bounded_target() -> None:
    v = np.random.default_rng(1).normal(size=(50, 1))
    weight, target = _regression(v, v.copy())
    assert weight == LEAST_WEIGHT
    assert np.abs(target).max() < 2
    weight, target = _regression(np.zeros((3, 1)), np.ones((3, 1)))
    assert np.isfinite([weight, target]).all()


def test_numbers_come_back_from_one_row() -> None:
    back = _Numbers.read(_Numbers.of(PLANTED).flat(), PLANTED)
    assert back.values == pytest.approx(PLANTED.values)
    assert back.weight == pytest.approx(PLANTED.weight, abs=1e-6)
    assert back.curve == pytest.approx(PLANTED.curve, abs=1e-6)


def test_consonants_are_taken_by_increasing_weight() -> None:
    talks = _talks(TALKS[:1], PLANTED)
    order = _order(talks, PLANTED.weight)[0]
    for parameter in range(2):
        weights = [PLANTED.weight[talks.kind[0, i], parameter] for i in order[:, parameter] if i >= 0]
        assert weights == sorted(weights)


def test_it_begins_with_regressions() -> None:
    model = regressed(TALKS)
    assert model.consonants == tuple(sorted(CONSONANTS))
    assert set(model.targets) == set(TARGETS)
    assert not np.allclose(model.curve, FIRST_CURVE)
    assert model.values[model.targets.index("AA1"), 0] > 0.5
    with pytest.raises(ClipError):
        OhmanFit().fit([])
