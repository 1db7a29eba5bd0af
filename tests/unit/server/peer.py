"""A client that says exactly what a test tells it to, joined to the server's half by two queues."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import replace
from typing import Any, TypeVar

from websockets.exceptions import ConnectionClosedError, ConnectionClosedOK

from fapstream.protocol import generated as g
from fapstream.protocol.codec import decode, encode
from fapstream.server.connection import Connection, Service
from fapstream.tts import Manner
from tests.unit.fakes import FakeVoices, LoopClock

M = TypeVar("M")


class FakeSocket:
    """The server's socket; the test holds the other end."""

    def __init__(self) -> None:
        self.to_server: asyncio.Queue[bytes | str | None] = asyncio.Queue()
        self.to_client: asyncio.Queue[bytes] = asyncio.Queue()
        self.closed: tuple[int, str] | None = None
        self.reads = asyncio.Event()
        self.reads.set()

    async def recv(self) -> bytes | str:
        if self.closed:
            raise ConnectionClosedOK(None, None)
        data = await self.to_server.get()
        if data is None:
            raise ConnectionClosedError(None, None)
        return data

    async def send(self, message: bytes) -> None:
        if self.closed:
            raise ConnectionClosedOK(None, None)
        await self.reads.wait()
        self.to_client.put_nowait(message)

    async def close(self, code: int = 1000, reason: str = "") -> None:
        if self.closed is None:
            self.closed = (code, reason)
            self.to_server.put_nowait(None)


class Peer:
    """A client that says exactly what it is told to."""

    def __init__(self, voices: FakeVoices, manner: Manner | None = None) -> None:
        self.socket = FakeSocket()
        self.voices = voices
        service = Service(voices, LoopClock(), lambda: ("generic",))
        if manner:
            service = replace(service, manner=manner)
        self.connection = Connection(self.socket, service)
        self.running = asyncio.create_task(self.connection.run())

    def send(self, *messages: g.ClientMessage) -> None:
        for message in messages:
            self.socket.to_server.put_nowait(encode(message))

    def raw(self, data: bytes | str) -> None:
        self.socket.to_server.put_nowait(data)

    async def next(self) -> Any:
        """Whatever comes next, within a minute."""
        return decode(await asyncio.wait_for(self.socket.to_client.get(), 60), "server")

    async def until(self, kind: type[M], turn: int | None = None) -> M:
        """The next message of that kind (and turn); what comes before it is thrown away."""
        while True:
            message = await self.next()
            if isinstance(message, kind) and (turn is None or getattr(message, "turn", None) == turn):
                return message

    async def rest_of_turn(self, turn: int) -> tuple[list[g.Packet], g.Done]:
        packets: list[g.Packet] = []
        while True:
            message = await self.next()
            if isinstance(message, g.Packet) and message.turn == turn:
                packets.append(message)
            if isinstance(message, g.Done) and message.turn == turn:
                return packets, message

    def quiet(self) -> bool:
        return self.socket.to_client.empty()


@asynccontextmanager
async def peer(
    fail: Callable[[str], None] | None = None, manner: Manner | None = None, **hello: Any
) -> AsyncIterator[Peer]:
    """A client that has said hello; afterwards nothing of it may be left."""
    made = Peer(FakeVoices(fail), manner)
    made.send(g.Hello(**hello))
    assert isinstance(await made.next(), g.Ready)
    yield made
    made.socket.to_server.put_nowait(None)
    await asyncio.wait_for(made.running, 60)
    await asyncio.sleep(1)
    assert all(v.closes == 1 for v in made.voices.acquired), "every voice is given back once"
