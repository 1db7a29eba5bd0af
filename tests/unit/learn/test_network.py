"""Sentences as rows of states, place by place."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import norm

from fapstream.learn.chains import NEVER
from fapstream.learn.gaussians import Gaussians
from fapstream.learn.network import (
    BATCH,
    Names,
    batches,
    chains,
    contexts,
    densities,
    dynamic,
    near,
    starts,
)
from fapstream.learn.sentences import Sentence
from fapstream.motion.questions import Context
from fapstream.motion.trees import n_states
from fapstream.motion.units import SIL


def spoken(
    units: str, times: list[float] | None = None, optional: str = "", frames: int = 40, n: int = 1
) -> Sentence:
    """Units and the times at which they begin and the last one ends; `optional`: their numbers."""
    names = tuple(units.split())
    edges = np.linspace(0, frames, len(names) + 1) if times is None else np.array(times)
    may = [int(i) for i in optional.split()]
    parameters = np.random.default_rng(len(names)).normal(size=(frames, n))
    return Sentence(
        "a sentence", parameters, names, np.stack([edges[:-1], edges[1:]], axis=1),
        tuple(i in may for i in range(len(names))),
    )  # fmt: skip


def test_a_unit_has_its_neighbours_and_silence_is_around_everything() -> None:
    assert contexts(["P", "AA1", "T"]) == [
        Context(SIL, "P", "AA1"), Context("P", "AA1", "T"), Context("AA1", "T", SIL)
    ]  # fmt: skip
    assert contexts([]) == []


def test_single_names_are_of_units_and_wide_ones_of_units_in_context() -> None:
    of = [spoken("SIL P AA1 SIL"), spoken("SIL AA1 P AA1 SIL")]
    single, wide = Names.single(of), Names.in_context(of)
    assert len(single.index) == 2 + 2 + 3
    assert sorted(single.index.values()) == list(range(7))
    assert single.row(["SIL", "P", "AA1", "P"]).tolist() == [
        *(single.index[Context(SIL, SIL, SIL), k] for k in range(3)),
        *(single.index[Context(SIL, "P", SIL), k] for k in range(2)),
        *(single.index[Context(SIL, "AA1", SIL), k] for k in range(2)),
        *(single.index[Context(SIL, "P", SIL), k] for k in range(2)),
    ]
    met = {c for s in of for c in contexts(s.units)}
    assert {context for context, _ in wide.index} == met
    assert len(wide.index) == sum(n_states(c.unit) for c in met)
    assert sorted(wide.index.values()) == list(range(len(wide.index)))
    row = wide.row(of[1].units)
    assert row[3] == wide.index[Context(SIL, "AA1", "P"), 0]
    assert row[7] == wide.index[Context("P", "AA1", SIL), 0]


def test_names_do_not_depend_on_the_order_of_sentences() -> None:
    of = [spoken("SIL P AA1 SIL"), spoken("SIL AA1 P AA1 SIL")]
    assert Names.single(of).index == Names.single(of[::-1]).index
    assert Names.in_context(of).index == Names.in_context(of[::-1]).index


def test_units_in_context_begin_as_they_are_without() -> None:
    of = [spoken("SIL P AA1 SIL"), spoken("SIL AA1 P AA1 SIL")]
    single, wide = Names.single(of), Names.in_context(of)
    rng = np.random.default_rng(0)
    gaussians = Gaussians(rng.normal(size=(7, 2)), rng.random((7, 2)), rng.random(7))
    cloned = wide.cloned(single, gaussians)
    for (context, k), row in wide.index.items():
        before = single.index[Context(SIL, context.unit, SIL), k]
        np.testing.assert_array_equal(cloned.mean[row], gaussians.mean[before])
        np.testing.assert_array_equal(cloned.var[row], gaussians.var[before])
        assert cloned.stay[row] == gaussians.stay[before]


def test_a_row_place_by_place_with_a_silence_that_may_be_jumped_over() -> None:
    """SIL has three states, phones two; the place after a silence is reached from that before it."""
    batch = [spoken("SIL P SIL AA1 SIL", optional="2"), spoken("P", frames=9)]
    names = Names.single(batch)
    found = chains(batch, names)
    sil, p, aa = names.row([SIL]), names.row(["P"]), names.row(["AA1"])
    assert found.state[0].tolist() == [*sil, *p, *sil, *aa, *sil]
    assert found.state[1].tolist() == [*p, *[-1] * 11]
    assert found.jump[0].tolist() == [-1] * 8 + [4] + [-1] * 4
    assert (found.jump[1] == -1).all()
    assert found.lengths.tolist() == [[13, 40], [2, 9]]
    assert starts(batch[0]) == [0, 3, 5, 8, 10, 13]


def test_silences_that_have_to_be_there_are_not_jumped_over() -> None:
    batch = [spoken("SIL P SIL AA1 SIL")]
    assert (chains(batch, Names.single(batch)).jump == -1).all()


@pytest.mark.parametrize(("n", "sizes"), [(0, []), (1, [1]), (BATCH, [BATCH]), (BATCH + 3, [BATCH, 3])])
def test_batches_hold_every_sentence_once_in_order(n: int, sizes: list[int]) -> None:
    of = [spoken("P", frames=i + 1) for i in range(n)]
    found = list(batches(of))
    assert [len(batch) for batch in found] == sizes
    assert [len(s.parameters) for batch in found for s in batch] == list(range(1, n + 1))


def allowed(sentence: Sentence, slack: int) -> dict[int, list[int]]:
    """Of every unit, the frames at which its states may be; all its states alike."""
    found, first = near(sentence, slack), starts(sentence)
    for begin, end in pairwise(first):
        assert (found[:, begin:end] == found[:, begin : begin + 1]).all()
    return {u: np.flatnonzero(found[:, first[u]]).tolist() for u in range(len(sentence.units))}


@pytest.mark.parametrize("slack", [0, 1, 3])
def test_a_frame_may_be_in_a_unit_that_is_no_further_than_slack(slack: int) -> None:
    sentence = spoken("SIL P AA1 SIL", [0, 10, 20, 30, 40])
    assert allowed(sentence, slack) == {
        0: list(range(0, 10 + slack)),
        1: list(range(10 - slack, 20 + slack)),
        2: list(range(20 - slack, 30 + slack)),
        3: list(range(30 - slack, 40)),
    }


def test_what_lies_before_the_first_and_after_the_last_is_theirs() -> None:
    """Times of the sound begin before the sentence and end after it, or the other way round."""
    for edges in ([-25.0, 10, 20, 70], [5.0, 10, 20, 33]):
        found = allowed(spoken("SIL P SIL", edges), 0)
        assert found[0] == list(range(10))
        assert found[2] == list(range(20, 40))


def test_what_lies_between_two_units_belongs_to_both() -> None:
    sentence = spoken("P AA1", [0, 10, 40])
    sentence.times[1, 0] = 18.0
    assert allowed(sentence, 0) == {0: list(range(18)), 1: list(range(10, 40))}


def test_times_between_frames_count_the_frame_that_has_begun() -> None:
    assert allowed(spoken("P AA1", [0, 10.4, 40]), 0) == {0: list(range(11)), 1: list(range(11, 40))}


@settings(max_examples=40, deadline=None)
@given(st.lists(st.floats(0.3, 12), min_size=1, max_size=9), st.integers(0, 4))
def test_every_frame_may_be_somewhere(lengths: list[float], slack: int) -> None:
    edges = np.concatenate([[0], np.cumsum(lengths)])
    frames = max(1, round(edges[-1]))
    sentence = spoken(" ".join(["P", "AA1"] * 5), None, frames=frames)
    sentence = Sentence("", sentence.parameters, sentence.units[: len(lengths)],
                        np.stack([edges[:-1], edges[1:]], axis=1), (False,) * len(lengths))  # fmt: skip
    assert near(sentence, slack).any(axis=1).all()


@pytest.mark.parametrize("slack", [None, 0, 2])
def test_densities_are_those_of_the_states_where_a_unit_may_be(slack: int | None) -> None:
    batch = [spoken("SIL P AA1 SIL", n=2), spoken("P AA1", frames=15, n=2)]
    names = Names.single(batch)
    rng = np.random.default_rng(1)
    gaussians = Gaussians(rng.normal(size=(7, 6)), rng.uniform(0.5, 2, (7, 6)), np.full(7, 0.5))
    walked = chains(batch, names)
    found = densities(batch, walked, gaussians, slack)
    assert found.shape == (2, 40, 10)
    for i, sentence in enumerate(batch):
        x, (s, t) = dynamic(sentence.parameters), walked.lengths[i]
        may = np.ones((t, s), bool) if slack is None else near(sentence, slack)
        for place in range(s):
            state = walked.state[i, place]
            of = norm(gaussians.mean[state], np.sqrt(gaussians.var[state])).logpdf(x).sum(axis=1)
            np.testing.assert_allclose(found[i, :t, place], np.where(may[:, place], of, NEVER))
        assert (found[i, t:] == NEVER).all()
        assert (found[i, :, s:] == NEVER).all()


def slope(values: np.ndarray, t: int) -> float:
    """Of the least-squares line through five frames; the first and the last go on for ever."""
    around = values[np.clip(np.arange(t - 2, t + 3), 0, len(values) - 1)]
    return float(np.polyfit(np.arange(-2, 3), around, 1)[0])


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 12), st.integers(0, 10**6))
def test_differences_are_slopes_of_a_line_through_five_frames(n: int, seed: int) -> None:
    values = np.random.default_rng(seed).normal(size=(n, 2))
    found = dynamic(values)
    assert found.shape == (n, 6)
    np.testing.assert_array_equal(found[:, :2], values)
    for column in range(2):
        first = np.array([slope(values[:, column], t) for t in range(n)])
        second = [slope(first, t) for t in range(n)]
        np.testing.assert_allclose(found[:, 2 + column], first, atol=1e-12)
        np.testing.assert_allclose(found[:, 4 + column], second, atol=1e-12)


def test_differences_of_a_parabola_are_its_derivatives() -> None:
    t = np.arange(20.0)
    found = dynamic((0.5 * t**2)[:, None])
    np.testing.assert_allclose(found[2:-2, 1], t[2:-2])
    np.testing.assert_allclose(found[4:-4, 2], 1)
