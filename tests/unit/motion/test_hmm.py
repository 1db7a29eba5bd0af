"""The states of triphones in time, and that a unit's mouth needs the two units after it and no more."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.motion.hmm import HmmMouth
from fapstream.motion.questions import Context
from fapstream.motion.speaker import speaker
from fapstream.motion.spline import STEP_S, Segments, Smoothness, observed, smooth
from fapstream.motion.trees import n_states
from fapstream.motion.units import SIL, TimedUnit, features
from tests.unit.motion import security

RATE = security.RATE
MOUTH = HmmMouth(speaker().states, speaker().smoothness)

TALKS = st.lists(
    st.tuples(st.sampled_from([u for u in sorted(features()) if u != SIL]), st.integers(20, 200)),
    min_size=4,
    max_size=14,
)


def timed(talk: list[tuple[str, int]]) -> list[TimedUnit]:
    units, start = [], 0
    for name, ms in talk:
        units.append(TimedUnit(name, start, start + ms * RATE // 1000))
        start = units[-1].end
    return units


def instants(units: list[TimedUnit]) -> np.ndarray:
    """The unit of every instant."""
    ends = [int(np.ceil(unit.end / RATE / STEP_S - 1e-9)) for unit in units]
    return np.repeat(np.arange(len(units)), np.diff(ends, prepend=0))


def whole(units: list[TimedUnit]) -> np.ndarray:
    """One solution for the whole talk, from the states as the paper has them in time."""
    states = speaker().states
    names = [SIL, *(unit.name for unit in units), SIL]
    start, end, rows = [], [], []
    for i, unit in enumerate(units):
        found = states.states(Context(*names[i : i + 3]))
        edges = unit.start + (unit.end - unit.start) * np.concatenate([[0], np.cumsum(states.shares(found))])
        start += list(edges[:-1] / RATE)
        end += list(edges[1:] / RATE)
        rows += list(found)
    precision = 1 / states.var[rows]
    segments = Segments(np.array(start), np.array(end), precision, precision * states.mean[rows])
    n = len(instants(units))
    return smooth(*observed(segments, 0, n), speaker().smoothness)


def test_security_is_what_one_solution_for_all_of_it_is() -> None:
    """Table 1. Stated tolerance: 0.05 rms, 0.3 at most, in standard deviations over speech."""
    units = security.units()
    error = MOUTH.parameters(units, instants(units), 0, RATE) - whole(units)
    assert np.sqrt((error**2).mean()) < 0.05
    assert np.abs(error).max() < 0.3


def test_security_opens_where_it_should() -> None:
    """The lips are further apart in IY than in UW, and the mouth wider."""
    units = security.units()
    faps = speaker().articulation.faps(MOUTH.parameters(units, instants(units), 0, RATE))
    at = {
        name: faps[np.flatnonzero(instants(units) == 1 + security.PHONES.index(name))].mean(axis=0)
        for name in ("UW1", "IY0")
    }
    width = [at[name][3] + at[name][4] for name in ("UW1", "IY0")]
    assert width[0] < width[1]


def test_states_share_their_unit_by_their_mean_stays() -> None:
    """d_i / sum d with d_i = 1 / (1 - p_ii), summing to the whole unit."""
    states = speaker().states
    found = states.states(Context("K", "Y", "UW1"))
    shares = states.shares(found)
    stays = 1 / (1 - states.stay[found])
    assert shares == pytest.approx(stays / stays.sum())
    assert len(found) == n_states("Y") == 2
    assert n_states(SIL) == 3


@settings(max_examples=40, deadline=None)
@given(TALKS, st.data())
def test_what_comes_after_the_next_two_units_changes_nothing(
    talk: list[tuple[str, int]], data: st.DataObject
) -> None:
    units = timed(talk)
    at = data.draw(st.integers(0, len(units) - 3))
    of = instants(units)
    wanted = np.flatnonzero(of <= at)
    if not len(wanted):
        return
    known = units[: at + 1 + MOUTH.look_ahead]
    far = MOUTH.parameters(units, of, 0, RATE)[wanted]
    near = MOUTH.parameters(known, of[wanted], 0, RATE)
    assert near == pytest.approx(far, abs=1e-9)


@settings(max_examples=40, deadline=None)
@given(TALKS)
def test_any_phones_of_any_length_move_the_mouth_no_further_than_people(talk: list[tuple[str, int]]) -> None:
    units = timed(talk)
    made = MOUTH.parameters(units, instants(units), 0, RATE)
    assert np.isfinite(made).all()
    assert np.abs(made).max() < 6


def test_every_unit_has_states_in_any_context() -> None:
    for unit in features():
        for before in ("B", "AA1", SIL):
            states = speaker().states.states(Context(before, unit, "IY0"))
            assert len(states) == n_states(unit)


def test_a_rougher_kernel_is_handed_on() -> None:
    units = security.units()
    rough = HmmMouth(speaker().states, Smoothness(0.03, 0.01)).parameters(units, instants(units), 0, RATE)
    fine = MOUTH.parameters(units, instants(units), 0, RATE)
    assert np.abs(np.diff(rough, 2, axis=0)).mean() > 1.5 * np.abs(np.diff(fine, 2, axis=0)).mean()
