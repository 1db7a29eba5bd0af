"""Fitting carriers and consonants: derivatives by differences, and models that talks were made with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from fapstream.errors import ClipError
from fapstream.learn.measured import RATE
from fapstream.learn.ohman import (
    EVERY,
    FIRST_CURVE,
    FLANK_S,
    LEAST_WEIGHT,
    MOST_HOLD,
    TICKS,
    OhmanFit,
    OhmanRecipe,
    _Numbers,
    _order,
    _penalised,
    _regression,
    _squared_error,
    _talks,
    regressed,
)
from fapstream.learn.sentences import Sentence
from fapstream.motion.ohman import READY, Ohman, emerged, emergence, interpolation, is_consonant, keys
from fapstream.motion.units import SIL, TimedUnit

Floats = NDArray[np.float64]
VOWELS, CONSONANTS = ("AA1", "IY1", "UW1"), ("P", "S", "W")
N = 2


def model(seed: int) -> Ohman:
    """Of a few vowels, one of which is a diphthong, and consonants of all weights."""
    rng = np.random.default_rng(seed)
    targets = (*sorted((*VOWELS, "EY1:1", "EY1:2", SIL, READY)),)
    curve = np.stack([rng.uniform(0.3, 0.7, (3, N)), rng.uniform(0.05, 0.15, (3, N)),
                      rng.uniform(0.05, 0.15, (3, N)), rng.uniform(0.05, 0.3, (3, N))], axis=-1)  # fmt: skip
    return Ohman(
        targets, rng.normal(size=(len(targets), N)), CONSONANTS,
        rng.uniform(0.3, 0.9, (3, N)), 2 * rng.normal(size=(3, N)), curve,
    )  # fmt: skip


def said(units: Sequence[str], lengths: Sequence[float] | Floats, of: Ohman | None = None) -> Sentence:
    """A talk of units of so many frames, as a model moves it: straight from the paper's formula."""
    edges = np.concatenate([[0.0], np.cumsum(lengths)])
    times = np.stack([edges[:-1], edges[1:]], axis=1)
    parameters = np.zeros((round(edges[-1]), N))
    if of is not None:
        t = np.arange(len(parameters)) / RATE
        places = []
        for i, (unit, (begin, end)) in enumerate(zip(units, times / RATE, strict=True)):
            timed = TimedUnit(unit, round(begin * TICKS), round(end * TICKS))
            places += keys(timed, TICKS, i + 1 < len(units))
        values = of.values[[of.targets.index(name) for _, name in places]]
        parameters = interpolation(np.array([time for time, _ in places]), t) @ values
        heard = [i for i, unit in enumerate(units) if is_consonant(unit)]
        rows = [of.consonants.index(units[i]) for i in heard]
        shown = emergence(t, times[heard] / RATE, of.curve[rows]) * of.weight[rows]
        for k in range(N):
            order = np.argsort(of.weight[rows, k], kind="stable")
            target = of.target[rows, k][order]
            parameters[:, k] = emerged(parameters[:, k : k + 1], shown[:, order, k : k + 1], target[:, None])[
                :, 0
            ]
    return Sentence("talk", parameters, tuple(units), times, (False,) * len(units))


def talks(seed: int, n: int, of: Ohman | None, longest: float = 18.0) -> list[Sentence]:
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(n):
        units = [SIL]
        for _ in range(int(rng.integers(3, 6))):
            units += [str(rng.choice(CONSONANTS)), str(rng.choice([*VOWELS, "EY1"]))]
            units += [str(rng.choice(CONSONANTS))] * (rng.random() < 0.3)
        units.append(SIL)
        lengths = rng.uniform(6, longest, len(units))
        lengths[[0, -1]] = rng.uniform(25, 60, 2)
        found.append(said(units, lengths, of))
    return found


def noisy(of: Sequence[Sentence], size: float, seed: int = 0) -> list[Sentence]:
    rng = np.random.default_rng(seed)
    return [replace(s, parameters=s.parameters + size * rng.normal(size=s.parameters.shape)) for s in of]


@pytest.mark.parametrize("seed", range(4))
def test_the_gradient_is_that_of_differences(seed: int) -> None:
    """Of every free number: values, targets, and weights and curves between their bounds."""
    rng, like = np.random.default_rng(seed), model(seed)
    given_ = noisy(talks(seed, 3, like), 0.5)
    side_by_side = _talks(given_, like)
    order = _order(side_by_side, like.weight)
    x = _Numbers.of(like).flat() + 0.3 * rng.normal(size=_Numbers.of(like).flat().shape)
    _, gradient = _squared_error(x, side_by_side, like, order)
    step, numeric = 1e-5, np.empty_like(x)
    for i in range(len(x)):
        ahead, behind = (
            _squared_error(x + way * step * np.eye(len(x))[i], side_by_side, like, order)[0]
            for way in (1, -1)
        )
        numeric[i] = (ahead - behind) / (2 * step)
    np.testing.assert_allclose(gradient, numeric, rtol=1e-4, atol=1e-4)
    begun = (np.zeros_like(x), 3.0)
    error, pulled = _penalised(x, side_by_side, like, order, begun)
    assert error == pytest.approx(_squared_error(x, side_by_side, like, order)[0] + 3 * (x**2).sum())
    np.testing.assert_allclose(pulled, gradient + 6 * x)


