"""A queue in bounds."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.adapters.bus.waiting import Bounds, Waiting

SIZES = st.lists(st.integers(0, 30), max_size=60)


@given(SIZES, st.integers(1, 12), st.integers(1, 60))
def test_it_stays_in_bounds_and_keeps_the_newest(sizes: list[int], entries: int, size: int) -> None:
    waiting: Waiting[int] = Waiting(Bounds(entries, size))
    for number, each in enumerate(sizes):
        before = len(waiting)
        dropped = waiting.put(number, each)
        assert dropped == (len(waiting) <= before)
    left = waiting.take(1 << 30)
    assert left == list(range(len(sizes) - len(left), len(sizes)))
    assert len(left) <= entries
    assert len(left) <= 1 or sum(sizes[number] for number in left) <= size


def test_the_older_half_goes_at_once() -> None:
    waiting: Waiting[int] = Waiting(Bounds(8, 1000))
    assert [waiting.put(number, 1) for number in range(9)] == [False] * 8 + [True]
    assert waiting.take(1000) == [5, 6, 7, 8]


@given(SIZES, st.integers(0, 40))
def test_what_is_taken_comes_in_order_and_about_as_much_as_asked(sizes: list[int], size: int) -> None:
    waiting: Waiting[int] = Waiting(Bounds(1000, 1 << 30))
    for number, each in enumerate(sizes):
        waiting.put(number, each)
    seen: list[int] = []
    while waiting:
        taken = waiting.take(size)
        assert taken
        assert len(taken) == 1 or sum(sizes[number] for number in taken[:-1]) < size
        seen += taken
    assert seen == list(range(len(sizes)))
    assert waiting.take(size) == []


def test_the_stale_are_skipped() -> None:
    now = 0.0
    waiting: Waiting[str] = Waiting(Bounds(10, 100, age_s=4.0), lambda: now)
    waiting.put("old", 1)
    now = 3.0
    waiting.put("new", 1)
    now = 5.0
    assert waiting.take(100) == ["new"]


def test_cleared_and_empty() -> None:
    waiting: Waiting[int] = Waiting(Bounds(2, 10))
    waiting.put(1, 10)
    waiting.clear()
    assert not waiting.put(2, 10)
    assert waiting.pop() == 2
    with pytest.raises(IndexError):
        waiting.pop()
