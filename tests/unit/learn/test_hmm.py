"""Training: likelihood never falls, what was planted is found, silences are found where there are some."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from fapstream.errors import ClipError
from fapstream.learn.hmm import HmmTrainer, Recipe, flat_start
from fapstream.learn.sentences import Sentence
from fapstream.motion.questions import Context
from fapstream.motion.units import SIL

TARGETS = {"B": (-2.0, 0.0), "IY1": (1.0, 2.0), "AA1": (3.0, -1.0), "T": (0.0, 1.0), SIL: (0.0, 0.0)}
QUICK = Recipe(min_frames=20, min_gain=10)


def talk(seed: int, pause: bool = False) -> Sentence:
    """A sentence whose units are at their targets, with noise; after the second phone there may be a
    pause."""
    rng = np.random.default_rng(seed)
    said = [SIL, *rng.permutation(["B", "IY1", "T", "AA1"]).tolist(), SIL]
    lengths = [15, *rng.integers(8, 14, 4).tolist(), 15]
    units, rows, times, optional, at = [], [], [], [], 0
    for k, (unit, n) in enumerate(zip(said, lengths, strict=True)):
        if k == 3:
            units.append(SIL)
            times.append((at, at + (18 if pause else 0)))
            optional.append(True)
            if pause:
                rows.append(rng.normal(TARGETS[SIL], 0.2, (18, 2)))
                at += 18
        rows.append(rng.normal(TARGETS[unit], 0.2, (n, 2)))
        units.append(unit)
        times.append((at, at + n))
        optional.append(False)
        at += n
    return Sentence(f"s{seed}", np.concatenate(rows), tuple(units), np.array(times, float), tuple(optional))


TALKS = [talk(k, pause=k % 3 == 0) for k in range(40)]


@pytest.fixture(scope="module")
def trained() -> HmmTrainer:
    return HmmTrainer(QUICK).fit(TALKS)


def test_no_iteration_makes_the_sound_less_likely(trained: HmmTrainer) -> None:
    assert set(trained.log_likelihood_) == {"flat", "realigned", "cloned", "tied"}
    for step, values in trained.log_likelihood_.items():
        assert len(values) == getattr(QUICK, step)
        assert all(b >= a - 1e-9 for a, b in pairwise(values)), step


def test_what_was_planted_is_found(trained: HmmTrainer) -> None:
    model = trained.model_
    for unit in ("B", "IY1", "AA1", "T"):
        states = model.states(Context(SIL, unit, "T" if unit != "T" else "B"))
        assert model.mean[states] == pytest.approx(np.tile(TARGETS[unit], (2, 1)), abs=0.7)
    assert ((model.stay > 0) & (model.stay < 1)).all()
    assert (model.var > 0).all()


def test_silences_are_kept_where_there_are_some() -> None:
    found = HmmTrainer(QUICK)
    found.fit(TALKS)
    kept = found._with_silences(TALKS[:6], *_single(found))
    inner = [sum(u == SIL for u in s.units[1:-1]) for s in kept]
    assert inner == [1, 0, 0, 1, 0, 0]


def _single(trainer: HmmTrainer) -> tuple[object, object]:
    """Names and Gaussians of single units, trained on all sentences."""
    from fapstream.learn.network import Names, dynamic

    plain = [s.without([i for i, may in enumerate(s.optional) if may]) for s in TALKS]
    names = Names.single(TALKS)
    frames = np.concatenate([dynamic(s.parameters) for s in TALKS])
    gaussians, _ = trainer._train(plain, names, flat_start(frames, len(names.index)), "flat")
    return names, gaussians


def test_the_same_sentences_make_the_same_model(trained: HmmTrainer) -> None:
    again = HmmTrainer(QUICK).fit(TALKS).model_
    assert np.array_equal(again.mean, trained.model_.mean)
    assert all(
        np.array_equal(a.nodes, b.nodes) for a, b in zip(again.trees, trained.model_.trees, strict=True)
    )


def test_every_step_is_told() -> None:
    told: list[str] = []
    HmmTrainer(QUICK, told.append).fit(TALKS[:8])
    assert len(told) == QUICK.steps


def test_sentences_too_short_for_their_phones_are_let_go_and_none_left_is_said() -> None:
    short = Sentence(
        "x", np.zeros((3, 2)), ("B", "T", "B"), np.array([[0, 1], [1, 2], [2, 3.0]]), (False,) * 3
    )
    assert HmmTrainer(QUICK).fit([*TALKS, short]).model_.mean.shape[1] == 2
    with pytest.raises(ClipError, match="long enough"):
        HmmTrainer(QUICK).fit([short])
    with pytest.raises(ClipError, match="no sentences"):
        HmmTrainer(QUICK).fit([])


def test_a_flat_start_is_all_the_same() -> None:
    frames = np.random.default_rng(0).normal(3, 2, (500, 4))
    start = flat_start(frames, 3)
    assert start.mean == pytest.approx(np.tile(frames.mean(axis=0), (3, 1)))
    assert start.var == pytest.approx(np.tile(frames.var(axis=0), (3, 1)))
