"""Channels of other processes, fetched once for all who listen here."""

from __future__ import annotations

import logging

import pytest

from fapstream.adapters.bus.following import Following
from fapstream.adapters.bus.numbers import Numbers
from fapstream.errors import InputError


class Outside:
    """The other side: what was asked of it, and entries of it."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        self.following = Following(lambda c: self.asked.append(f"+{c}"), lambda c: self.asked.append(f"-{c}"))
        self.numbers = Numbers()

    def send(self, channel: str, *entries: bytes) -> None:
        for entry in entries:
            self.following.receive(channel, self.numbers.stamp(channel, entry))


async def test_a_channel_is_wanted_from_its_first_to_its_last_subscriber() -> None:
    outside = Outside()
    one = outside.following.subscribe("a")
    two = outside.following.subscribe("a")
    assert list(outside.following) == ["a"]
    await one.aclose()
    assert outside.asked == ["+a"]
    await two.aclose()
    assert outside.asked == ["+a", "-a"]
    assert list(outside.following) == []


async def test_the_second_subscriber_gets_the_backlog_from_here() -> None:
    outside = Outside()
    outside.following.subscribe("a")
    outside.send("a", b"1", b"2")
    two = outside.following.subscribe("a")
    outside.send("a", b"3")
    assert [await anext(two) for _ in range(3)] == [b"1", b"2", b"3"]


async def test_what_was_kept_before_nobody_listened_is_not_handed_out_later() -> None:
    outside = Outside()
    one = outside.following.subscribe("a")
    outside.send("a", b"1")
    await one.aclose()
    outside.send("a", b"2")
    two = outside.following.subscribe("a")
    outside.send("a", b"3")
    await outside.following.aclose()
    assert [entry async for entry in two] == [b"3"]


async def test_a_loss_is_a_gap_for_everyone_who_listens_and_who_will() -> None:
    outside = Outside()
    one = outside.following.subscribe("a")
    outside.send("a", b"1")
    outside.numbers.stamp("a", b"lost")
    outside.send("a", b"3")
    two = outside.following.subscribe("a")
    await outside.following.aclose()
    assert [e async for e in one] == [e async for e in two] == [b"1", None, b"3"]


async def test_what_is_no_entry_is_left_out_and_said_once(caplog: pytest.LogCaptureFixture) -> None:
    outside = Outside()
    one = outside.following.subscribe("a")
    with caplog.at_level(logging.WARNING):
        outside.following.receive("a", b"short")
        outside.following.receive("a", None)
        outside.following.receive("nobody's", None)
    outside.send("a", b"1")
    assert await anext(one) == b"1"
    assert len(caplog.records) == 1


async def test_a_name_that_is_none() -> None:
    outside = Outside()
    with pytest.raises(InputError):
        outside.following.subscribe("")
    assert outside.asked == []
