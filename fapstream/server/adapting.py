"""The socket of the editor page joined to its session (protocol/ADAPT.md). Threads wait for its answers."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from websockets.exceptions import ConnectionClosed

from fapstream.errors import FapstreamError, RemoteProtocolError
from fapstream.protocol import adapting
from fapstream.server.link import SEND_DEADLINE_S

log = logging.getLogger("fapstream.server")

Message = dict[str, Any]

HELLO_S = 5.0


class Socket(Protocol):
    """What is used of a websocket."""

    async def recv(self) -> bytes | str:
        """Next message; raises ConnectionClosed."""

    async def send(self, message: bytes) -> None:
        """Returns when there is room; raises ConnectionClosed."""


class Work(Protocol):
    """What a session does with messages. Each method may take seconds."""

    def ready(self) -> Message:
        """The first message."""

    def answer(self, message: Message) -> Message:
        """What to send for a message; after a fatal error, nothing more. Raises nothing."""

    def close(self) -> None:
        """Stop, even in the middle of an answer."""


class Pass(Protocol):
    """Who may make heads."""

    def adapt(self, token: str | None, address: str) -> Callable[[], None]:
        """What is returned is called when the page is gone. Raises NotAuthorised, Busy."""


class Adapting:
    """The editor pages of a server. `make` makes a session; it raises FapstreamError where there can be
    none.
    """

    def __init__(self, make: Callable[[], Work], gate: Pass) -> None:
        self._make = make
        self._gate = gate

    async def handle(self, socket: Socket, address: str) -> None:
        """One page from its handshake to its end."""
        try:
            async with asyncio.timeout(HELLO_S):
                token = _token(adapting.decode(await socket.recv()))
            leave = self._gate.adapt(token, address)
            try:
                work = await asyncio.to_thread(self._make)
                try:
                    await _Page(socket, work).run()
                finally:
                    await asyncio.shield(asyncio.to_thread(work.close))
            finally:
                leave()
        except TimeoutError:
            await _say(socket, _failed("timeout", "no hello in time"))
        except FapstreamError as e:
            await _say(socket, _failed(e.code, str(e)))
        except ConnectionClosed:
            pass


def _token(hello: Message) -> str | None:
    """Raises RemoteProtocolError."""
    token = hello.get("token")
    if hello["type"] != "hello" or not (token is None or isinstance(token, str)):
        raise RemoteProtocolError("the first message is `hello`, with a `token` if one is needed")
    return token


class _Page:
    """One socket and its session. Messages are answered in turn; of waiting `points` only the newest is."""

    def __init__(self, socket: Socket, work: Work) -> None:
        self._socket, self._work = socket, work
        self._waiting: list[Message] = []
        self._came = asyncio.Event()

    async def run(self) -> None:
        await _say(self._socket, self._work.ready())
        worker = asyncio.create_task(self._answer())
        reader = asyncio.create_task(self._read())
        done, rest = await asyncio.wait((worker, reader), return_when=asyncio.FIRST_COMPLETED)
        for task in rest:
            task.cancel()
        await asyncio.gather(*rest, return_exceptions=True)
        for task in done:
            task.result()

    async def _read(self) -> None:
        while True:
            try:
                message = adapting.decode(await self._socket.recv())
            except RemoteProtocolError as e:
                await _say(self._socket, _failed(e.code, str(e)))
                return
            if message["type"] == "points":
                self._waiting = [m for m in self._waiting if m["type"] != "points"]
            if len(self._waiting) >= MOST_WAITING:
                await _say(self._socket, {"type": "error", "code": "busy", "message": "one thing at a time"})
                continue
            self._waiting.append(message)
            self._came.set()

    async def _answer(self) -> None:
        while True:
            await self._came.wait()
            self._came.clear()
            while self._waiting:
                message = self._waiting.pop(0)
                answer = await asyncio.to_thread(self._work.answer, message)
                await _say(self._socket, answer)
                if answer.get("fatal"):
                    return


MOST_WAITING = 4


async def _say(socket: Socket, message: Mapping[str, Any]) -> None:
    async with asyncio.timeout(SEND_DEADLINE_S):
        await socket.send(adapting.encode(message))


def _failed(code: str, message: str) -> Message:
    return {"type": "error", "code": code, "message": message, "fatal": True}
