"""Numbered entries over a way that loses, repeats and mixes them."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.adapters.bus import numbers as module
from fapstream.adapters.bus.numbers import AFRESH_S, HEADER, MAX_STAMPED, Follower, Numbers
from fapstream.errors import InputError


def published(count: int, channel: str = "a", numbers: Numbers | None = None) -> list[bytes]:
    numbers = numbers or Numbers()
    return [numbers.stamp(channel, b"%d" % number) for number in range(count)]


def received(follower: Follower, entries: list[bytes]) -> list[bytes | None]:
    return [got for entry in entries for got in follower.take(entry)]


def test_all_that_comes_is_handed_on() -> None:
    assert received(Follower(), published(3)) == [b"0", b"1", b"2"]


def test_who_comes_late_missed_nothing() -> None:
    assert received(Follower(), published(5)[3:]) == [b"3", b"4"]


@given(st.lists(st.integers(0, 20), max_size=80))
def test_nothing_twice_and_nothing_missing_untold(order: list[int]) -> None:
    """Whichever entries come in whichever order, as if parts were sent again."""
    entries = published(21)
    got = received(Follower(), [entries[number] for number in order])
    last = None
    gap = False
    for entry in got:
        if entry is None:
            gap = True
            continue
        number = int(entry)
        if last is not None:
            assert number > last
            assert gap == (number > last + 1)
        last, gap = number, False
    if order:
        assert last == max(order)


def test_another_publisher_begins_without_a_gap_or_is_known_to_have_begun_before() -> None:
    first, second = published(2), published(3)
    assert received(Follower(), first + second) == [b"0", b"1", b"0", b"1", b"2"]
    assert received(Follower(), first + second[1:]) == [b"0", b"1", None, b"1", b"2"]


def test_who_was_long_silent_is_not_thought_to_have_been_missed() -> None:
    """One who comes in while others publish has seen nothing of what one published long before who then goes
    on."""
    clock = [0.0]
    one, two = Numbers(lambda: clock[0]), Numbers(lambda: clock[0])
    published(3, numbers=one)
    clock[0] = AFRESH_S
    seen = published(2, numbers=two) + published(2, numbers=one)
    assert received(Follower(), seen) == [b"0", b"1", b"0", b"1"]
    clock[0] += AFRESH_S - 0.01
    lost = published(2, numbers=one)[1:]
    assert received(Follower(), seen + lost) == [b"0", b"1", b"0", b"1", None, b"1"]


def test_publishers_may_take_turns() -> None:
    one, two = published(3), published(3)
    mixed = [entry for pair in zip(one, two, strict=True) for entry in pair]
    assert None not in received(Follower(), mixed)


def test_a_publisher_that_forgot_a_channel_is_another_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_COUNTED", 1)
    numbers = Numbers()
    follower = Follower()
    assert received(follower, published(2, "a", numbers)) == [b"0", b"1"]
    published(1, "b", numbers)
    assert received(follower, published(2, "a", numbers)) == [b"0", b"1"]


def test_so_many_publishers_are_told_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_ORIGINS", 2)
    one, two, three = published(2), published(2), published(2)
    got = received(Follower(), [one[0], two[0], one[1], three[0], two[1]])
    assert got == [b"0", b"0", b"1", b"0", None, b"1"]


@pytest.mark.parametrize("wrong", [None, "text", 7, b"", bytes(HEADER.size - 1), bytes(MAX_STAMPED + 1)])
def test_what_is_no_entry(wrong: object) -> None:
    with pytest.raises(InputError, match="no entry"):
        Follower().take(wrong)


def test_the_largest_entry() -> None:
    assert Follower().take(bytes(MAX_STAMPED)) == (bytes(MAX_STAMPED - HEADER.size),)
