"""A session resumed through another worker process than the one that has it, over real sockets."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path

import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.typing import Subprotocol

from fapstream.adapters.clock import MonotonicClock
from fapstream.protocol import generated as g
from fapstream.protocol.codec import decode, encode
from fapstream.server import Address, App, Lobby, Service, Site, running
from fapstream.server.handover import hand_over, socket_of
from fapstream.server.link import Link
from tests.unit.fakes import FakeBus, FakeVoices, OpenGate

TEXT = b"one two three four five six seven eight nine ten eleven twelve. " * 4


def worker(folder: Path, index: int, gate: OpenGate) -> App:
    service = Service(FakeVoices(), MonotonicClock(), lambda: ("generic",))
    app = App(service, Site(), Lobby(service, FakeBus(), (), index), gate)
    app.hand_over = partial(_over, folder)
    return app


async def _over(folder: Path, link: Link, first: bytes, index: int, address: str) -> bool:
    return await hand_over(link, first, socket_of(folder, index), address)


@asynccontextmanager
async def two_workers(folder: Path) -> AsyncIterator[tuple[str, str, OpenGate]]:
    gate = OpenGate()
    async with (
        running(worker(folder, 0, gate), Address(private=socket_of(folder, 0))) as a,
        running(worker(folder, 1, gate), Address(private=socket_of(folder, 1))) as b,
    ):
        ports = [s.sockets[0].getsockname()[1] for s in (a, b)]
        yield f"ws://127.0.0.1:{ports[0]}/ws", f"ws://127.0.0.1:{ports[1]}/ws", gate


async def dial(url: str, hello: g.Hello) -> tuple[ClientConnection, g.Ready]:
    socket = await connect(url, subprotocols=[Subprotocol(g.SUBPROTOCOL)], compression=None)
    await socket.send(encode(hello))
    ready = await receive(socket)
    assert isinstance(ready, g.Ready)
    return socket, ready


async def receive(socket: ClientConnection) -> g.Message | None:
    data = await asyncio.wait_for(socket.recv(), 5)
    assert isinstance(data, bytes)
    return decode(data, "server")


async def test_a_session_goes_on_through_another_worker(tmp_path: Path) -> None:
    async with two_workers(tmp_path) as (first, second, gate):
        socket, ready = await dial(first, g.Hello())
        assert ready.resume
        assert ready.resume.startswith("0.")
        await socket.send(encode(g.Speak(turn=1, text=TEXT)))
        await socket.send(encode(g.End(turn=1)))
        had = [await receive(socket) for _ in range(10)]
        socket.transport.abort()
        again, welcome = await dial(second, g.Hello(resume=ready.resume, received=10))
        assert welcome.resumed
        packets = [m for m in had if isinstance(m, g.Packet)]
        while not isinstance(message := await receive(again), g.Done):
            assert isinstance(message, g.Packet)
            packets.append(message)
            await again.send(encode(g.Ack(turn=1, sample=message.sample, queue=0, underruns=0, skew=0)))
        ends = [p.sample + len(p.pcm) for p in packets if p.pcm is not None]
        assert [p.sample for p in packets] == [0, *ends[:-1]]
        await again.send(encode(g.Bye()))
        await again.wait_closed()
        await asyncio.sleep(0.1)
        assert gate.inside == 0


@pytest.mark.parametrize("key", ["1.unknown", "7.gone", "0.unknown"])
async def test_a_session_that_nobody_has_begins_anew(tmp_path: Path, key: str) -> None:
    async with two_workers(tmp_path) as (first, _, _gate):
        socket, ready = await dial(first, g.Hello(resume=key, received=5))
        assert not ready.resumed
        await socket.close()


async def test_a_worker_that_is_not_there(tmp_path: Path) -> None:
    class Nobody:
        """A link that must not be used."""

    assert not await hand_over(Nobody(), b"", tmp_path / "none.sock", "a")  # type: ignore[arg-type]
