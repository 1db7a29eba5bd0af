"""Several processes, and several machines, as one server."""

from __future__ import annotations

import asyncio

import pytest

from fapstream.client import Audience, Talker, connect, listen
from fapstream.protocol import generated as g
from fapstream.records import Packet
from tests.benchmarks.broker import Broker, broker, installed
from tests.e2e.link import Link
from tests.e2e.servers import serving

TEXT = "One two three four five six seven eight nine ten. "


async def heard(audience: Audience) -> tuple[int, list[str]]:
    """Samples of the next turn, and the reasons of what was skipped."""
    samples, skips = 0, list[str]()
    async for event in audience:
        if isinstance(event, Packet):
            samples += len(event.pcm)
        elif isinstance(event, g.Skip):
            skips.append(event.reason)
        elif isinstance(event, g.Done):
            return samples, skips
    raise AssertionError("the talk broke off")


async def spoken(talker: Talker, text: str = TEXT) -> int:
    return (await (await talker.say(text)).finished()).samples


async def test_listeners_hear_speakers_of_every_worker() -> None:
    async with serving("--workers", "2", "--channel", "news") as server:
        for _ in range(4):
            async with (
                listen(server.url, "news") as a,
                listen(server.url, "news") as b,
                connect(server.url, channel="news") as talker,
            ):
                tasks = [asyncio.create_task(heard(audience)) for audience in (a, b)]
                await asyncio.sleep(0.3)
                samples = await spoken(talker)
                for task in tasks:
                    assert await asyncio.wait_for(task, 10) == (samples, [])


async def test_a_session_is_found_again_whichever_worker_answers() -> None:
    async with (
        serving("--workers", "3") as server,
        Link(server.address) as link,
        connect(f"ws://{link.address}/ws") as talker,
    ):
        turn = await talker.say(TEXT * 3)
        samples, packets = 0, 0
        async for event in turn:
            if isinstance(event, Packet):
                assert event.start == samples
                samples += len(event.pcm)
                packets += 1
                await talker.acknowledge(turn, event.start)
                if packets in (5, 40, 80, 120):
                    link.cut()
        assert turn.done
        assert turn.done.samples == samples
        assert talker.connections == 5


@pytest.mark.skipif(not installed(), reason="redis-server is not installed")
async def test_a_channel_through_redis_that_goes_down_and_comes_back() -> None:
    with broker() as redis:
        redis.start()
        await _through(redis)


async def _through(redis: Broker) -> None:
    options = ("--channel", "news", "--bus", redis.url)
    async with serving(*options) as here, serving(*options) as there:  # noqa: SIM117
        async with listen(there.url, "news") as audience, connect(here.url, channel="news") as talker:
            listening = asyncio.create_task(heard(audience))
            await asyncio.sleep(0.5)
            assert await spoken(talker) == (await asyncio.wait_for(listening, 10))[0]
            listening = asyncio.create_task(heard(audience))
            turn = await talker.say(TEXT * 4)
            finished = asyncio.create_task(turn.finished())
            await asyncio.sleep(3)
            redis.kill()
            await asyncio.sleep(1.5)
            redis.start()
            done = await asyncio.wait_for(finished, 60)
            samples, skips = await asyncio.wait_for(listening, 30)
            assert done.reason == "end", "the speaker is not harmed"
            lost_s = (done.samples - samples) / 16000
            assert 0 <= lost_s < 5, "no more than the live edge is lost"
            assert lost_s == 0 or "bus" in skips, "the listener is told"
