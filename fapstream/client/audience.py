"""Listening to what is spoken into a channel."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from typing import Literal

from fapstream import __version__
from fapstream.client.connection import OPEN_DEADLINE_S, ServerError
from fapstream.client.line import Line
from fapstream.protocol import generated as g
from fapstream.protocol.session import ServerEvent
from fapstream.records import Packet

MOST_EVENTS = 1024
"""With so much waiting to be looked at nothing more is read, and the server has a slow listener."""

Heard = g.Live | g.Skip | g.Begin | Packet | g.Discard | g.Pause | g.Continue | g.Done


class Audience:
    """A session that listens. Iterate over it for what is spoken; when the connection is lost it goes on
    over another one, without a gap if that was soon.
    """

    def __init__(self, url: str, listen: g.Listen) -> None:
        self._listen = listen
        self._line = Line(url, self._first, self._take)
        self._events: asyncio.Queue[Heard | BaseException] = asyncio.Queue()
        self._ready: asyncio.Future[g.Ready] = asyncio.get_running_loop().create_future()
        self._talk: str | None = None
        self._turn: int | None = None
        self._sample = 0

    async def open(self) -> g.Ready:
        """Wait for the server's greeting."""
        async with asyncio.timeout(OPEN_DEADLINE_S):
            return await asyncio.shield(self._ready)

    async def __aiter__(self) -> AsyncIterator[Heard]:
        """Raises what ended the session."""
        while True:
            event = await self._events.get()
            if self._events.qsize() <= MOST_EVENTS // 2:
                self._line.reading.set()
            if isinstance(event, BaseException):
                self._events.put_nowait(event)
                raise event
            yield event

    async def acknowledge(self, ack: g.Ack) -> None:
        """Tell the server what is heard, for its figures."""
        await self._line.send(ack)

    async def run(self) -> None:
        """Take what the server sends until the session is over."""
        why = await self._line.run()
        self._fail(why or ServerError("bye", "the session is over", fatal=True))

    def _first(self) -> g.Listen:
        """Say what was received of the talk, when it comes back."""
        if self._talk is None or self._turn is None:
            return self._listen
        return replace(self._listen, talk=self._talk, turn=self._turn, sample=self._sample)

    def _take(self, event: ServerEvent) -> None:
        match event:
            case g.Ready():
                if not self._ready.done():
                    self._ready.set_result(event)
            case g.Error():
                self._fail(ServerError(event.code, event.message, event.fatal, retry_ms=event.retry_ms))
            case g.Bye():
                self._fail(ServerError("bye", event.reason or "the server said goodbye", fatal=True))
            case (
                g.Live() | g.Skip() | g.Begin() | Packet() | g.Discard() | g.Pause() | g.Continue() | g.Done()
            ):
                self._follow(event)
                self._events.put_nowait(event)
                if self._events.qsize() >= MOST_EVENTS:
                    self._line.reading.clear()
            case _:
                pass

    def _follow(self, event: Heard) -> None:
        """Remember where it is."""
        match event:
            case g.Live():
                if event.talk != self._talk:
                    self._talk, self._turn = event.talk, None
            case g.Begin():
                self._turn, self._sample = event.turn, event.sample or 0
            case Packet():
                self._sample = event.start + len(event.pcm)
            case g.Discard():
                self._sample = min(self._sample, event.sample)
            case g.Done():
                self._turn = None
            case _:
                pass

    def _fail(self, error: BaseException) -> None:
        if not self._ready.done():
            self._ready.set_exception(error)
            self._ready.exception()  # whoever waits is told; nobody has to
        self._events.put_nowait(error)


@asynccontextmanager
async def listen(
    url: str,
    channel: str,
    *,
    token: str | None = None,
    prefer: Literal["sound", "face"] | None = None,
) -> AsyncIterator[Audience]:
    """Listen to a channel of the server at `url`, or to a session that is shared.

    `prefer`: what is still wanted when the connection is too slow for both.

    Raises OSError or a websockets exception if there is no such server, ServerError if it refuses.
    """
    wish = g.Listen(channel=channel, client=f"fapstream {__version__}", token=token, prefer=prefer)
    audience = Audience(url, wish)
    runner = asyncio.create_task(audience.run())
    try:
        await audience.open()
        yield audience
    finally:
        runner.cancel()
        await asyncio.gather(runner, return_exceptions=True)
