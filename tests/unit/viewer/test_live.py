"""Turns of a real server on a loopback port, with voices made of arithmetic."""

from __future__ import annotations

import asyncio
import os
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from itertools import pairwise

import numpy as np
import pytest

from fapstream.client import ServerError, connect
from fapstream.errors import InputError
from fapstream.protocol import generated as g
from fapstream.records import Packet
from fapstream.server import Address, running
from fapstream.viewer import live
from fapstream.viewer.live import ConnectionLost, Wish, collect, perform
from tests.unit.fakes import Failing, FakeVoices, fake_app

LONG = "This is said for quite a while, and then for longer. " * 6


@asynccontextmanager
async def served(fail: Callable[[str], None] | None = None) -> AsyncIterator[str]:
    async with running(fake_app(FakeVoices(fail)), Address()) as server:
        yield f"ws://127.0.0.1:{server.sockets[0].getsockname()[1]}/ws"


class Stage:
    """A show that hears everything the moment it comes."""

    def __init__(self) -> None:
        self.told: list[object] = []
        self.samples = 0
        self.over = asyncio.Event()

    def begin(self, turn: int, sample_rate: int, live: bool = False) -> None:
        self.told.append(("begin", turn, sample_rate))
        self.live = live

    def close(self) -> None:
        self.told.append("close")

    def discard(self, turn: int, sample: int) -> None:
        self.told.append(("discard", turn))
        self.samples = min(self.samples, sample)

    def pause(self, on: bool) -> None:
        self.told.append(("pause", on))

    def push(self, packet: Packet) -> None:
        assert packet.start == self.samples
        self.samples += len(packet.pcm)

    def end(self, turn: int) -> None:
        self.told.append(("end", turn))
        self.over.set()

    def ack(self, turn: int) -> g.Ack:
        return g.Ack(turn=turn, sample=self.samples, queue=0, underruns=0, skew=0)


async def test_a_turn_is_collected_whole_and_faster_than_it_is_heard() -> None:
    async with served() as url:
        began = time.monotonic()
        clip = await collect(Wish(url, LONG))
        took = time.monotonic() - began
    assert clip.samples / clip.sample_rate > 2 * took
    assert len(clip.pcm) > 5 * clip.sample_rate
    assert all(b.sample - a.sample == clip.sample_rate // 25 for a, b in pairwise(clip.frames))
    assert clip.faces_end - len(clip.pcm) <= clip.sample_rate // 25
    assert np.ptp([frame.values[3] for frame in clip.frames]) > 50, "the lips move"


async def test_nothing_to_say_is_no_fault() -> None:
    async with served() as url:
        assert (await collect(Wish(url, ""))).samples == 0


async def test_a_turn_is_performed_and_the_connection_stays() -> None:
    async with served() as url:
        stage = Stage()
        task = asyncio.create_task(perform(Wish(url, "Hello there."), stage))  # type: ignore[arg-type]
        async with asyncio.timeout(10):
            await stage.over.wait()
        await asyncio.sleep(0.05)
        assert not task.done()
        assert stage.told == [("begin", 1, 16_000), ("end", 1)]
        assert stage.samples > 8000
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


async def test_stdin_is_said_as_it_arrives(monkeypatch: pytest.MonkeyPatch) -> None:
    read, write = os.pipe()
    chunks = live.chunks
    monkeypatch.setattr(live, "chunks", lambda: chunks(read))
    async with served() as url:
        task = asyncio.create_task(collect(Wish(url, "-")))
        os.write(write, b"Hel")
        await asyncio.sleep(0.05)
        os.write(write, "lo there, καλημέρα.".encode())
        os.close(write)
        clip = await asyncio.wait_for(task, 10)
        whole = await collect(Wish(url, "Hello there, καλημέρα."))
    os.close(read)
    assert np.array_equal(clip.pcm, whole.pcm)


async def test_what_goes_wrong_is_said() -> None:
    with pytest.raises(ConnectionLost, match=r"no connection to ws://127\.0\.0\.1:9/ws: .+fapstream serve"):
        await collect(Wish("ws://127.0.0.1:9/ws", "x"))
    with pytest.raises(InputError, match="'localhost' is no address"):
        await collect(Wish("localhost", "x"))
    async with served() as url:
        with pytest.raises(ConnectionLost, match=r"HTTP 404; a server's address ends in /ws"):
            await collect(Wish(f"{url}/else", "x"))
        with pytest.raises(ServerError, match="no voice called 'nobody'"):
            await collect(Wish(url, "x", voice="nobody"))
    async with served(Failing("speech")) as url:
        with pytest.raises(ServerError, match="the voice broke"):
            await collect(Wish(url, LONG))


async def test_a_server_that_goes_away_is_noticed() -> None:
    async with served() as url:
        task = asyncio.create_task(perform(Wish(url), Stage()))  # type: ignore[arg-type]
        await asyncio.sleep(0.3)
        assert not task.done()
    with pytest.raises((ConnectionLost, ServerError)):
        await asyncio.wait_for(task, 5)


async def test_what_is_spoken_into_a_channel_is_shown() -> None:
    async with served() as url, connect(url, channel="news") as talker:
        stage = Stage()
        showing = asyncio.create_task(perform(Wish(url, channel="news"), stage))  # type: ignore[arg-type]
        await asyncio.sleep(0.3)
        turn = await talker.say("One two three four five six seven eight nine ten.")
        await asyncio.sleep(0.3)
        await turn.pause()
        await turn.go_on()
        await turn.splice(3, " and that is all. ")
        await turn.end()
        done = await turn.finished()
        await asyncio.wait_for(stage.over.wait(), 10)
        assert stage.samples == done.samples
        assert stage.live
        kinds = [told[0] for told in stage.told if isinstance(told, tuple)]
        assert kinds == ["begin", "pause", "pause", "discard", "end"]
        showing.cancel()
