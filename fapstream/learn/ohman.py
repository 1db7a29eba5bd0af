"""Fitting Ohman's coarticulation to people (mother-articulatory-head, section 5.1).

First as the paper has it: vowels' targets are what is measured in the middle of vowels; at the middle of each
consonant, where it is taken to show wholly, what is measured is regressed on the carrier, p* = a + b v, so
that w = 1 - b and c = a / w; then when consonants show is measured and stylised (emergence.py). The paper
does so where the same vowel stands on both sides; in running speech those are rare, and all contexts count.
Neighbouring consonants spoil each other's regressions, so all that was found is then fitted together, to
every frame, by gradient descent (L-BFGS) from there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit, logit

from fapstream.errors import ClipError
from fapstream.learn.emergence import measured, stylised
from fapstream.learn.hmm import Progress
from fapstream.learn.measured import RATE
from fapstream.learn.sentences import Sentence
from fapstream.motion.ohman import FALL, HOLD, PLACE, RISE, Ohman, interpolation, is_consonant, keys, soft
from fapstream.motion.units import TimedUnit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LEAST_WEIGHT = 0.1
"""A consonant that hardly shows has no target that could be told."""
FLANK_S = (0.02, 0.27)
MOST_HOLD = 0.5
FIRST_CURVE = (0.5, 0.09, 0.09, 0.13)
EVERY = 2
"""So many frames of a talk count as one: neighbours hardly differ."""
TICKS = 1_000_000
"""Times of units as whole numbers, a second."""


@dataclass(frozen=True, slots=True)
class OhmanRecipe:
    """`rounds`: how often consonants are put in order anew, and so many iterations after each. `pull`: how
    strongly numbers are drawn to where they began, as so many squared frames for each squared unit."""

    rounds: int = 2
    iterations: int = 40
    pull: float = 10.0


@dataclass(frozen=True, slots=True)
class _Talks:
    """Sentences side by side, padded: s of them, t frames, r consonants, m targets, n parameters.

    `carrier`: (s, t, m), how much of each target is in the carrier; `wanted`: (s, t, n); `counts`: (s, t, 1),
    1 for a frame and 0 for padding; `time`: (s, t), s; `kind`: (s, r), which consonant, -1 for none;
    `start`, `length`: (s, r), s.
    """

    carrier: Floats
    wanted: Floats
    counts: Floats
    time: Floats
    kind: Ints
    start: Floats
    length: Floats


class OhmanFit:
    """Fits `Ohman`. After `fit`: `model_`, and `error_`, the mean squared error of each round."""

    def __init__(self, recipe: OhmanRecipe | None = None, progress: Progress = lambda _: None) -> None:
        self.recipe = recipe or OhmanRecipe()
        self.progress = progress

    def fit(self, sentences: Sequence[Sentence]) -> OhmanFit:
        """Regressions, and then everything together. Raises ClipError."""
        if not sentences:
            raise ClipError("there are no sentences to learn from")
        self.progress("regressions")
        model = regressed(sentences)
        talks = _talks(sentences, model)
        first, self.error_ = _Numbers.of(model).flat(), []
        x = first
        for _ in range(self.recipe.rounds):
            self.progress("together")
            order = _order(talks, _Numbers.read(x, model).weight)
            found = minimize(
                _penalised, x, (talks, model, order, (first, self.recipe.pull)), jac=True, method="L-BFGS-B",
                options={"maxiter": self.recipe.iterations},
            )  # fmt: skip
            x = found.x
            error, _ = _squared_error(x, talks, model, order)
            self.error_.append(error / (talks.counts.sum() * model.values.shape[1]))
        self.model_ = _Numbers.read(x, model).model(model)
        return self


def regressed(sentences: Sequence[Sentence]) -> Ohman:
    """Targets of vowels from their middles, and of consonants by regression at theirs. Raises ClipError."""
    targets, values = _vowels(sentences)
    n = sentences[0].parameters.shape[1]
    consonants = sorted({u for s in sentences for u in s.units if is_consonant(u)})
    if not consonants:
        raise ClipError("no consonants are said that could be learned from")
    blank = Ohman(
        targets, values, tuple(consonants),
        np.zeros((len(consonants), n)), np.zeros((len(consonants), n)),
        np.tile(FIRST_CURVE, (len(consonants), n, 1)),
    )  # fmt: skip
    at: dict[str, list[tuple[Floats, Floats]]] = {name: [] for name in consonants}
    for sentence in sentences:
        carrier = _carrier(sentence, blank) @ values
        for unit, (begin, end) in zip(sentence.units, sentence.times, strict=True):
            if unit in at:
                frame = min(int((begin + end) / 2), len(carrier) - 1)
                at[unit].append((carrier[frame], sentence.parameters[frame]))
    rows = [_regression(np.array([v for v, _ in at[c]]), np.array([p for _, p in at[c]])) for c in consonants]
    model = replace(blank, weight=np.array([w for w, _ in rows]), target=np.array([c for _, c in rows]))
    return replace(model, curve=_curves(sentences, model))


def _curves(sentences: Sequence[Sentence], model: Ohman) -> Floats:
    """Of every consonant and parameter, as they are measured and stylised."""
    found: dict[str, list[tuple[Floats, Floats, float, float]]] = {name: [] for name in model.consonants}
    for sentence in sentences:
        carrier = _carrier(sentence, model) @ model.values
        for unit, (begin, end) in zip(sentence.units, sentence.times, strict=True):
            if unit in found:
                found[unit].append((carrier, sentence.parameters, float(begin), float(end)))
    rows = zip(model.consonants, model.weight, model.target, strict=True)
    return np.array([stylised(measured(found[name], weight, target)) for name, weight, target in rows])


def _regression(v: Floats, p: Floats) -> tuple[Floats, Floats]:
    """w and c of one consonant, from the carrier and what was measured, (instances, n)."""
    v0, p0 = v - v.mean(axis=0), p - p.mean(axis=0)
    b = (v0 * p0).sum(axis=0) / np.maximum((v0**2).sum(axis=0), 1e-9)
    weight = np.clip(1 - b, LEAST_WEIGHT, 1 - 1e-3)
    return weight, (p - (1 - weight) * v).mean(axis=0) / weight


def _vowels(sentences: Sequence[Sentence]) -> tuple[tuple[str, ...], Floats]:
    """The carrier's targets: the mean of what is measured where it is at each."""
    found: dict[str, list[Floats]] = {}
    for sentence in sentences:
        for time, name in _keys(sentence):
            frame = int(np.clip(round(time * RATE), 0, len(sentence.parameters) - 1))
            found.setdefault(name, []).append(sentence.parameters[frame])
    names = tuple(sorted(found))
    return names, np.array([np.mean(found[name], axis=0) for name in names])


