"""One client: a socket joined to a ServerSession, and its turns spoken one after the other."""

from __future__ import annotations

import asyncio
import logging
import secrets
from collections.abc import Callable
from contextlib import aclosing, suppress
from dataclasses import dataclass, field, replace
from typing import Literal, Protocol

from websockets.exceptions import ConnectionClosed

from fapstream import __version__
from fapstream.errors import FapstreamError, InputError, RemoteProtocolError, TextTooLong
from fapstream.pipeline import Pipeline
from fapstream.ports import Clock, Synthesizer
from fapstream.protocol import generated as g
from fapstream.protocol.session import FAP_NUMBERS, ClientEvent, EndOfText, ServerSession, Text
from fapstream.records import TurnFormat
from fapstream.stream import Pacer
from fapstream.talk import MAX_PENDING_TEXT, Talk
from fapstream.tts import DEFAULT_LOOK_AHEAD, PHRASE, FrontEnd, Manner
from fapstream.tts.voices import Voice

log = logging.getLogger("fapstream.server")

Reason = Literal["end", "interrupted", "failed"]

SEND_DEADLINE_S = 20.0
"""A client that takes nothing for so long is dropped."""


class Voices(Protocol):
    """The voices this server has."""

    def find(self, voice: str | None, lang: str | None) -> Voice:
        """The voice wished for. Raises UnknownVoice, UnknownLanguage, VoiceUnavailable."""

    def all(self) -> tuple[Voice, ...]:
        """Every voice that can speak here."""

    async def acquire(self, voice: Voice) -> Synthesizer:
        """Ready for one turn. Raises SynthesisError."""


class Socket(Protocol):
    """What is used of a websocket."""

    async def recv(self) -> bytes | str:
        """Next message; raises ConnectionClosed."""

    async def send(self, message: bytes) -> None:
        """Returns when there is room; raises ConnectionClosed."""

    async def close(self, code: int = 1000, reason: str = "") -> None:
        """Closing handshake."""


@dataclass(frozen=True, slots=True)
class Service:
    """What all connections share."""

    voices: Voices
    clock: Clock
    heads: Callable[[], tuple[str, ...]]
    lang: str = "en"
    voice: str | None = None
    manner: Manner = field(default_factory=lambda: Manner(look_ahead=DEFAULT_LOOK_AHEAD))
    """How turns are read that do not say otherwise; its lexicon is for `lang` only."""


@dataclass(slots=True)
class _Turn:
    """A turn from its first fragment to its `done`."""

    opening: g.Speak
    voice: Voice
    text: list[str] = field(default_factory=list)
    ended: bool = False
    talk: Talk | None = None
    pacer: Pacer | None = None
    task: asyncio.Task[None] | None = None
    sent: int = 0
    interrupt: g.Interrupt | None = None
    over: bool = False

    @property
    def number(self) -> int:
        return self.opening.turn

    def feed(self, text: str) -> None:
        """Raises TextTooLong."""
        if self.talk:
            self.talk.feed(text)
            return
        waiting = sum(map(len, self.text)) + len(text)
        if waiting > MAX_PENDING_TEXT:
            raise TextTooLong(waiting, MAX_PENDING_TEXT)
        self.text.append(text)

    def end(self) -> None:
        self.ended = True
        if self.talk:
            self.talk.end()


def _manner(opening: g.Speak, service: Service, lang: str) -> Manner:
    """How a turn wants to be read."""
    usual = service.manner
    ahead = opening.look_ahead
    return replace(
        usual,
        rate=usual.rate if opening.rate is None else opening.rate / 100,
        pitch=usual.pitch if opening.pitch is None else opening.pitch / 100,
        volume=usual.volume if opening.volume is None else opening.volume / 100,
        look_ahead=usual.look_ahead if ahead is None else ahead if ahead < g.LONGEST_LOOK_AHEAD else PHRASE,
        lexicon=usual.lexicon if lang == service.lang else {},
    )


