"""Sentences as rows of states, place by place."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.learn.gaussians import Gaussians
from fapstream.learn.network import Names, batches, chains, contexts, densities, dynamic, near, starts
from fapstream.learn.sentences import Sentence
from fapstream.motion.questions import Context
from fapstream.motion.units import SIL


def sentence(
    units: tuple[str, ...], times: list[tuple[float, float]], optional: tuple[int, ...] = (), n: int = 40
) -> Sentence:
    may = tuple(i in optional for i in range(len(units)))
    return Sentence("s", np.random.default_rng(0).normal(size=(n, 2)), units, np.array(times, float), may)


ONE = sentence((SIL, "B", "IY1", SIL), [(-5, 10), (10, 16), (16, 30), (30, 60)])
TWO = sentence((SIL, "B", SIL, "IY1", SIL), [(0, 10), (10, 16), (16, 16), (16, 30), (30, 40)], (2,))


def test_silence_has_three_states_and_phones_have_two() -> None:
    names = Names.single([ONE])
    assert len(names.index) == 3 + 2 + 2
    row = names.row(ONE.units)
    assert len(row) == 10
    assert row[:3].tolist() == row[-3:].tolist()
    assert starts(ONE) == [0, 3, 5, 7, 10]


def test_units_in_context_know_their_neighbours() -> None:
    assert contexts(("B", "IY1")) == [Context(SIL, "B", "IY1"), Context("B", "IY1", SIL)]
    wide = Names.in_context([ONE, sentence(("IY1", "B"), [(0, 20), (20, 40)])])
    assert len({wide.index[key] for key in wide.index}) == len(wide.index)
    assert (Context(SIL, "B", "IY1"), 0) in wide.index
    assert (Context("IY1", "B", SIL), 1) in wide.index


def test_clones_are_as_what_they_were_cloned_from() -> None:
    single, wide = Names.single([ONE]), Names.in_context([ONE])
    before = Gaussians(np.arange(14.0).reshape(7, 2), np.ones((7, 2)), np.linspace(0.1, 0.7, 7))
    after = wide.cloned(single, before)
    for (context, k), row in wide.index.items():
        of = single.index[Context(SIL, context.unit, SIL), k]
        assert np.array_equal(after.mean[row], before.mean[of])
        assert after.stay[row] == before.stay[of]


def test_an_optional_silence_can_be_jumped_over() -> None:
    found = chains([ONE, TWO], Names.single([TWO]))
    assert found.lengths.tolist() == [[10, 40], [13, 40]]
    assert (found.state[0, 10:] == -1).all()
    assert np.flatnonzero(found.jump[1] >= 0).tolist() == [8]
    assert found.jump[1, 8] == 4
    assert (found.jump[0] == -1).all()


@pytest.mark.parametrize(("slack", "first", "last"), [(0, 10, 15), (3, 7, 18), (100, 0, 39)])
def test_a_unit_is_near_where_the_sound_has_it(slack: int, first: int, last: int) -> None:
    where = np.flatnonzero(near(ONE, slack)[:, 3])
    assert (where[0], where[-1]) == (first, last)
    assert near(ONE, slack)[0, 0]
    assert near(ONE, slack)[-1, -1]


def test_what_lies_between_two_units_belongs_to_both() -> None:
    gap = sentence(("B", "IY1"), [(0, 10), (20, 40)])
    place = near(gap, 0)
    assert place[15, [0, 1, 2, 3]].all()


def test_densities_are_never_where_a_unit_is_not() -> None:
    names = Names.single([ONE])
    some = Gaussians(np.zeros((7, 6)), np.ones((7, 6)), np.full(7, 0.5))
    walked = chains([ONE], names)
    free, held = densities([ONE], walked, some, None), densities([ONE], walked, some, 2)
    assert np.isfinite(free).all()
    assert np.isneginf(held[0, 30, 3])
    inside = near(ONE, 2)
    assert np.array_equal(held[0][inside], free[0][inside])


def test_differences_are_slopes() -> None:
    line = np.stack([np.arange(20.0), 3 - 2 * np.arange(20.0)], axis=1)
    found = dynamic(line)
    assert found.shape == (20, 6)
    assert found[4:-4, 2:] == pytest.approx(np.tile([1, -2, 0, 0], (12, 1)))
    assert np.array_equal(found[:, :2], line)


def test_batches_hold_everybody_in_order() -> None:
    many = [sentence(("B",), [(0, 40)]) for _ in range(130)]
    assert [x for batch in batches(many) for x in batch] == many
