"""Two readings side by side."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.benchmarks.sequences import Agreement, aligned

NAMES = st.lists(st.sampled_from("abc"), max_size=12)


@given(NAMES, NAMES)
def test_pairs_are_equal_and_ascend(left: list[str], right: list[str]) -> None:
    pairs = list(aligned(left, right))
    assert all(left[i] == right[j] for i, j in pairs)
    assert [i for i, _ in pairs] == sorted({i for i, _ in pairs})
    assert [j for _, j in pairs] == sorted({j for _, j in pairs})


def test_as_many_as_can_be() -> None:
    assert list(aligned("abcd", "abd")) == [(0, 0), (1, 1), (3, 2)]
    assert list(aligned("abc", "abc")) == [(0, 0), (1, 1), (2, 2)]
    assert list(aligned("", "a")) == []


def test_agreement() -> None:
    found = Agreement()
    for a, b in ((1.0, 3.0), (2.0, 5.0), (3.0, 7.0)):
        found.add(a, b)
    assert found.correlation() == pytest.approx(1.0)
    assert found.rmse(2.0) == pytest.approx(1.0)
    found.ours[:] = [1.0, 1.0, 1.0]
    assert math.isnan(found.correlation())
