"""Trees lead every context to a leaf."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.motion.questions import Context, questions
from fapstream.motion.trees import N_TREES, TiedStates, Tree, n_states, tree_number
from fapstream.motion.units import SIL, features

UNITS = st.sampled_from(sorted(features()))
BILABIAL = questions().index((0, "bilabial"))
BEFORE_VOWEL = questions().index((1, "vowel"))


def small() -> TiedStates:
    """First states are told by whether they close the lips, second ones by what follows; silence is alone."""
    first = Tree(np.array([[BILABIAL, 1, 2], [-1, 0, 0], [-1, 1, 1]]))
    second = Tree(np.array([[BEFORE_VOWEL, 1, 2], [-1, 0, 0], [-1, 1, 1]]))
    alone = Tree(np.array([[-1, 0, 0]]))
    n = 7
    return TiedStates(
        (first, second, alone, alone, alone), np.zeros((n, 1)), np.ones((n, 1)), np.full(n, 0.5)
    )


def test_questions_lead_to_the_states() -> None:
    states = small()
    assert states.states(Context(SIL, "B", "AA1")).tolist() == [0, 2]
    assert states.states(Context(SIL, "B", "L")).tolist() == [0, 3]
    assert states.states(Context(SIL, "AA1", SIL)).tolist() == [1, 3]
    assert states.states(Context("B", SIL, "AA1")).tolist() == [4, 5, 6]


def test_mean_stays_share_a_unit() -> None:
    """d = 1 / (1 - p): 2 and 10 frames."""
    states = small()
    stay = states.stay.copy()
    stay[3] = 0.9
    shares = TiedStates(states.trees, states.mean, states.var, stay).shares(np.array([0, 3]))
    assert shares == pytest.approx([2 / 12, 10 / 12])


def test_a_tree_for_every_state() -> None:
    numbers = {tree_number(unit, k) for unit in features() for k in range(n_states(unit))}
    assert numbers == set(range(N_TREES))


@given(UNITS, UNITS, UNITS)
def test_any_context_has_states(before: str, unit: str, after: str) -> None:
    found = small().states(Context(before, unit, after))
    assert len(found) == n_states(unit)
    assert found.max() < 7