class Connection:
    """Runs one client until it leaves or breaks the contract."""

    def __init__(self, socket: Socket, service: Service) -> None:
        self._socket = socket
        self._service = service
        self._session = ServerSession()
        self._hello = g.Hello()
        self._turns: dict[int, _Turn] = {}
        self._queue: asyncio.Queue[_Turn] = asyncio.Queue()

    async def run(self) -> None:
        """Returns when the session is over; never raises for what the client did."""
        speaker: asyncio.Task[None] | None = None
        try:
            async with asyncio.timeout(g.HELLO_DEADLINE_MS / 1000):
                while self._session.state == "opening":
                    await self._take(await self._socket.recv())
            speaker = asyncio.create_task(self._speak_turns())
            while self._session.state == "open":
                await self._take(await self._socket.recv())
        except TimeoutError:
            opening = self._session.state == "opening"
            await self._fail("timeout", "no hello in time" if opening else "the client does not read")
        except ConnectionClosed:
            pass
        except Exception:
            log.exception("a session failed")
            await self._fail("internal", "the server made a mistake; please connect again")
        finally:
            if speaker:
                speaker.cancel()
                await asyncio.gather(speaker, return_exceptions=True)
            with suppress(ConnectionClosed):
                await self._socket.close()

    async def close(self, reason: str) -> None:
        """The server goes down."""
        with suppress(ConnectionClosed, FapstreamError):
            await self._send(g.Bye(reason=reason))
            await self._socket.close(1001, reason)

    # what comes in

    async def _take(self, data: bytes | str) -> None:
        try:
            if isinstance(data, str):
                raise RemoteProtocolError("messages are binary frames")
            for event in self._session.receive(data):
                await self._handle(event)
        except RemoteProtocolError as e:
            if e.fatal:
                await self._fail(e.code, str(e))
            else:
                await self._send(g.Error(code=e.code, message=str(e)[:1000], fatal=False))

    async def _handle(self, event: ClientEvent) -> None:
        match event:
            case g.Hello():
                self._hello = event
                await self._send(self._ready())
            case Text():
                await self._text(event)
            case EndOfText() if event.turn in self._turns:
                turn = self._turns[event.turn]
                if event.text:
                    await self._text(Text(event.turn, event.text))
                turn.end()
            case g.Interrupt() if event.turn in self._turns:
                await self._interrupt(self._turns[event.turn], event)
            case g.Ack() if event.turn in self._turns:
                if pacer := self._turns[event.turn].pacer:
                    pacer.acknowledge(event.sample, self._service.clock.now())
            case g.Ping():
                await self._send(g.Pong(id=event.id))
            case _:
                pass

    async def _text(self, event: Text) -> None:
        try:
            if event.opening:
                self._open(event.opening)
            if turn := self._turns.get(event.turn):
                turn.feed(event.text)
        except TextTooLong as e:
            await self._refuse(event.turn, e)
        except FapstreamError as e:
            await self._refuse(event.turn, e)
            await self._send(g.Done(turn=event.turn, reason="failed", samples=0))

    def _open(self, opening: g.Speak) -> None:
        """Raises UnknownVoice, UnknownLanguage, VoiceUnavailable, TooManyTurns."""
        if len(self._turns) >= g.MAX_PENDING_TURNS:
            raise TooManyTurns(len(self._turns))
        service, hello = self._service, self._hello
        lang = opening.lang or hello.lang
        name = opening.voice or (None if opening.lang else hello.voice)
        if name is None and lang is None:
            name, lang = service.voice, service.lang
        turn = _Turn(opening, service.voices.find(name, lang))
        self._turns[turn.number] = turn
        self._queue.put_nowait(turn)

    async def _interrupt(self, turn: _Turn, event: g.Interrupt) -> None:
        if turn.interrupt:
            return
        turn.interrupt = event
        if turn.task:
            turn.task.cancel()
        elif not turn.over:
            await self._done(turn, "interrupted")

    # what goes out

    async def _speak_turns(self) -> None:
        while True:
            turn = await self._queue.get()
            if turn.over:
                continue
            turn.task = asyncio.create_task(self._speak(turn))
            try:
                await turn.task
                await self._done(turn, "end")
            except asyncio.CancelledError:
                me = asyncio.current_task()
                if me and me.cancelling():
                    raise  # the session is over, whether or not the turn was interrupted as well
                await self._done(turn, "interrupted")
            except ConnectionClosed:
                return
            except FapstreamError as e:
                await self._refuse(turn.number, e)
                await self._done(turn, "failed")
            except TimeoutError:
                await self._socket.close(1008, "the client does not read")
                return
            except Exception:
                log.exception("turn %d failed", turn.number)
                await self._fail("internal", "the server made a mistake; please connect again")
                return

    async def _speak(self, turn: _Turn) -> None:
        voice, clock = turn.voice, self._service.clock
        form = TurnFormat(turn.number, voice.name, voice.lang, voice.sample_rate, self._hello.fps or 25)
        manner = _manner(turn.opening, self._service, voice.lang).of(voice)
        synthesizer = await self._service.voices.acquire(voice)
        pacer = turn.pacer = Pacer(voice.sample_rate)
        pipeline = Pipeline(form, FrontEnd(voice.lang, manner), seed=turn.number)
        talk = Talk(pipeline, synthesizer, lambda: pacer.heard(clock.now()) / voice.sample_rate)
        self._hand_over(turn, talk)
        try:
            await self._send(
                g.Begin(turn=form.turn, voice=voice.name, lang=voice.lang,
                        sample_rate=form.sample_rate, fps=form.fps)
            )  # fmt: skip
            async with aclosing(talk.packets()) as packets:
                async for packet in packets:
                    await clock.sleep_until(pacer.due(packet.start, clock.now()))
                    await self._send_bytes(self._session.send_packet(packet))
                    turn.sent = packet.start + len(packet.pcm)
                    pacer.sent(packet.start, turn.sent, clock.now())
        finally:
            await talk.aclose()

    def _hand_over(self, turn: _Turn, talk: Talk) -> None:
        """Text that came while the turn waited goes to its talk, and from now on all text."""
        for text in turn.text:
            talk.feed(text)
        turn.text.clear()
        turn.talk = talk
        if turn.ended:
            talk.end()

    async def _done(self, turn: _Turn, reason: Reason) -> None:
        turn.over = True
        self._turns.pop(turn.number, None)
        if reason != "interrupted":
            await self._send(g.Done(turn=turn.number, reason=reason, samples=turn.sent))
            return
        wished = turn.interrupt.heard if turn.interrupt else None
        if wished is None:
            wished = turn.pacer.heard(self._service.clock.now()) if turn.pacer else 0
        heard = min(wished, turn.sent)
        char = turn.talk.heard_char(heard) if turn.talk and heard else 0
        await self._send(
            g.Done(turn=turn.number, reason="interrupted", samples=turn.sent, heard=heard, char=char)
        )

    def _ready(self) -> g.Ready:
        return g.Ready(
            server=f"fapstream {__version__}",
            session=secrets.token_hex(8),
            fps=self._hello.fps or 25,
            faps=bytes(FAP_NUMBERS),
            voices=tuple(
                g.Voice(
                    name=v.name, lang=v.lang, engine=v.engine,
                    sample_rate=v.sample_rate, description=v.description,
                )
                for v in self._service.voices.all()
            ),
            heads=self._service.heads(),
        )  # fmt: skip

    async def _refuse(self, turn: int, error: FapstreamError) -> None:
        await self._send(g.Error(code=error.code, message=str(error)[:1000], fatal=False, turn=turn))

    async def _fail(self, code: str, message: str) -> None:
        with suppress(ConnectionClosed, FapstreamError, TimeoutError):
            await self._send(g.Error(code=code, message=message[:1000], fatal=True))
        self._session.state = "closed"
        with suppress(ConnectionClosed):
            await self._socket.close(1002 if code != "internal" else 1011, code)

    async def _send(self, message: g.ServerMessage) -> None:
        await self._send_bytes(self._session.send(message))

    async def _send_bytes(self, data: bytes) -> None:
        async with asyncio.timeout(SEND_DEADLINE_S):
            await self._socket.send(data)


class TooManyTurns(InputError):
    """More turns wait than the protocol allows."""

    code = "too_many_turns"

    def __init__(self, waiting: int) -> None:
        super().__init__(f"{waiting} turns are waiting already; wait until one is done")
        self.waiting = waiting
