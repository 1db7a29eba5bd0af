"""A websocket as the rest of the server has it: writes that return at once, and what still waits to go."""

from __future__ import annotations

import asyncio
import socket as sockets
import struct
from contextlib import suppress
from typing import Protocol

from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed
from websockets.protocol import State

SEND_DEADLINE_S = 20.0
"""A client that takes nothing for so long is dropped."""

KERNEL_BYTES = 32_768
"""What the system may keep back for one connection: less than a second of sound, so that a listener that
takes too little is noticed in time."""

BINARY = 0x82
"""A whole binary message."""


def framed(data: bytes) -> bytes:
    """A message as it goes over the wire to any client (RFC 6455, 5.2): made once, written to many."""
    n = len(data)
    if n < 126:
        return bytes((BINARY, n)) + data
    return (struct.pack(">BBH", BINARY, 126, n) if n < 65_536 else struct.pack(">BBQ", BINARY, 127, n)) + data


class Link(Protocol):
    """One connection. What is written to a connection that is lost goes nowhere."""

    @property
    def backlog(self) -> int:
        """Bytes written and not yet taken by the system."""

    def write(self, data: bytes) -> None:
        """Send a message; returns at once."""

    def write_framed(self, frame: bytes) -> None:
        """Send what `framed` made of a message; returns at once."""

    def keep_little(self) -> None:
        """Have the system keep little back, so that `backlog` tells how slow the other side is."""

    async def drain(self) -> None:
        """Wait until little is waiting. Raises ConnectionClosed."""

    async def recv(self) -> bytes | str:
        """The next message. Raises ConnectionClosed."""

    async def close(self, code: int = 1000, reason: str = "") -> None:
        """Closing handshake; no harm if it is closed already."""


class WebSocketLink:
    """A Link over a connection of the `websockets` library. What is written within one turn of the event loop
    goes out together.
    """

    def __init__(self, socket: ServerConnection) -> None:
        self._socket = socket
        self._transport = socket.transport
        self._waiting: list[bytes] = []
        self.recv = socket.recv

    @property
    def backlog(self) -> int:
        """See Link."""
        return self._transport.get_write_buffer_size()

    def write(self, data: bytes) -> None:
        """See Link."""
        if not self._waiting:
            self._socket.loop.call_soon(self._flush)
        self._waiting.append(framed(data))

    def write_framed(self, frame: bytes) -> None:
        """See Link."""
        if self._waiting:
            self._waiting.append(frame)
        elif self._socket.protocol.state is State.OPEN:
            self._transport.write(frame)

    def _flush(self) -> None:
        frames, self._waiting = b"".join(self._waiting), []
        if self._socket.protocol.state is State.OPEN:
            self._transport.write(frames)

    def keep_little(self) -> None:
        """See Link."""
        raw = self._transport.get_extra_info("socket")
        with suppress(OSError, AttributeError):
            raw.setsockopt(sockets.SOL_SOCKET, sockets.SO_SNDBUF, KERNEL_BYTES)
        with suppress(OSError, AttributeError):  # not everywhere
            raw.setsockopt(sockets.IPPROTO_TCP, sockets.TCP_NOTSENT_LOWAT, KERNEL_BYTES // 2)

    async def drain(self) -> None:
        """See Link."""
        self._flush()
        await self._socket.drain()
        if self._socket.protocol.state is not State.OPEN:
            await self._socket.wait_closed()
            raise self._socket.protocol.close_exc

    async def close(self, code: int = 1000, reason: str = "") -> None:
        """See Link."""
        self._flush()
        with suppress(ConnectionClosed):
            await self._socket.close(code, reason)


async def drained(link: Link) -> None:
    """Wait until the link takes more. Raises ConnectionClosed, and TimeoutError if that takes too long."""
    async with asyncio.timeout(SEND_DEADLINE_S):
        await link.drain()