def _keys(sentence: Sentence) -> list[tuple[float, str]]:
    """Where the carrier is in a sentence, s from its first frame."""
    last = len(sentence.units) - 1
    places = []
    for i, (unit, (begin, end)) in enumerate(zip(sentence.units, sentence.seconds(), strict=True)):
        timed = TimedUnit(unit, round(begin * TICKS), round(end * TICKS))
        places += keys(timed, TICKS, i < last)
    return places


def _carrier(sentence: Sentence, model: Ohman) -> Floats:
    """How much of each target is in each frame, shape (t, targets)."""
    places = _keys(sentence)
    t = np.arange(len(sentence.parameters)) / RATE
    each = interpolation(np.array([time for time, _ in places]), t)
    row = {name: i for i, name in enumerate(model.targets)}
    found = np.zeros((len(t), len(row)))
    for column, (_, name) in enumerate(places):
        found[:, row[name]] += each[:, column]
    return found


def _talks(sentences: Sequence[Sentence], model: Ohman) -> _Talks:
    row = {name: i for i, name in enumerate(model.consonants)}
    s, t = len(sentences), max(len(x.parameters[::EVERY]) for x in sentences)
    r = max(sum(u in row for u in x.units) for x in sentences)
    n = sentences[0].parameters.shape[1]
    talks = _Talks(
        np.zeros((s, t, len(model.targets))), np.zeros((s, t, n)), np.zeros((s, t, 1)),
        np.tile(np.arange(t) * EVERY / RATE, (s, 1)),
        np.full((s, r), -1), np.zeros((s, r)), np.full((s, r), 0.1),
    )  # fmt: skip
    for i, sentence in enumerate(sentences):
        frames = len(sentence.parameters[::EVERY])
        talks.carrier[i, :frames] = _carrier(sentence, model)[::EVERY]
        talks.wanted[i, :frames] = sentence.parameters[::EVERY]
        talks.counts[i, :frames] = 1.0
        mine = [j for j, unit in enumerate(sentence.units) if unit in row]
        times = sentence.seconds()[mine]
        talks.kind[i, : len(mine)] = [row[sentence.units[j]] for j in mine]
        talks.start[i, : len(mine)] = times[:, 0]
        talks.length[i, : len(mine)] = times[:, 1] - times[:, 0]
    return talks


