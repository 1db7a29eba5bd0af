"""One subscriber's queue."""

from __future__ import annotations

import asyncio

import pytest

from fapstream.adapters.bus.inbox import Inbox
from fapstream.adapters.bus.waiting import Bounds

BOUNDS = Bounds(4, 1000)


class Owner:
    """Whom an inbox tells that it is closed."""

    def __init__(self) -> None:
        self.left: list[Inbox] = []

    def inbox(self, bounds: Bounds = BOUNDS) -> Inbox:
        return Inbox(self.left.append, bounds)


async def everything(inbox: Inbox) -> list[bytes | None]:
    inbox.end()
    return [entry async for entry in inbox]


async def test_entries_and_gaps_in_order() -> None:
    inbox = Owner().inbox()
    for entry in (b"1", None, b"2"):
        inbox.put(entry)
    assert await everything(inbox) == [b"1", None, b"2"]


async def test_it_is_waited_for() -> None:
    inbox = Owner().inbox()
    first = asyncio.create_task(anext(inbox))
    await asyncio.sleep(0)
    inbox.put(b"1")
    assert await first == b"1"


@pytest.mark.parametrize(
    ("put", "got"),
    [
        ([b"1", b"2", b"3", b"4", b"5"], [None, b"4", b"5"]),
        ([b"1", b"2", None, b"4", b"5"], [None, b"4", b"5"]),
        ([b"1", b"2", b"3", None, b"5"], [None, b"5"]),
        ([b"1", None, None, b"2"], [b"1", None, b"2"]),
        ([b"x" * 600, b"y" * 600], [None, b"y" * 600]),
    ],
)
async def test_overflow_is_one_gap(put: list[bytes | None], got: list[bytes | None]) -> None:
    inbox = Owner().inbox()
    for entry in put:
        inbox.put(entry)
    assert await everything(inbox) == got


async def test_closing_ends_it_at_once_and_is_told_once() -> None:
    owner = Owner()
    inbox = owner.inbox()
    inbox.put(b"1")
    await inbox.aclose()
    await inbox.aclose()
    assert [entry async for entry in inbox] == []
    assert owner.left == [inbox]


async def test_closing_wakes_who_waits() -> None:
    inbox = Owner().inbox()
    first = asyncio.create_task(anext(inbox))
    await asyncio.sleep(0)
    await inbox.aclose()
    with pytest.raises(StopAsyncIteration):
        await first


async def test_the_end_of_the_bus_comes_after_what_waits_and_needs_no_goodbye() -> None:
    owner = Owner()
    inbox = owner.inbox()
    inbox.put(b"1")
    assert await everything(inbox) == [b"1"]
    await inbox.aclose()
    assert owner.left == []
