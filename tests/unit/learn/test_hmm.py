"""Training: no step makes the talks less likely, and what was planted is found."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

from fapstream.errors import ClipError
from fapstream.learn import hmm, network
from fapstream.learn.gaussians import Gaussians
from fapstream.learn.hmm import FIRST_STAY, HmmTrainer, Recipe, flat_start
from fapstream.learn.network import Names, dynamic
from fapstream.learn.sentences import Sentence
from fapstream.motion.questions import Context
from fapstream.motion.trees import N_TREES, TiedStates, n_states
from fapstream.motion.units import SIL, features

Floats = NDArray[np.float64]
WORDS = (("P", "AA1"), ("T", "IY1"), ("S", "AA1", "P"), ("IY1", "S"))
SMALL = Recipe(flat=4, realigned=3, cloned=2, tied=3, min_frames=20.0, min_gain=20.0)

MEANS = {
    (SIL, 0): (0.0, 0.0), (SIL, 1): (1.0, 1.0), (SIL, 2): (0.0, 2.0),
    ("P", 0): (-3.0, 0.0), ("P", 1): (-2.0, 2.0),
    ("AA1", 0): (3.0, 1.0), ("AA1", 1): (3.5, -1.0), ("T", 0): (-1.0, -3.0), ("T", 1): (2.0, -4.0),
    ("IY1", 0): (1.0, 4.0), ("IY1", 1): (2.0, 5.0), ("S", 0): (-4.0, -4.0), ("S", 1): (-5.0, -2.0),
}  # fmt: skip
STAYS = {state: 0.85 - 0.1 * state[1] for state in MEANS}
SIGMA = 0.3

MET = {
    context.unit: context
    for context in (Context(SIL, SIL, "P"), Context(SIL, "P", "AA1"), Context("S", "AA1", "P"),
                    Context(SIL, "T", "IY1"), Context("T", "IY1", SIL), Context("IY1", "S", SIL))
}  # fmt: skip
"""A context of each that is in many talks."""


def sampled(rng: np.random.Generator, silences: float, shift: float = 0.0) -> Sentence:
    """A talk of three or four words of known states; between some words there is a silence, and one may be
    anywhere. `shift`: how far an AA1 after a P is from any other, in the first parameter."""
    chosen = [WORDS[i] for i in rng.integers(0, len(WORDS), int(rng.integers(3, 5)))]
    units: list[str] = []
    optional: list[bool] = []
    rows: list[Floats] = []
    times: list[tuple[float, float]] = []

    def put(unit: str, may: bool, there: bool = True) -> None:
        begin = len(rows)
        for k in range(n_states(unit) * there):
            mean = np.array(MEANS[unit, k])
            mean[0] += shift * (unit == "AA1" and units[-1:] == ["P"])
            for _ in range(int(rng.geometric(1 - STAYS[unit, k]))):
                rows.append(rng.normal(mean, SIGMA))
        units.append(unit)
        optional.append(may)
        times.append((begin, len(rows)))

    put(SIL, False)
    for i, word in enumerate(chosen):
        if i:
            put(SIL, True, bool(rng.random() < silences))
        for unit in word:
            put(unit, False)
    put(SIL, False)
    return Sentence("talk", np.array(rows), tuple(units), np.array(times, float), tuple(optional))


def talks(seed: int, n: int = 60, silences: float = 0.5, shift: float = 0.0) -> list[Sentence]:
    rng = np.random.default_rng(seed)
    return [sampled(rng, silences, shift) for _ in range(n)]


def falls(likelihoods: Sequence[float]) -> float:
    return float(max(0.0, -np.diff(likelihoods).min(initial=0.0)))


@pytest.mark.parametrize("slack", [None, 3])
def test_no_iteration_makes_the_talks_less_likely(slack: int | None) -> None:
    recipe = Recipe(flat=5, realigned=4, cloned=4, tied=4, slack=slack, min_frames=20, min_gain=20)
    found = HmmTrainer(recipe).fit(talks(0, 30)).log_likelihood_
    assert {step: len(values) for step, values in found.items()} == {
        "flat": 5, "realigned": 4, "cloned": 4, "tied": 4,
    }  # fmt: skip
    assert all(falls(values) < 1e-9 for values in found.values())
    assert found["flat"][-1] > found["flat"][0] + 1


@pytest.mark.parametrize("seed", range(3))
def test_nor_of_frames_that_are_nothing_but_noise(seed: int) -> None:
    rng = np.random.default_rng(seed)
    noise = [
        Sentence(s.name, rng.normal(size=s.parameters.shape), s.units, s.times, s.optional)
        for s in talks(seed, 20)
    ]
    found = HmmTrainer(Recipe(flat=5, realigned=3, cloned=3, tied=3, min_gain=5.0)).fit(noise)
    assert all(falls(values) < 1e-9 for values in found.log_likelihood_.values())


@pytest.fixture(scope="module")
def trained() -> TiedStates:
    """Without slopes: those of states that jump depend on what is around them, and the model knows nothing of
    that. Frames are then independent but for their states, as they were drawn."""
    with pytest.MonkeyPatch.context() as patch:
        for module in (hmm, network):
            patch.setattr(module, "dynamic", lambda parameters: parameters)
        return HmmTrainer(Recipe(flat=15, min_frames=20.0, min_gain=20.0)).fit(talks(1, 120)).model_


@pytest.mark.parametrize(("unit", "k"), MEANS)
def test_states_that_talks_were_drawn_from_are_found(unit: str, k: int, trained: TiedStates) -> None:
    """In any context, as none of them was different."""
    state = trained.states(MET[unit])[k]
    np.testing.assert_allclose(trained.mean[state], MEANS[unit, k], atol=0.12)
    np.testing.assert_allclose(np.sqrt(trained.var[state]), SIGMA, atol=0.15)
    assert trained.stay[state] == pytest.approx(STAYS[unit, k], abs=0.08)


def test_a_context_that_was_never_met_has_states(trained: TiedStates) -> None:
    for unit in features():
        states = trained.states(Context("ZH", unit, "SIL"))
        assert len(states) == n_states(unit)
        assert all(0 <= state < len(trained.mean) for state in states)


def test_every_leaf_has_one_state(trained: TiedStates) -> None:
    assert len(trained.trees) == N_TREES
    leaves = sum(tree.n_leaves for tree in trained.trees)
    assert trained.mean.shape == trained.var.shape == (leaves, 2)
    assert trained.stay.shape == (leaves,)
    assert (trained.var > 0).all()


def test_contexts_that_differ_get_states_of_their_own() -> None:
    model = HmmTrainer(SMALL).fit(talks(2, 100, shift=4.0)).model_
    after_p, after_s = (model.states(Context(before, "AA1", SIL)) for before in "PS")
    for k in range(2):
        apart = model.mean[after_p[k]] - model.mean[after_s[k]]
        np.testing.assert_allclose(apart, [4.0, 0.0], atol=0.4)


def known(names: Names) -> Gaussians:
    """The states that talks are drawn from, slopes of any size."""
    rows = [(*MEANS[context.unit, k], 0, 0, 0, 0) for context, k in names.index]
    stays = np.array([STAYS[context.unit, k] for context, k in names.index])
    return Gaussians(np.array(rows, float), np.tile([SIGMA**2] * 2 + [10.0] * 4, (len(rows), 1)), stays)


@pytest.mark.parametrize("slack", [None, 3])
def test_silences_are_kept_where_somebody_was_silent(slack: int | None) -> None:
    given = talks(3, 40)
    names = Names.single(given)
    found = HmmTrainer(Recipe(slack=slack))._with_silences(given, names, known(names))
    right = Counter[bool]()
    for before, after in zip(given, found, strict=True):
        there = before.times[:, 1] > before.times[:, 0]
        wanted = before.without([int(i) for i in np.flatnonzero(~there)])
        right[after.units == wanted.units] += 1
        assert not any(after.optional)
    assert right[True] > 10 * right[False]


def test_it_is_the_same_every_time() -> None:
    one, other = (HmmTrainer(SMALL).fit(talks(4, 25)).model_ for _ in range(2))
    for name in ("mean", "var", "stay"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_progress_is_told_before_every_step() -> None:
    told: list[str] = []
    HmmTrainer(SMALL, told.append).fit(talks(5, 10))
    assert Counter(told) == {"flat": 4, "silences": 1, "realigned": 3, "cloned": 2, "trees": 1, "tied": 3}
    assert len(told) == SMALL.steps


def test_all_states_begin_alike() -> None:
    frames = np.random.default_rng(0).normal(3, 2, (50, 4))
    found = flat_start(frames, 5)
    np.testing.assert_allclose(found.mean, np.tile(frames.mean(axis=0), (5, 1)))
    np.testing.assert_allclose(found.var, np.tile(frames.var(axis=0), (5, 1)))
    assert found.stay.tolist() == [FIRST_STAY] * 5


def test_no_variance_is_below_the_part_of_all_frames_that_was_asked_for() -> None:
    given = talks(6, 20)
    frames = np.concatenate([dynamic(s.parameters) for s in given])
    model = HmmTrainer(Recipe(flat=3, min_frames=20, floor=0.2)).fit(given).model_
    assert (model.var >= 0.2 * frames.var(axis=0)[:2] - 1e-12).all()


def test_larger_leaves_make_fewer_states() -> None:
    sizes = []
    for frames, gain in ((5.0, 1.0), (30.0, 40.0), (1e9, 40.0)):
        model = (
            HmmTrainer(Recipe(flat=3, min_frames=frames, min_gain=gain)).fit(talks(7, 40, shift=1.0)).model_
        )
        sizes.append(len(model.stay))
    assert sizes[0] > sizes[1] > sizes[2] == N_TREES


def too_short() -> Sentence:
    units = (SIL, *["P", "AA1"] * 4, SIL)
    times = np.linspace(0, 10, len(units) + 1)
    return Sentence(
        "short",
        np.random.default_rng(0).normal(size=(10, 2)),
        units,
        np.stack([times[:-1], times[1:]], axis=1),
        (False,) * 10,
    )


def test_a_talk_that_is_too_short_for_its_phones_counts_for_nothing() -> None:
    given = talks(8, 20)
    found = HmmTrainer(SMALL).fit([*given, too_short()])
    assert np.isfinite([x for step in found.log_likelihood_.values() for x in step]).all()
    assert np.isfinite(found.model_.mean).all()


def test_nothing_to_learn_from_is_said() -> None:
    with pytest.raises(ClipError, match="no sentences"):
        HmmTrainer().fit([])
    with pytest.raises(ClipError, match="no sentence is long enough"):
        HmmTrainer(SMALL).fit([too_short()])


@pytest.mark.parametrize("step", ["flat", "realigned", "cloned", "tied"])
def test_a_step_without_iterations_is_refused(step: str) -> None:
    with pytest.raises(ValueError, match="iteration"):
        Recipe(**{step: 0})
