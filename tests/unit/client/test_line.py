"""Connections that are cut and made again: nothing is lost, nothing comes twice, nobody notices."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest

from fapstream.client import ServerError, connect, listen
from fapstream.protocol import generated as g
from fapstream.records import Packet
from fapstream.server import Address, running
from tests.e2e.link import Link
from tests.unit.client.test_connection import LONG, address, within, words
from tests.unit.fakes import FakeVoices, fake_app


@asynccontextmanager
async def over_a_link() -> AsyncIterator[tuple[str, Link]]:
    """The address of a server behind a link that can be cut."""
    async with (
        running(fake_app(FakeVoices()), Address()) as server,
        Link(address(server).removeprefix("ws://").removesuffix("/ws")) as link,
    ):
        yield f"ws://{link.address}/ws", link


async def test_a_turn_goes_on_over_another_connection() -> None:
    async with over_a_link() as (url, link), connect(url) as talker:
        turn = await talker.speak("This is the beginning and it ")
        got: list[Packet] = []
        cuts = 0
        async for event in turn:
            if not isinstance(event, Packet):
                continue
            assert event.start == sum(len(p.pcm) for p in got)
            got.append(event)
            if len(got) in (3, 20) and cuts < 2:
                cuts += 1
                link.cut()
                await turn.append(f"goes on {'once' if cuts == 1 else 'twice'} ")
                if cuts == 2:
                    await turn.end()
        assert talker.connections == 3
        assert words(got) == [
            "This",
            "is",
            "the",
            "beginning",
            "and",
            "it",
            "goes",
            "on",
            "once",
            "goes",
            "on",
            "twice",
        ]


async def test_what_was_not_sent_when_it_broke_is_sent_again() -> None:
    async with over_a_link() as (url, link), connect(url) as talker:
        link.cut()
        turns = [await talker.say(f"number {n}.") for n in ("one", "two")]
        for turn in turns:
            assert (await asyncio.wait_for(turn.finished(), 10)).reason == "end"


async def test_a_session_that_the_server_has_forgotten_is_told() -> None:
    async with over_a_link() as (url, link), connect(url) as talker:
        turn = await talker.say(LONG)
        talker._line.session.received += 1000  # so that nothing fits
        link.cut()
        with pytest.raises(ServerError) as caught:
            await within(10, turn.finished())
        assert caught.value.code == "connection_lost"


async def test_a_server_that_does_not_come_back_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(g, "LINGER_MS", 300)
    async with over_a_link() as (url, link):
        talking = connect(url)
        talker = await talking.__aenter__()
        turn = await talker.say(LONG)
        assert link._server
        link._server.close()
        link.cut()
        with pytest.raises(Exception):  # noqa: B017, PT011
            await within(10, turn.finished())
        await talking.__aexit__(None, None, None)


async def test_a_listener_whose_connection_breaks_misses_nothing() -> None:
    async with (
        over_a_link() as (url, link),
        listen(url, "news") as audience,
        connect(url, channel="news") as talker,
    ):
        turn = await talker.say("One two three four five six seven eight nine ten eleven twelve.")
        spoken = asyncio.create_task(_all(turn))
        got: list[Packet] = []
        async for event in audience:
            if isinstance(event, Packet):
                assert event.start == sum(len(p.pcm) for p in got)
                got.append(event)
                if len(got) == 10:
                    link.cut()
            if isinstance(event, g.Done):
                break
        assert sum(len(p.pcm) for p in got) == sum(len(p.pcm) for p in await spoken)
        assert words(got) == words(await spoken)


async def _all(turn: AsyncIterator[object]) -> list[Packet]:
    return [event async for event in turn if isinstance(event, Packet)]