@dataclass(frozen=True, slots=True)
class _Numbers:
    """What is fitted: `values` (m, n), `target` (c, n), and what lies between bounds, as the model has it."""

    values: Floats
    target: Floats
    weight: Floats
    curve: Floats

    @classmethod
    def of(cls, model: Ohman) -> _Numbers:
        return cls(model.values, model.target, model.weight, model.curve)

    def model(self, like: Ohman) -> Ohman:
        return replace(like, values=self.values, target=self.target, weight=self.weight, curve=self.curve)

    def flat(self) -> Floats:
        """Free numbers in one row: bounded ones as the logit of where they are between their bounds."""
        low, wide = _BOUNDS
        bounded = np.concatenate([self.weight[..., None], self.curve], axis=-1)
        inside = np.clip((bounded - low) / wide, 1e-3, 1 - 1e-3)
        return np.concatenate([self.values.ravel(), self.target.ravel(), logit(inside).ravel()])

    @classmethod
    def read(cls, x: Floats, like: Ohman) -> _Numbers:
        """Back from such a row."""
        m, c = like.values.size, like.target.size
        low, wide = _BOUNDS
        bounded = low + wide * expit(x[m + c :].reshape(*like.target.shape, 5))
        target = x[m : m + c].reshape(like.target.shape)
        return cls(x[:m].reshape(like.values.shape), target, bounded[..., 0], bounded[..., 1:])


_BOUNDS = (
    np.array([0.0, 0.0, FLANK_S[0], FLANK_S[0], 0.0]),
    np.array([1.0, 1.0, FLANK_S[1], FLANK_S[1], MOST_HOLD]),
)
"""Least, and how much more at most: weight, and the columns of a curve."""


def _order(talks: _Talks, weight: Floats) -> Ints:
    """Which consonant of a sentence comes when, by increasing weight, shape (s, r, n); -1 for none."""
    there = (talks.kind >= 0)[..., None]
    each = np.where(there, weight[np.maximum(talks.kind, 0)], np.inf)
    order = np.argsort(each, axis=1, kind="stable")
    return np.where(np.take_along_axis(np.broadcast_to(there, each.shape), order, axis=1), order, -1)


def _penalised(
    x: Floats, talks: _Talks, model: Ohman, order: Ints, begun: tuple[Floats, float]
) -> tuple[float, Floats]:
    error, gradient = _squared_error(x, talks, model, order)
    moved, pull = x - begun[0], begun[1]
    return error + pull * float(moved @ moved), gradient + 2 * pull * moved


@dataclass(frozen=True, slots=True)
class _Step:
    """One consonant of each sentence and parameter, taken: what it was taken upon, and its parts."""

    kind: Ints
    there: NDArray[np.bool_]
    upon: Floats
    up: Floats
    down: Floats
    numbers: tuple[Floats, Floats, Floats]
    """Weight, target, curve, shape (s, n) or (s, n, 4)."""
    length: Floats


