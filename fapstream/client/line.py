"""A session's connection to its server, made again when it is lost."""

from __future__ import annotations

import asyncio
import random
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

from websockets.asyncio.client import ClientConnection
from websockets.asyncio.client import connect as dial
from websockets.exceptions import ConnectionClosed, WebSocketException
from websockets.typing import Subprotocol

from fapstream.errors import RemoteProtocolError
from fapstream.protocol import generated as g
from fapstream.protocol.session import ClientSession, ServerEvent

FIRST_RETRY_S = 0.1
LONGEST_RETRY_S = 2.0
PING_S = 10.0


class Line:
    """`first` gives the message that a connection begins with, asked anew for every one; `take` gets what
    comes.

    A connection that was lost is made again for as long as the server keeps the session; what is sent
    meanwhile goes once there is one.
    """

    def __init__(
        self, url: str, first: Callable[[], g.ClientMessage], take: Callable[[ServerEvent], None]
    ) -> None:
        self.session = ClientSession()
        self.connections = 0
        """Connections made so far."""
        self.reading = asyncio.Event()
        """Cleared, it takes nothing more: what the server sends waits there."""
        self.reading.set()
        self._url = url
        self._first = first
        self._take = take
        self._socket: ClientConnection | None = None
        self._caught_up = False

    async def send(self, message: g.ClientMessage) -> None:
        """Raises LocalProtocolError."""
        if isinstance(message, g.Ack) and message.received is None:
            message = replace(message, received=self.session.received)
        data = self.session.send(message)
        if self._socket and self._caught_up:
            with suppress(ConnectionClosed):
                await self._socket.send(data)

    async def run(self) -> BaseException | None:
        """Until the session is over; why, if that was nobody's wish. Raises nothing."""
        why = await self._once()
        while self.connections and self._may_return(why):
            wait_s, deadline = FIRST_RETRY_S, asyncio.get_running_loop().time() + g.LINGER_MS / 1000
            before = self.connections
            while self.connections == before:
                if asyncio.get_running_loop().time() > deadline:
                    return why
                await asyncio.sleep(wait_s * random.uniform(0.5, 1.0))
                wait_s = min(LONGEST_RETRY_S, 2 * wait_s)
                why = await self._once() or why
        return why

    def _may_return(self, why: BaseException | None) -> bool:
        session, ready = self.session, self.session.ready
        there = ready is not None and (ready.resume is not None or session.state == "listening")
        return there and session.state != "closed" and isinstance(why, ConnectionClosed)

    async def _once(self) -> BaseException | None:
        """One connection from beginning to end; why it ended."""
        try:
            socket = await dial(
                self._url, subprotocols=[Subprotocol(g.SUBPROTOCOL)], compression=None,
                max_size=g.MAX_MESSAGE_BYTES,
            )  # fmt: skip
        except (OSError, WebSocketException, TimeoutError) as e:
            return e
        self.connections += 1
        pinger = asyncio.create_task(self._ping(socket))
        try:
            async with socket:
                await self._talk(socket)
        except (ConnectionClosed, RemoteProtocolError) as e:
            return e
        finally:
            self._socket = None
            pinger.cancel()
        return None

    async def _talk(self, socket: ClientConnection) -> None:
        """Raises ConnectionClosed, RemoteProtocolError."""
        session = self.session
        self._socket, self._caught_up = socket, False
        if session.state != "opening":
            session.reconnect()
        await socket.send(session.send(self._first()))
        while session.state != "closed":
            await self.reading.wait()
            data = await socket.recv()
            if isinstance(data, str):
                raise RemoteProtocolError("messages are binary frames")
            for event in session.receive(data):
                if isinstance(event, g.Ready):
                    await self._catch_up(socket, event)
                self._take(event)

    async def _catch_up(self, socket: ClientConnection, ready: g.Ready) -> None:
        """Send what the server does not have, and what was said while that went."""
        has = ready.received or 0 if ready.resumed else 0
        while again := self.session.sent.after(has):
            for data in again:
                await socket.send(data)
            has += len(again)
        self._caught_up = True

    async def _ping(self, socket: ClientConnection) -> None:
        """Ask now and then what the server has, so that it need not be kept."""
        number = 0
        while True:
            await asyncio.sleep(PING_S)
            number += 1
            with suppress(ConnectionClosed):
                await socket.send(self.session.send(g.Ping(id=number)))