@pytest.mark.parametrize("seed", range(4))
def test_a_model_fits_the_talks_that_it_makes(seed: int) -> None:
    """Of any lengths side by side, to the last frame; and any other fits worse."""
    like = model(seed)
    side_by_side = _talks(talks(seed, 4, like), like)
    x, order = _Numbers.of(like).flat(), _order(side_by_side, like.weight)
    assert _squared_error(x, side_by_side, like, order)[0] < 1e-8
    assert _squared_error(x + 0.1, side_by_side, like, order)[0] > 1e-2


def test_talks_stand_side_by_side_padded() -> None:
    like = model(0)
    of = talks(0, 3, like)
    found = _talks(of, like)
    for i, talk in enumerate(of):
        frames = talk.parameters[::EVERY]
        np.testing.assert_array_equal(found.wanted[i, : len(frames)], frames)
        assert found.counts[i].sum() == len(frames)
        np.testing.assert_allclose(found.carrier[i, : len(frames)].sum(axis=1), 1)
        heard = [j for j, unit in enumerate(talk.units) if unit in CONSONANTS]
        kinds = found.kind[i][found.kind[i] >= 0]
        assert [like.consonants[k] for k in kinds] == [talk.units[j] for j in heard]
        np.testing.assert_allclose(found.start[i, : len(heard)], talk.seconds()[heard, 0])
        np.testing.assert_allclose(found.length[i, : len(heard)], np.diff(talk.seconds()[heard])[:, 0])


def test_consonants_come_by_increasing_weight_and_those_that_are_not_there_last() -> None:
    like = replace(model(0), weight=np.array([[0.9, 0.1], [0.5, 0.5], [0.2, 0.8]]))
    of = [said(["P", "AA1", "S", "W"], [10] * 4), said(["S", "AA1", "S", "IY1", "P", "W", "W"], [10] * 7)]
    order = _order(_talks(of, like), like.weight)
    assert order[0, :, 0].tolist() == [2, 1, 0, -1, -1]
    assert order[0, :, 1].tolist() == [0, 1, 2, -1, -1]
    assert order[1, :, 0].tolist() == [3, 4, 0, 1, 2]


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6))
def test_numbers_survive_being_made_free(seed: int) -> None:
    like = model(seed)
    found = _Numbers.read(_Numbers.of(like).flat(), like).model(like)
    for name in ("values", "target", "weight", "curve"):
        np.testing.assert_allclose(getattr(found, name), getattr(like, name), atol=1e-9)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6))
def test_free_numbers_stay_within_their_bounds(seed: int) -> None:
    like = model(0)
    x = _Numbers.of(like).flat()
    found = _Numbers.read(np.random.default_rng(seed).normal(0, 30, x.shape), like)
    assert ((found.weight >= 0) & (found.weight <= 1)).all()
    place, rise, fall, hold = np.moveaxis(found.curve, -1, 0)
    assert ((place >= 0) & (place <= 1) & (hold >= 0) & (hold <= MOST_HOLD)).all()
    for flank in (rise, fall):
        assert ((flank >= FLANK_S[0]) & (flank <= sum(FLANK_S))).all()
    edge = replace(like, weight=np.array([[0.0, 1.0]] * 3))
    assert np.isfinite(_Numbers.of(edge).flat()).all()


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.floats(LEAST_WEIGHT, 0.99))
def test_a_regression_of_noise_free_middles_is_exact(seed: int, weight: float) -> None:
    """p* = (1 - w) v + w c."""
    rng = np.random.default_rng(seed)
    v, c = rng.normal(size=(6, N)), rng.normal(size=N)
    w, found = _regression(v, (1 - weight) * v + weight * c)
    np.testing.assert_allclose(w, weight, atol=1e-6)
    np.testing.assert_allclose(found, c, atol=1e-6)


