"""Listening for programs."""

from __future__ import annotations

import pytest

import fapstream
from fapstream.client import ServerError, connect, listen
from fapstream.protocol import generated as g
from fapstream.records import Packet
from tests.unit.client.test_connection import served, within, words


async def test_what_is_spoken_into_a_channel_is_heard() -> None:
    async with served() as url, listen(url, "news") as audience, connect(url, channel="news") as talker:
        await talker.say("Hello all of you.")
        got: list[Packet] = []
        async for event in audience:
            if isinstance(event, Packet):
                got.append(event)
            if isinstance(event, g.Done):
                break
        assert words(got) == ["Hello", "all", "of", "you"]
        await audience.acknowledge(g.Ack(turn=1, sample=5, queue=0, underruns=0, skew=0))


async def test_a_session_can_be_shared() -> None:
    async with served() as url, connect(url, share=True) as talker:
        assert talker.ready.channel
        async with listen(url, talker.ready.channel) as audience:
            await talker.say("Hello.")
            kinds = []
            async for event in audience:
                kinds.append(type(event))
                if isinstance(event, g.Done):
                    break
            assert kinds[0] is g.Live
            assert g.Begin in kinds


async def test_a_program_that_does_not_look_is_a_slow_listener(monkeypatch: pytest.MonkeyPatch) -> None:
    """No more is kept for it than it can be expected to look at; then it goes on."""
    monkeypatch.setattr("fapstream.client.audience.MOST_EVENTS", 20)
    async with served() as url, listen(url, "news") as audience, connect(url, channel="news") as talker:
        turn = await talker.say("One two three four five six seven.")
        done = await within(20, turn.finished())
        assert done.samples > 40 * 640
        assert audience._events.qsize() == 20
        samples, skipped = 0, False
        async for event in audience:
            if isinstance(event, Packet):
                samples += len(event.pcm)
            skipped = skipped or isinstance(event, g.Skip)
            if isinstance(event, g.Done):
                break
        assert 20 * 640 < samples <= done.samples
        assert skipped or samples == done.samples


async def test_a_channel_that_is_none() -> None:
    async with served() as url:
        with pytest.raises(ServerError, match="no channel called"):
            async with listen(url, "olds"):
                pass


async def test_a_server_that_goes_down_is_told() -> None:
    async with served() as url:
        hearing = listen(url, "news")
        audience = await hearing.__aenter__()
        events = aiter(audience)
        await anext(events)
    with pytest.raises(ServerError, match="going down"):
        await within(5, anext(events))
    await hearing.__aexit__(None, None, None)


def test_it_is_part_of_the_packages_face() -> None:
    assert fapstream.listen is listen
