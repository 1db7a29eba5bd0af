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
from fapstream.server.connection import Connection
from fapstream.server.link import framed
from fapstream.server.lobby import Lobby
from fapstream.server.service import Service
from fapstream.tts import Manner
from tests.unit.fakes import FakeBus, FakeVoices, LoopClock, OpenGate

M = TypeVar("M")

HEADERS = {2: 125, 4: 65_535, 10: 1 << 62}
"""Bytes of a frame's header -> the longest message it stands before."""


def unframed(frame: bytes) -> bytes:
    """The message in a frame."""
    for header, most in HEADERS.items():
        if len(frame) - header <= most and framed(frame[header:]) == frame:
            return frame[header:]
    raise AssertionError("no frame")


class FakeLink:
    """The server's end of a connection; the test holds the other one."""

    def __init__(self) -> None:
        self.to_server: asyncio.Queue[bytes | str | None] = asyncio.Queue()
        self.to_client: asyncio.Queue[bytes] = asyncio.Queue()
        self.closed: tuple[int, str] | None = None
        self.backlog = 0
        """What a test says that is waiting."""
        self.reads = asyncio.Event()
        self.reads.set()

    async def recv(self) -> bytes | str:
        if self.closed:
            raise ConnectionClosedOK(None, None)
        data = await self.to_server.get()
        if data is None:
            self.closed = self.closed or (1006, "")
            raise ConnectionClosedError(None, None)
        return data

    def write(self, data: bytes) -> None:
        if not self.closed:
            self.to_client.put_nowait(data)

    def write_framed(self, frame: bytes) -> None:
        self.write(unframed(frame))

    def keep_little(self) -> None:
        pass

    async def drain(self) -> None:
        await self.reads.wait()
        if self.closed:
            raise ConnectionClosedOK(None, None)

    async def close(self, code: int = 1000, reason: str = "") -> None:
        if self.closed is None:
            self.closed = (code, reason)
            self.to_server.put_nowait(None)

    def cut(self) -> None:
        """The connection is lost."""
        self.to_server.put_nowait(None)

    def stuck(self) -> None:
        """The other side takes nothing from now on."""
        self.backlog = 1 << 20
        self.reads.clear()


class World:
    """A server without sockets."""

    def __init__(
        self, voices: FakeVoices, manner: Manner | None = None, channels: tuple[str, ...] = ("news",)
    ) -> None:
        self.voices = voices
        self.bus = FakeBus()
        self.gate = OpenGate()
        service = Service(voices, LoopClock(), lambda: ("generic",))
        self.service = replace(service, manner=manner) if manner else service
        self.lobby = Lobby(self.service, self.bus, channels)
        self.lobby.open()


class Peer:
    """A client that says exactly what it is told to."""

    def __init__(self, voices: FakeVoices, manner: Manner | None = None, world: World | None = None) -> None:
        self.socket = FakeLink()
        self.voices = voices
        self.world = world or World(voices, manner)
        w = self.world
        self.connection = Connection(self.socket, "127.0.0.1", w.service, w.lobby, w.gate)
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

    async def gone(self) -> None:
        """The connection is lost, and nobody comes back in time."""
        self.socket.cut()
        await asyncio.wait_for(self.running, 60)
        await asyncio.sleep(g.LINGER_MS / 1000 + 1)


@asynccontextmanager
async def peer(
    fail: Callable[[str], None] | None = None, manner: Manner | None = None, **hello: Any
) -> AsyncIterator[Peer]:
    """A client that has said hello; afterwards nothing of it may be left."""
    made = Peer(FakeVoices(fail), manner)
    made.send(g.Hello(**hello))
    assert isinstance(await made.next(), g.Ready)
    yield made
    await made.gone()
    assert made.world.gate.inside == 0
    assert all(v.closes == 1 for v in made.voices.acquired), "every voice is given back once"
