"""One connection from its first message to its end: joined to a conversation, or to a channel."""

from __future__ import annotations

import asyncio
import logging
import secrets
from collections.abc import Awaitable, Callable
from dataclasses import replace
from typing import Protocol

from websockets.exceptions import ConnectionClosed

from fapstream.errors import FapstreamError, RemoteProtocolError
from fapstream.protocol import generated as g
from fapstream.protocol.codec import encode
from fapstream.protocol.session import ServerSession
from fapstream.server.conversation import Conversation
from fapstream.server.link import Link
from fapstream.server.listener import Listening
from fapstream.server.lobby import Lobby
from fapstream.server.service import Service, ready

log = logging.getLogger("fapstream.server")

Leave = Callable[[], None]


class Gate(Protocol):
    """Who may come in. What is returned is called when it is over."""

    def open(self, address: str) -> Leave:
        """A connection that has not said what it comes for. Raises Busy."""

    def speak(self, hello: g.Hello, address: str) -> Leave:
        """Raises NotAuthorised, Busy."""

    def listen(self, wish: g.Listen, address: str) -> Leave:
        """Raises NotAuthorised, Busy."""

    def pace(self) -> Callable[[int], float]:
        """For one connection: seconds to wait before the next message is read after one of so many bytes."""


HandOver = Callable[[Link, bytes, int, str], Awaitable[bool]]
"""Joins a client to another process; False if that is not there."""


async def nowhere(link: Link, first: bytes, index: int, address: str) -> bool:
    """There is no other process."""
    return False


class Connection:
    """Runs one client until it leaves, is lost or breaks the contract."""

    def __init__(
        self,
        link: Link,
        address: str,
        service: Service,
        lobby: Lobby,
        gate: Gate,
        hand_over: HandOver = nowhere,
    ) -> None:
        self._link = link
        self._address = address
        self._service = service
        self._lobby = lobby
        self._gate = gate
        self._hand_over = hand_over
        self._pace = gate.pace()
        self._session = ServerSession()

    async def run(self) -> None:
        """Returns when the connection is over; never raises for what the client did."""
        try:
            leave = self._gate.open(self._address)
            try:
                async with asyncio.timeout(g.HELLO_DEADLINE_MS / 1000):
                    first, data = await self._first()
            finally:
                leave()
            if isinstance(first, g.Hello):
                if not await self._elsewhere(first, data):
                    await self._speak(first)
            elif isinstance(first, g.Listen):
                await self._listen(first)
        except TimeoutError:
            await self._fail("timeout", "no hello in time", 1002)
        except ConnectionClosed:
            pass
        except FapstreamError as e:
            busy = getattr(e, "retry_ms", None)
            await self._fail(e.code, str(e), 1013 if busy is not None else 1002, busy)
        except Exception:
            log.exception("a connection failed")
            await self._fail("internal", "the server made a mistake; please connect again", 1011)
        finally:
            await self._link.close()

    async def _first(self) -> tuple[g.Hello | g.Listen | None, bytes]:
        """What the client comes for, and the frame; None if it says goodbye at once."""
        while self._session.state == "opening":
            try:
                data = _bytes(await self._link.recv())
                for event in self._session.receive(data):
                    if isinstance(event, g.Hello | g.Listen):
                        return event, data
            except RemoteProtocolError as e:
                if e.fatal:
                    raise
                self._link.write(encode(g.Error(code=e.code, message=str(e)[:1000], fatal=False)))
        return None, b""

    async def _elsewhere(self, hello: g.Hello, data: bytes) -> bool:
        """Whether another process has taken the client."""
        index = self._lobby.elsewhere(hello.resume)
        return index is not None and await self._hand_over(self._link, data, index, self._address)

    async def _speak(self, hello: g.Hello) -> None:
        conversation = self._enter(hello)
        try:
            while conversation.session.state == "open" and conversation.link is self._link:
                data = await self._link.recv()
                if conversation.link is not self._link:
                    return  # resumed over another connection, which brings this message again
                await conversation.take(data)
                await self._not_too_fast(data)
        except RemoteProtocolError as e:
            await conversation.fail(e.code, str(e))
        except ConnectionClosed:
            pass
        except Exception:
            log.exception("a session failed", extra={"session": conversation.id})
            await conversation.fail("internal", "the server made a mistake; please connect again")
        finally:
            self._lobby.lost(conversation, self._link)

    def _enter(self, hello: g.Hello) -> Conversation:
        if hello.resume:
            found = self._lobby.resume(hello, self._link)
            self._service.meter.count("resumes", label="resumed" if found else "gone")
            if found:
                return found
        leave = self._gate.speak(hello, self._address)
        try:
            return self._lobby.enter(self._session, hello, self._link, leave)
        except BaseException:
            leave()
            raise

    async def _listen(self, wish: g.Listen) -> None:
        self._lobby.check_channel(wish.channel)
        leave = self._gate.listen(wish, self._address)
        meter = self._service.meter
        listening = Listening(
            self._link,
            wish.prefer or "sound",
            self._service.clock.now,
            lambda level: meter.count("dropped", label=level),
        )
        self._link.keep_little()
        try:
            name = secrets.token_hex(8)
            self._link.write(encode(replace(ready(self._service, name, 25), channel=wish.channel)))
            self._lobby.listen(listening, self._link, wish)
            while self._session.state == "listening":
                data = await self._link.recv()
                self._heard(data)
                await self._not_too_fast(data)
        finally:
            self._lobby.deafen(listening)
            leave()

    def _heard(self, data: bytes | str) -> None:
        """Raises RemoteProtocolError if the session is to end."""
        try:
            for event in self._session.receive(_bytes(data)):
                if isinstance(event, g.Ping):
                    self._link.write(encode(g.Pong(id=event.id)))
        except RemoteProtocolError as e:
            if e.fatal:
                raise
            self._link.write(encode(g.Error(code=e.code, message=str(e)[:1000], fatal=False)))

    async def _not_too_fast(self, data: bytes | str) -> None:
        delay = self._pace(len(data))
        if delay > 0:
            await asyncio.sleep(delay)

    async def _fail(self, code: str, message: str, close: int, retry_ms: int | None = None) -> None:
        self._service.meter.count("errors", label=code)
        error = g.Error(code=code, message=message[:1000], fatal=True, retry_ms=retry_ms)
        self._link.write(encode(error))
        await self._link.close(close, code)


def _bytes(data: bytes | str) -> bytes:
    if isinstance(data, str):
        raise RemoteProtocolError("messages are binary frames")
    return data
