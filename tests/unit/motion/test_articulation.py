"""Parameters to FAPs and back."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.motion.articulation import COLUMNS, SPOKEN
from fapstream.motion.speaker import speaker


def test_parameters_come_back_from_their_faps() -> None:
    a = speaker().articulation
    parameters = np.random.default_rng(1).normal(size=(20, a.n))
    assert a.parameters(a.faps(parameters)) == pytest.approx(parameters)


def test_there_are_six_and_they_move_jaw_and_lips_alike_on_both_sides() -> None:
    a = speaker().articulation
    assert a.n == 6
    assert len(a.names) == 6
    assert a.basis.shape == (6, len(SPOKEN))
    column = {fap: i for i, fap in enumerate(SPOKEN)}
    for left, right in ((6, 7), (8, 9), (10, 11), (12, 13), (53, 54), (55, 56), (57, 58), (59, 60)):
        assert a.basis[:, column[left]] == pytest.approx(a.basis[:, column[right]], abs=1e-3)


def test_the_first_opens_the_jaw_and_the_second_the_lips() -> None:
    basis = speaker().articulation.basis
    assert basis[0, SPOKEN.index(3)] == np.abs(basis[:, SPOKEN.index(3)]).max() == basis[0].max()
    assert basis[1, SPOKEN.index(4)] < 0
    assert basis[1, SPOKEN.index(5)] < 0


def test_columns_are_those_of_the_faps() -> None:
    assert (COLUMNS + 1).tolist() == list(SPOKEN)