def test_a_regression_that_tells_nothing_is_kept_within_bounds() -> None:
    """One instance or one vowel: the consonant is where it was. One that follows its vowels more than wholly,
    or runs against them: as little or as much as may be, and right on the mean."""
    v = np.array([[0.5, 0.5]])
    w, c = _regression(v, np.array([[3.0, -1.0]]))
    np.testing.assert_allclose(w, 0.999)
    np.testing.assert_allclose(c, [3.0, -1.0], atol=0.01)
    w, c = _regression(np.tile(v, (4, 1)), np.array([[3.0, -1], [4, -1], [3, 0], [4, 0]]))
    np.testing.assert_allclose(w, 0.999)
    np.testing.assert_allclose(c, [3.5, -0.5], atol=0.01)
    v = np.array([[-1.0, -1], [1, 1]])
    p = v * np.array([2.0, -2.0]) + 5
    w, c = _regression(v, p)
    np.testing.assert_allclose(w, [LEAST_WEIGHT, 0.999])
    np.testing.assert_allclose(w * c, p.mean(axis=0))


def test_weights_and_targets_of_long_vcv_are_those_that_were_planted() -> None:
    """Vowels long enough to be at their targets, consonants wholly there in their middle; the paper's own way
    finds the truth before anything is fitted together."""
    truth = replace(model(1), curve=np.tile(FIRST_CURVE, (3, N, 1)))
    contexts = [(a, c, b) for a in VOWELS for c in CONSONANTS for b in VOWELS]
    found = regressed([said([SIL, a, c, b, SIL], [60, 60, 20, 60, 60], truth) for a, c, b in contexts])
    assert found.consonants == CONSONANTS
    assert found.targets == tuple(t for t in truth.targets if not t.startswith("EY1"))
    kept = [truth.targets.index(t) for t in found.targets]
    np.testing.assert_allclose(found.values, truth.values[kept], atol=1e-6)
    np.testing.assert_allclose(found.weight, truth.weight, atol=1e-3)
    np.testing.assert_allclose(found.target, truth.target, atol=5e-3)
    np.testing.assert_allclose(found.curve, truth.curve, atol=0.05)


def test_a_planted_model_is_recovered_from_running_speech() -> None:
    """New talks that it makes are as the truth makes them, and far better than by regressions alone."""
    truth = model(2)
    given_, new = noisy(talks(3, 40, truth), 0.05), talks(4, 10, truth)
    fit = OhmanFit(OhmanRecipe(rounds=3, iterations=60, pull=0.1)).fit(given_)
    variance = np.concatenate([s.parameters for s in new]).var()

    def error(of: Ohman) -> float:
        made = [said(s.units, np.diff(s.times)[:, 0], of).parameters for s in new]
        wrong = np.concatenate(made) - np.concatenate([s.parameters for s in new])
        return float((wrong**2).mean() / variance)

    assert error(truth) == 0
    assert error(fit.model_) < 0.02
    assert error(fit.model_) < 0.2 * error(regressed(given_))
    assert np.abs(fit.model_.weight - truth.weight).mean() < 0.15
    assert len(fit.error_) == 3
    assert fit.error_[-1] < 1.001 * fit.error_[0]
    assert fit.error_[-1] < 0.02 * variance


def test_the_error_is_the_mean_square_of_what_is_wrong() -> None:
    """Not of what the numbers are pulled by; consonants may have changed places since."""
    given_ = noisy(talks(5, 6, model(5)), 0.3)
    fit = OhmanFit(OhmanRecipe(rounds=1, iterations=5, pull=50.0)).fit(given_)
    wrong = [
        (said(s.units, np.diff(s.times)[:, 0], fit.model_).parameters - s.parameters)[::EVERY] for s in given_
    ]
    assert fit.error_[-1] == pytest.approx((np.concatenate(wrong) ** 2).mean(), rel=0.005)


def test_a_strong_pull_leaves_numbers_where_they_began() -> None:
    given_ = noisy(talks(6, 6, model(6)), 0.3)
    first = regressed(given_)
    found = [OhmanFit(OhmanRecipe(pull=pull)).fit(given_).model_ for pull in (1e9, 0.1)]
    moved = [np.abs(model_.values - first.values).max() for model_ in found]
    assert moved[0] < 1e-3
    assert moved[1] > 1e-2


def test_it_is_the_same_every_time_and_progress_is_told() -> None:
    given_, told = noisy(talks(7, 6, model(7)), 0.1), list[str]()
    recipe = OhmanRecipe(iterations=5)
    one, other = (OhmanFit(recipe, told.append).fit(given_).model_ for _ in range(2))
    for name in ("values", "target", "weight", "curve"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert told == 2 * ["regressions", "together", "together"]


def test_nothing_to_learn_from_is_said() -> None:
    with pytest.raises(ClipError, match="no sentences"):
        OhmanFit().fit([])
    vowels = said([SIL, "AA1", SIL], [30, 30, 30], model(1))
    with pytest.raises(ClipError, match="no consonants"):
        OhmanFit().fit([vowels])
