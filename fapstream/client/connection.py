"""The verbs of the web client for programs: connect, speak, append, hear, end, interrupt."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from dataclasses import replace
from typing import Literal, TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray
from websockets.exceptions import ConnectionClosed

from fapstream import __version__
from fapstream.client.line import Line
from fapstream.errors import FapstreamError
from fapstream.protocol import generated as g
from fapstream.protocol.session import ServerEvent
from fapstream.records import Packet

OPEN_DEADLINE_S = 10.0
MAX_PCM = 8192
"""Samples of one `hear`."""

TurnEvent = g.Begin | Packet | g.Discard | g.Done


class ServerError(FapstreamError):
    """The server could not do something; `code` as in protocol/schema/errors.json, or `connection_lost`."""

    def __init__(
        self, code: str, message: str, fatal: bool, turn: int | None = None, retry_ms: int | None = None
    ) -> None:
        super().__init__(f"{code}: {message}")
        self.code = code
        self.fatal = fatal
        self.turn = turn
        self.retry_ms = retry_ms
        """When it may be tried again, if the server says so."""


class Manner(TypedDict, total=False):
    """How a turn is read: `rate`, `pitch` and `volume` are factors, 1 is the voice's own. `look_ahead`: how
    many words after a word are waited for before it is spoken (0, 1, 2, ...; 1000: all of its phrase)."""

    rate: float
    pitch: float
    volume: float
    look_ahead: int


def _in_percent(manner: Manner) -> dict[str, int]:
    """As the protocol wants it; what is left at 1 need not be said."""
    scales = {"rate": manner.get("rate"), "pitch": manner.get("pitch"), "volume": manner.get("volume")}
    given = {name: round(100 * scale) for name, scale in scales.items() if scale is not None and scale != 1.0}
    return given | ({"look_ahead": manner["look_ahead"]} if "look_ahead" in manner else {})


class Turn:
    """A turn being spoken. Iterate over it for its `begin`, packets and `done`; a `discard` makes void what
    came before it, from its sample on.
    """

    def __init__(self, talker: Talker, number: int) -> None:
        self.number = number
        self.done: g.Done | None = None
        self._talker = talker
        self._events: asyncio.Queue[TurnEvent | BaseException] = asyncio.Queue()

    async def append(self, text: str | bytes) -> None:
        """More text; bytes are UTF-8 and may be cut anywhere."""
        data = text.encode("utf-8", "replace") if isinstance(text, str) else text
        for at in range(0, len(data), g.MAX_FRAGMENT_BYTES):
            await self._talker.send(g.Speak(turn=self.number, text=data[at : at + g.MAX_FRAGMENT_BYTES]))

    async def end(self) -> None:
        """The text is complete."""
        await self._talker.send(g.End(turn=self.number))

    async def interrupt(self, heard: int | None = None) -> g.Done:
        """Stop; tells how much was heard. `heard`: samples, if the caller plays the sound itself."""
        await self._talker.send(g.Interrupt(turn=self.number, heard=heard))
        return await self.finished()

    async def splice(self, char: int, text: str, heard: int | None = None) -> None:
        """Revise the text: its first `char` code points stay, what follows is dropped as far as it was not
        heard, and `text` comes instead. More may be appended; `end` has to be called again.
        """
        await self._talker.send(g.Splice(turn=self.number, char=char, heard=heard))
        await self.append(text)

    async def seek(self, back: int = 1, heard: int | None = None) -> None:
        """Say it again from the beginning of the sentence being heard (0), or so many before it."""
        await self._talker.send(g.Seek(turn=self.number, back=back, heard=heard))

    async def pause(self, heard: int | None = None) -> None:
        """Stop after what was heard."""
        await self._talker.send(g.Pause(turn=self.number, heard=heard))

    async def go_on(self) -> None:
        """Go on after a pause."""
        await self._talker.send(g.Continue(turn=self.number))

    async def finished(self) -> g.Done:
        """Wait until the turn is over. Packets not taken yet are thrown away."""
        async for _ in self:
            pass
        assert self.done is not None
        return self.done

    async def __aiter__(self) -> AsyncIterator[TurnEvent]:
        while self.done is None:
            event = await self._events.get()
            if isinstance(event, ServerError) and not event.fatal:
                raise event
            if isinstance(event, BaseException | g.Done):
                self._events.put_nowait(event)  # for whoever else waits
            if isinstance(event, BaseException):
                raise event
            if isinstance(event, g.Done):
                self.done = event
            yield event

    def put(self, event: TurnEvent | BaseException) -> None:
        """An event for this turn has come."""
        self._events.put_nowait(event)


class OwnTurn(Turn):
    """A turn that the caller speaks himself: `feed` it with sound, and packets bring that back with a face.
    There is nothing to append to, to splice or to seek in."""

    async def feed(self, pcm: NDArray[np.int16]) -> None:
        """More sound, int16 (n,), at the rate with which the turn was opened."""
        for at in range(0, len(pcm), MAX_PCM):
            await self._talker.send(g.Hear(turn=self.number, pcm=pcm[at : at + MAX_PCM]))


class Talker:
    """A session with a server. Turns are spoken in the order in which they are opened. When the connection
    is lost it goes on over another one, and nobody notices.
    """

    def __init__(self, url: str, hello: g.Hello) -> None:
        self._hello = hello
        self._line = Line(url, self._first, self._take)
        self._turns: dict[int, Turn] = {}
        self._last = 0
        self._broken: BaseException | None = None
        self._ready: asyncio.Future[g.Ready] = asyncio.get_running_loop().create_future()
        self._newest: g.Ready | None = None
        self._over = asyncio.Event()

    async def open(self) -> g.Ready:
        """Wait for the server's greeting."""
        async with asyncio.timeout(OPEN_DEADLINE_S):
            return await asyncio.shield(self._ready)

    @property
    def ready(self) -> g.Ready:
        """What the server can do."""
        return self._ready.result()

    @property
    def connections(self) -> int:
        """How many connections it took so far."""
        return self._line.connections

    async def speak(
        self,
        text: str | bytes = "",
        *,
        lang: str | None = None,
        voice: str | None = None,
        **manner: Unpack[Manner],
    ) -> Turn:
        """Open a turn, with its first text if there is some already."""
        self._last += 1
        turn = self._turns[self._last] = Turn(self, self._last)
        await self.send(g.Speak(turn=turn.number, text=b"", lang=lang, voice=voice, **_in_percent(manner)))
        if text:
            await turn.append(text)
        return turn

    async def say(
        self, text: str, *, lang: str | None = None, voice: str | None = None, **manner: Unpack[Manner]
    ) -> Turn:
        """Open a turn whose text is complete."""
        turn = await self.speak(text, lang=lang, voice=voice, **manner)
        await turn.end()
        return turn

    async def hear(self, sample_rate: int) -> OwnTurn:
        """Open a turn of sound: the head says what it is fed with, `begin.delay` samples later."""
        self._last += 1
        turn = OwnTurn(self, self._last)
        self._turns[self._last] = turn
        nothing = np.zeros(0, np.int16)
        await self.send(g.Hear(turn=turn.number, pcm=nothing, sample_rate=sample_rate))
        return turn

    async def acknowledge(self, turn: Turn, sample: int, queue: int = 0) -> None:
        """Tell the server which sample is being heard; whoever plays the sound should, now and then."""
        await self.send(g.Ack(turn=turn.number, sample=sample, queue=queue, underruns=0, skew=0))

    async def closed(self) -> None:
        """Wait for the end of the session, and raise what ended it."""
        await self._over.wait()
        assert self._broken
        raise self._broken

    async def send(self, message: g.ClientMessage) -> None:
        """Raises LocalProtocolError, and what ended the session if it is over."""
        if self._broken:
            raise self._broken
        await self._line.send(message)

    async def run(self) -> None:
        """Take what the server sends until the session is over."""
        why = await self._line.run()
        self._fail(why or ServerError("bye", "the session is over", fatal=True))

    def _first(self) -> g.Hello:
        if self._newest is None or self._newest.resume is None:
            return self._hello
        return replace(self._hello, resume=self._newest.resume, received=self._line.session.received)

    def _take(self, event: ServerEvent) -> None:
        match event:
            case g.Ready():
                self._greet(event)
            case g.Error():
                error = ServerError(event.code, event.message, event.fatal, event.turn, event.retry_ms)
                if event.fatal or not self._ready.done():
                    self._fail(error)
                elif turn := self._turns.get(event.turn or 0):
                    turn.put(error)
            case g.Bye():
                self._fail(ServerError("bye", event.reason or "the server said goodbye", fatal=True))
            case g.Begin() | Packet() | g.Discard() | g.Done():
                if turn := self._turns.get(event.turn):
                    turn.put(event)
                if isinstance(event, g.Done):
                    self._turns.pop(event.turn, None)
            case _:
                pass

    def _greet(self, ready: g.Ready) -> None:
        again, self._newest = self._newest is not None, ready
        if again and not ready.resumed:
            self._fail(ServerError("connection_lost", "the server does not know the session any more", True))
        elif not self._ready.done():
            self._ready.set_result(ready)

    def _fail(self, error: BaseException) -> None:
        self._broken = self._broken or error
        self._over.set()
        if not self._ready.done():
            self._ready.set_exception(error)
            self._ready.exception()  # whoever waits is told; nobody has to
        for turn in self._turns.values():
            turn.put(error)
        self._turns.clear()


@asynccontextmanager
async def connect(
    url: str,
    *,
    lang: str | None = None,
    voice: str | None = None,
    fps: Literal[25, 50] = 25,
    token: str | None = None,
    channel: str | None = None,
    share: bool = False,
) -> AsyncIterator[Talker]:
    """A session with the server at `url`, such as `ws://127.0.0.1:8765/ws`.

    `channel`: speak into this channel of the server. `share`: let others listen; `ready` says how.

    Raises OSError or a websockets exception if there is no such server, ServerError if it refuses.
    """
    hello = g.Hello(
        client=f"fapstream {__version__}", lang=lang, voice=voice, fps=fps, token=token, channel=channel,
        share=share or None,
    )  # fmt: skip
    talker = Talker(url, hello)
    runner = asyncio.create_task(talker.run())
    try:
        await talker.open()
        yield talker
    finally:
        with suppress(FapstreamError, ConnectionClosed, OSError):
            await talker.send(g.Bye())
        runner.cancel()
        await asyncio.gather(runner, return_exceptions=True)
