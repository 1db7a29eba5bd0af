"""The verbs of the web client for programs: connect, speak, append, end, interrupt."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from typing import Literal, Protocol, TypedDict, Unpack

from websockets.asyncio.client import connect as connect_socket
from websockets.exceptions import ConnectionClosed
from websockets.typing import Subprotocol

from fapstream import __version__
from fapstream.errors import FapstreamError, RemoteProtocolError
from fapstream.protocol import generated as g
from fapstream.protocol.session import ClientSession, ServerEvent
from fapstream.records import Packet

OPEN_DEADLINE_S = 10.0

TurnEvent = g.Begin | Packet | g.Done


class ServerError(FapstreamError):
    """The server could not do something; `code` as in protocol/schema/errors.json."""

    def __init__(self, code: str, message: str, fatal: bool, turn: int | None = None) -> None:
        super().__init__(f"{code}: {message}")
        self.code = code
        self.fatal = fatal
        self.turn = turn


class _Socket(Protocol):
    async def send(self, message: bytes) -> None: ...
    async def recv(self) -> bytes | str: ...


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
    """A turn being spoken. Iterate over it for its `begin`, packets and `done`."""

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


class Talker:
    """A session with a server. Turns are spoken in the order in which they are opened."""

    def __init__(self, socket: _Socket) -> None:
        self._socket = socket
        self._session = ClientSession()
        self._turns: dict[int, Turn] = {}
        self._last = 0
        self._broken: BaseException | None = None
        self._ready: asyncio.Future[g.Ready] = asyncio.get_running_loop().create_future()

    async def open(self, hello: g.Hello) -> g.Ready:
        """Say hello; returns what the server can do."""
        await self.send(hello)
        async with asyncio.timeout(OPEN_DEADLINE_S):
            return await self._ready

    @property
    def ready(self) -> g.Ready:
        """What the server can do."""
        return self._ready.result()

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

    async def acknowledge(self, turn: Turn, sample: int, queue: int = 0) -> None:
        """Tell the server which sample is being heard; whoever plays the sound should, now and then."""
        await self.send(g.Ack(turn=turn.number, sample=sample, queue=queue, underruns=0, skew=0))

    async def send(self, message: g.ClientMessage) -> None:
        """Raises LocalProtocolError, ConnectionClosed, and what ended the session if it is over."""
        if self._broken:
            raise self._broken
        await self._socket.send(self._session.send(message))

    async def listen(self) -> None:
        """Take what the server sends until the connection ends."""
        try:
            while self._session.state != "closed":
                data = await self._socket.recv()
                if isinstance(data, str):
                    raise RemoteProtocolError("messages are binary frames")
                for event in self._session.receive(data):
                    self._take(event)
        except (ConnectionClosed, RemoteProtocolError) as e:
            self._fail(e)

    def _take(self, event: ServerEvent) -> None:
        match event:
            case g.Ready():
                self._ready.set_result(event)
            case g.Error():
                error = ServerError(event.code, event.message, event.fatal, event.turn)
                if event.fatal or not self._ready.done():
                    self._fail(error)
                elif turn := self._turns.get(event.turn or 0):
                    turn.put(error)
            case g.Bye():
                self._fail(ServerError("bye", event.reason or "the server said goodbye", fatal=True))
            case g.Begin() | Packet() | g.Done():
                if turn := self._turns.get(event.turn):
                    turn.put(event)
                if isinstance(event, g.Done):
                    self._turns.pop(event.turn, None)
            case _:
                pass

    def _fail(self, error: BaseException) -> None:
        self._broken = self._broken or error
        if not self._ready.done():
            self._ready.set_exception(error)
        for turn in self._turns.values():
            turn.put(error)
        self._turns.clear()


@asynccontextmanager
async def connect(
    url: str, *, lang: str | None = None, voice: str | None = None, fps: Literal[25, 50] = 25
) -> AsyncIterator[Talker]:
    """A session with the server at `url`, such as `ws://127.0.0.1:8765/ws`.

    Raises OSError or a websockets exception if there is no such server, ServerError if it refuses.
    """
    async with connect_socket(
        url, subprotocols=[Subprotocol(g.SUBPROTOCOL)], compression=None, max_size=g.MAX_MESSAGE_BYTES
    ) as socket:
        talker = Talker(socket)
        listener = asyncio.create_task(talker.listen())
        try:
            hello = g.Hello(client=f"fapstream {__version__}", lang=lang, voice=voice, fps=fps)
            await talker.open(hello)
            yield talker
        finally:
            with suppress(ConnectionClosed, FapstreamError):
                await talker.send(g.Bye())
            listener.cancel()
            await asyncio.gather(listener, return_exceptions=True)