def _squared_error(x: Floats, talks: _Talks, model: Ohman, order: Ints) -> tuple[float, Floats]:
    """Over all frames, and its gradient, by going back through the consonants."""
    numbers = _Numbers.read(x, model)
    p = talks.carrier @ numbers.values
    steps = []
    for rank in range(order.shape[1]):
        step = _step(talks, numbers, order[:, rank], p)
        shown = soft(step.up) * soft(step.down) * (step.numbers[0] * step.there)[:, None]
        p = p + shown * (step.numbers[1][:, None] - p)
        steps.append((step, shown))
    wrong = (p - talks.wanted) * talks.counts
    back = 2 * wrong
    target, bounded = np.zeros_like(numbers.target), np.zeros((*numbers.target.shape, 5))
    for step, shown in reversed(steps):
        _add(step, (target, bounded), back, shown)
        back = back * (1 - shown)
    values = np.einsum("stm,stn->mn", talks.carrier, back, optimize=True)
    low, wide = _BOUNDS
    inside = (np.concatenate([numbers.weight[..., None], numbers.curve], axis=-1) - low) / wide
    bounded *= wide * inside * (1 - inside)
    return float((wrong**2).sum()), np.concatenate([values.ravel(), target.ravel(), bounded.ravel()])


def _step(talks: _Talks, numbers: _Numbers, which: Ints, upon: Floats) -> _Step:
    there = which >= 0
    sentence, parameter = np.arange(len(which))[:, None], np.arange(which.shape[1])
    at = np.maximum(which, 0)
    kind = np.maximum(talks.kind[sentence, at], 0)
    start, length = talks.start[sentence, at], talks.length[sentence, at]
    curve = numbers.curve[kind, parameter]
    since = talks.time[..., None] - (start + curve[..., PLACE] * length)[:, None]
    hold = (curve[..., HOLD] * length)[:, None]
    rise, fall = curve[:, None, :, RISE], curve[:, None, :, FALL]
    up, down = (since + hold + rise) / rise, (fall + hold - since) / fall
    taken = numbers.weight[kind, parameter], numbers.target[kind, parameter], curve
    return _Step(kind, there, upon, up, down, taken, length)


def _add(step: _Step, into: tuple[Floats, Floats], back: Floats, shown: Floats) -> None:
    """What one step adds to the gradients of targets, and of weights and curves."""
    weight, target, curve = step.numbers
    rows = (step.kind, np.broadcast_to(np.arange(step.kind.shape[1]), step.kind.shape))
    down, up = soft(step.down), soft(step.up)
    of_shown = back * (target[:, None] - step.upon) * step.there[:, None]
    of_up = of_shown * weight[:, None] * down * _slope(step.up)
    of_down = of_shown * weight[:, None] * up * _slope(step.down)
    rise, fall = curve[:, None, :, RISE], curve[:, None, :, FALL]
    by_rise, by_fall = (of_up / rise).sum(axis=1), (of_down / fall).sum(axis=1)
    np.add.at(into[0], rows, (back * shown).sum(axis=1))
    gradient = np.empty((*step.kind.shape, 5))
    gradient[..., 0] = (of_shown * up * down).sum(axis=1)
    gradient[..., 1 + PLACE] = (by_fall - by_rise) * step.length
    gradient[..., 1 + RISE] = (of_up * (1 - step.up) / rise).sum(axis=1)
    gradient[..., 1 + FALL] = (of_down * (1 - step.down) / fall).sum(axis=1)
    gradient[..., 1 + HOLD] = (by_fall + by_rise) * step.length
    np.add.at(into[1], rows, gradient)


def _slope(x: Floats) -> Floats:
    """Of `soft`."""
    inside = np.clip(x, 0.0, 1.0)
    return 6 * inside * (1 - inside)
