"""The hub alone, spoken to by bare sockets."""

from __future__ import annotations

import asyncio
import stat
from collections.abc import AsyncIterator
from pathlib import Path

import pytest_asyncio

from fapstream.adapters.bus.channels import BACKLOG_ENTRIES
from fapstream.adapters.bus.frames import Frame, Kind, Parser, packed
from fapstream.adapters.bus.hub import Hub
from tests.unit.adapters.bus.waits import PATIENCE_S, until


@pytest_asyncio.fixture
async def hub() -> AsyncIterator[Hub]:
    made = Hub()
    await made.start()
    yield made
    await made.aclose()


class Bare:
    """A process that is only a socket."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader = reader
        self.writer = writer
        self._parser = Parser()
        self._frames: list[Frame] = []

    @classmethod
    async def connected(cls, hub: Hub) -> Bare:
        return cls(*await asyncio.open_unix_connection(hub.path))

    def send(self, kind: Kind, channel: str, body: bytes = b"") -> None:
        self.writer.write(packed(kind, channel, body))

    async def next(self) -> tuple[int, str, bytes]:
        async with asyncio.timeout(PATIENCE_S):
            while not self._frames:
                self._frames += self._parser.feed(await self.reader.read(1 << 16))
        frame = self._frames.pop(0)
        return frame.kind, frame.channel, frame.body

    async def joined(self, channel: str) -> None:
        self.send(Kind.SUBSCRIBE, channel)
        assert await self.next() == (Kind.SUBSCRIBE, channel, b"")

    def close(self) -> None:
        self.writer.close()


async def test_its_folder_is_private_and_goes_with_it() -> None:
    hub = Hub()
    folder = Path(hub.path).parent
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    await hub.start()
    await hub.aclose()
    assert not folder.exists()


async def test_it_begins_anew_at_the_same_place(tmp_path: Path) -> None:
    path = str(tmp_path / "bus")
    for _ in range(2):
        hub = Hub(path)
        await hub.start()
        (await Bare.connected(hub)).close()
        await hub.aclose()


async def test_entries_go_to_those_who_subscribe_and_to_their_publisher(hub: Hub) -> None:
    one, two, other = [await Bare.connected(hub) for _ in range(3)]
    await one.joined("a")
    await two.joined("a")
    await other.joined("b")
    one.send(Kind.ENTRY, "a", b"1")
    one.send(Kind.ENTRY, "b", b"2")
    assert await one.next() == await two.next() == (Kind.ENTRY, "a", b"1")
    assert await other.next() == (Kind.ENTRY, "b", b"2")
    for each in (one, two, other):
        each.close()


async def test_the_answer_then_the_backlog_then_the_live_entries(hub: Hub) -> None:
    one, two = await Bare.connected(hub), await Bare.connected(hub)
    await one.joined("a")
    for number in range(BACKLOG_ENTRIES + 5):
        one.send(Kind.ENTRY, "a", b"%d" % number)
    for number in range(BACKLOG_ENTRIES + 5):
        assert (await one.next())[2] == b"%d" % number
    await two.joined("a")
    one.send(Kind.ENTRY, "a", b"live")
    got = [(await two.next())[2] for _ in range(BACKLOG_ENTRIES + 1)]
    assert got == [b"%d" % number for number in range(5, BACKLOG_ENTRIES + 5)] + [b"live"]
    one.close()
    two.close()


async def test_who_left_gets_no_more(hub: Hub) -> None:
    one = await Bare.connected(hub)
    await one.joined("a")
    await one.joined("b")
    one.send(Kind.UNSUBSCRIBE, "a")
    one.send(Kind.ENTRY, "a", b"1")
    one.send(Kind.ENTRY, "b", b"2")
    assert await one.next() == (Kind.ENTRY, "b", b"2")
    one.close()


async def test_one_that_talks_nonsense_is_dropped_alone(hub: Hub) -> None:
    one, two = await Bare.connected(hub), await Bare.connected(hub)
    await two.joined("a")
    one.writer.write(bytes(8))
    assert await one.reader.read() == b""
    two.send(Kind.ENTRY, "a", b"1")
    assert await two.next() == (Kind.ENTRY, "a", b"1")
    one.close()
    two.close()


async def test_one_that_reads_nothing_holds_up_nobody_and_costs_a_bounded_amount(hub: Hub) -> None:
    """Forty megabytes, of which the sleeper reads nothing until the end: then the newest are there."""
    sleeper, awake = await Bare.connected(hub), await Bare.connected(hub)
    await sleeper.joined("a")
    await awake.joined("a")
    count, body = 400, bytes(100_000)
    for number in range(count):
        awake.send(Kind.ENTRY, "a", b"%d " % number + body)
        assert (await awake.next())[2].startswith(b"%d " % number)
    seen = []
    while not seen or seen[-1] != count - 1:
        seen.append(int((await sleeper.next())[2].split(b" ")[0]))
    assert seen == sorted(set(seen))
    assert len(seen) * len(body) < 25_000_000
    sleeper.close()
    awake.close()


async def test_who_is_gone_is_forgotten(hub: Hub) -> None:
    one, two = await Bare.connected(hub), await Bare.connected(hub)
    await one.joined("a")
    await two.joined("a")
    one.close()
    await until(lambda: len(hub._joined) == 1)
    two.send(Kind.ENTRY, "a", b"1")
    assert (await two.next())[2] == b"1"
    two.close()
