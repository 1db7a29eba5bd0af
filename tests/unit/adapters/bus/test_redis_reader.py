"""Reading streams of a server that comes and goes."""

from __future__ import annotations

from typing import Any

import pytest
from redis.exceptions import ConnectionError as Away

from fapstream.adapters.bus.channels import BACKLOG_BYTES, BACKLOG_ENTRIES, MAX_ENTRY
from fapstream.adapters.bus.following import Following
from fapstream.adapters.bus.inbox import Inbox
from fapstream.adapters.bus.numbers import Numbers
from fapstream.adapters.bus.redis_reader import READ_CHANNELS, START, Reader
from fapstream.adapters.bus.redis_writer import FIELD, STREAM_ENTRIES, key_of
from tests.unit.adapters.bus.fake_redis import FakeRedis


class Desk:
    """A reader with its server, and a publisher that never fails."""

    def __init__(self) -> None:
        self.server = FakeRedis()
        self.following = Following(lambda c: self.reader.want(c), lambda c: self.reader.unwant(c))
        self.reader = Reader(self.server.redis, b"bell", self.following)
        self.numbers = Numbers()

    def publish(self, *entries: bytes, channel: str = "a") -> None:
        for entry in entries:
            self.server.add(key_of(channel), {FIELD: self.numbers.stamp(channel, entry)})

    async def steps(self, count: int = 3) -> None:
        """Begin, look up, follow."""
        for _ in range(count):
            await self.reader.step()

    async def fail(self) -> None:
        self.server.away = True
        with pytest.raises(Away):
            await self.reader.step()
        self.server.away = False

    async def all(self, inbox: Inbox) -> list[bytes | None]:
        inbox.end()
        return [entry async for entry in inbox]


def numbered(first: int, end: int) -> list[bytes]:
    return [b"%d" % number for number in range(first, end)]


async def test_the_backlog_and_then_what_follows() -> None:
    desk = Desk()
    desk.publish(*numbered(0, BACKLOG_ENTRIES + 10))
    inbox = desk.following.subscribe("a")
    await desk.steps(2)
    desk.publish(b"110", b"111")
    await desk.steps(1)
    assert await desk.all(inbox) == numbered(10, 112)
    assert desk.server.ranges == [(key_of("a"), BACKLOG_ENTRIES)]


async def test_a_backlog_of_large_entries_is_short() -> None:
    desk = Desk()
    desk.publish(*(bytes([k]) * (BACKLOG_BYTES // 3) for k in range(5)))
    inbox = desk.following.subscribe("a")
    await desk.steps()
    assert [entry[0] for entry in await desk.all(inbox) if entry] == [3, 4]


async def test_an_empty_stream_is_followed_from_its_first_entry() -> None:
    desk = Desk()
    inbox = desk.following.subscribe("a")
    await desk.steps()
    desk.publish(b"0")
    await desk.steps(1)
    assert await desk.all(inbox) == [b"0"]


async def test_a_server_that_lost_its_memory_and_whose_ids_go_back() -> None:
    desk = Desk()
    desk.server.next_id = 1_000_000
    inbox = desk.following.subscribe("a")
    desk.publish(b"0", b"1")
    await desk.steps()
    desk.publish(b"2")  # which nobody read
    desk.server.restart()
    await desk.fail()
    desk.publish(b"3")
    await desk.steps()
    desk.publish(b"4")
    await desk.steps(1)
    assert await desk.all(inbox) == [b"0", b"1", None, b"3", b"4"]


async def test_a_connection_that_was_lost_costs_nothing_that_the_stream_still_holds() -> None:
    desk = Desk()
    inbox = desk.following.subscribe("a")
    desk.publish(b"0")
    await desk.steps()
    desk.publish(*numbered(1, 200))
    await desk.fail()
    await desk.steps()
    desk.publish(b"200")
    await desk.steps(1)
    assert await desk.all(inbox) == numbered(0, 201)
    assert desk.server.ranges[-1] == (key_of("a"), STREAM_ENTRIES)


async def test_what_was_trimmed_before_it_was_read_is_a_gap() -> None:
    desk = Desk()
    inbox = desk.following.subscribe("a")
    desk.publish(b"0")
    await desk.steps()
    desk.publish(*numbered(1, 10))
    del desk.server.streams[key_of("a")][:5]
    await desk.steps(1)
    assert await desk.all(inbox) == [b"0", None, *numbered(5, 10)]


async def test_the_bell_ends_a_read_once() -> None:
    desk = Desk()
    desk.following.subscribe("a")
    await desk.steps()
    desk.server.add(b"bell", {FIELD: b""})
    await desk.steps(2)
    assert [read[b"bell"] for read in desk.server.reads] == [START, START, b"1-0"]


async def test_many_channels_are_looked_up_in_turns() -> None:
    desk = Desk()
    for number in range(READ_CHANNELS + 1):
        desk.following.subscribe(f"c{number}")
    await desk.steps(2)
    assert len(desk.server.ranges) == READ_CHANNELS
    await desk.steps(2)
    assert len(desk.server.reads[0]) == 1 + READ_CHANNELS + 1


async def test_a_subscription_is_not_given_what_was_read_for_an_earlier_one() -> None:
    """Its own look-up brings the same, in order."""
    desk = Desk()
    inboxes = [desk.following.subscribe("a")]
    desk.publish(*numbered(0, 3))
    await desk.steps(2)
    desk.publish(*numbered(3, 6))
    read = desk.server.xread

    async def meanwhile(ids: dict[bytes, bytes], count: int, block: int) -> list[Any]:
        answer = await read(ids, count, block)
        await inboxes[0].aclose()
        inboxes.append(desk.following.subscribe("a"))
        return answer

    desk.server.xread = meanwhile  # type: ignore[method-assign]
    await desk.steps(1)
    desk.server.xread = read  # type: ignore[method-assign]
    desk.publish(b"6")
    await desk.steps(2)
    assert await desk.all(inboxes[1]) == numbered(0, 7)


@pytest.mark.parametrize(
    "fields", [{}, {b"x": b"1"}, {FIELD: b"short"}, {FIELD: 7}, {FIELD: bytes(MAX_ENTRY + 17)}]
)
@pytest.mark.parametrize("late", [False, True])
async def test_what_somebody_else_wrote_there_is_left_out(fields: dict[bytes, object], late: bool) -> None:
    desk = Desk()
    desk.publish(b"0")
    if not late:
        inbox = desk.following.subscribe("a")
        await desk.steps()
    desk.server.add(key_of("a"), fields)
    desk.publish(b"1")
    if late:
        inbox = desk.following.subscribe("a")
    await desk.steps()
    got = await desk.all(inbox)
    assert got[-1] == b"1"
    assert got in ([b"0", b"1"], [b"1"])
    assert late or got == [b"0", b"1"]
