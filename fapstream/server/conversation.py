"""One session that speaks: its turns, spoken one after the other. It outlives its connection for a while."""

from __future__ import annotations

import asyncio
import logging
import secrets
import time
from contextlib import aclosing, suppress
from typing import Literal, Protocol

from websockets.exceptions import ConnectionClosed

from fapstream.errors import (
    FapstreamError,
    LocalProtocolError,
    RemoteProtocolError,
    SoundTooLong,
    TextTooLong,
)
from fapstream.protocol import generated as g
from fapstream.protocol.codec import encode
from fapstream.protocol.session import ClientEvent, EndOfText, ServerSession, Text
from fapstream.records import Packet
from fapstream.server.link import Link, drained
from fapstream.server.service import Service, ready
from fapstream.server.turn import HeardTurn, SpokenTurn, TooManyTurns, Turn
from fapstream.stream.pacer import GROUP_S, LEAD_S, SHARED_LEAD_S, Pacer

log = logging.getLogger("fapstream.server")

Reason = Literal["end", "interrupted", "failed"]

HIGH_WATER = 65_536
"""With more than so many bytes waiting to go, the speaker waits."""

LATE_S = 0.02
"""A packet that leaves so long after it was due counts as late."""


class Audience(Protocol):
    """Who else hears a conversation."""

    name: str
    """The channel."""

    def tell(self, kind: str, data: bytes, key: bool = False) -> None:
        """A message of the session, by type, and its frame; `key`: a packet that begins with a key. Returns
        at once.
        """


class Conversation:
    """Turns in, messages out. `link` is the connection it has at present, or None."""

    def __init__(self, service: Service, session: ServerSession, hello: g.Hello) -> None:
        self.id = f"{time.time_ns() // 1_000_000:012x}{secrets.token_hex(3)}"
        """Names it, in logs and to listeners; no secret. Sorts by when it began."""
        self.link: Link | None = None
        self.links = 0
        """Connections it has had."""
        self.audience: Audience | None = None
        self.session = session
        self._service = service
        self._hello = hello
        self._turns: dict[int, Turn] = {}
        self._queue: asyncio.Queue[Turn] = asyncio.Queue()
        self._taken = asyncio.Event()
        self._underruns = 0
        self._heard_at = 0.0
        """When what was said so far will have been heard."""
        self._speaker: asyncio.Task[None] | None = None

    @property
    def busy(self) -> bool:
        """Turns are being spoken or wait."""
        return bool(self._turns)

    @property
    def text_waiting(self) -> int:
        """Characters that are not spoken yet."""
        return sum(turn.text_waiting for turn in self._turns.values())

    def start(self, link: Link) -> None:
        """Begin to speak turns as they come."""
        self.link = link
        self.links = 1
        self._speaker = asyncio.create_task(self._speak_turns())

    def attach(self, link: Link, received: int) -> list[bytes] | None:
        """Go on over another connection, which has so many messages: the frames it is to be sent first.

        None, and nothing is changed, if the session cannot go on.
        """
        again = self.session.resumed(received)
        if again is not None:
            self.session.sent.forget(received)
            self.link = link
            self.links += 1
            self._taken.set()
        return again

    def detach(self, link: Link) -> None:
        """The connection is lost."""
        if self.link is link:
            self.link = None

    async def aclose(self) -> None:
        """Stop, and give everything back."""
        self.session.state = "closed"
        if self._speaker:
            self._speaker.cancel()
            await asyncio.gather(self._speaker, return_exceptions=True)

    def ready(self) -> g.Ready:
        """What this server can do."""
        return ready(self._service, self.id, self._hello.fps or 25)

    # what comes in

    async def take(self, data: bytes | str) -> None:
        """A frame from the client. Raises RemoteProtocolError if the session is to end."""
        try:
            if isinstance(data, str):
                raise RemoteProtocolError("messages are binary frames")
            for event in self.session.receive(data):
                await self._handle(event)
        except RemoteProtocolError as e:
            if e.fatal:
                raise
            await self.send(g.Error(code=e.code, message=str(e)[:1000], fatal=False, turn=e.turn))

    async def _handle(self, event: ClientEvent) -> None:
        match event:
            case Text():
                await self._text(event)
            case EndOfText():
                await self._end(event)
            case g.Hear():
                await self._hear(event)
            case g.Ping():
                await self.send(g.Pong(id=event.id, received=self.session.received))
            case g.Ack():
                self._acknowledge(event)
            case g.Splice() | g.Seek():
                if isinstance(turn := self._turns.get(event.turn), SpokenTurn):
                    await self._revise(turn, event)
            case g.Interrupt() | g.Pause() | g.Continue():
                if turn := self._turns.get(event.turn):
                    await self._steer(turn, event)
            case _:
                pass

    async def _text(self, event: Text) -> None:
        try:
            if event.opening:
                self._open(self._spoken(event.opening))
            if isinstance(turn := self._turns.get(event.turn), SpokenTurn):
                turn.feed(event.text)
        except FapstreamError as e:
            await self._refuse(event.turn, e, failed=not isinstance(e, TextTooLong))

    async def _hear(self, event: g.Hear) -> None:
        try:
            if event.turn not in self._turns:
                lang = self._hello.lang or self._service.lang
                self._open(HeardTurn(event, self._service, self._hello.fps or 25, lang))
            if isinstance(turn := self._turns[event.turn], HeardTurn):
                turn.feed(event.pcm)
        except FapstreamError as e:
            await self._refuse(event.turn, e, failed=not isinstance(e, SoundTooLong))

    async def _end(self, event: EndOfText) -> None:
        if not (turn := self._turns.get(event.turn)):
            return
        try:
            if event.text and isinstance(turn, SpokenTurn):
                turn.feed(event.text)
        except TextTooLong as e:
            await self._refuse(event.turn, e)
        turn.end()

    def _open(self, turn: Turn) -> None:
        """Raises TooManyTurns."""
        if len(self._turns) >= g.MAX_PENDING_TURNS:
            raise TooManyTurns(len(self._turns))
        self._turns[turn.number] = turn
        self._queue.put_nowait(turn)

    def _spoken(self, opening: g.Speak) -> SpokenTurn:
        """Raises UnknownVoice, UnknownLanguage, VoiceUnavailable."""
        service, hello = self._service, self._hello
        lang = opening.lang or hello.lang
        name = opening.voice or (None if opening.lang else hello.voice)
        if name is None and lang is None:
            name, lang = service.voice, service.lang
        return SpokenTurn(opening, service.voices.find(name, lang), service.clock.now())

    def _acknowledge(self, ack: g.Ack) -> None:
        if ack.received is not None:
            self.session.sent.forget(ack.received)
            self._taken.set()
        self._service.meter.time("skew", ack.skew / 1e6)
        if ack.underruns > self._underruns:
            self._service.meter.count("underruns", ack.underruns - self._underruns)
            self._underruns = ack.underruns
        turn = self._turns.get(ack.turn)
        if turn and turn.pacer:
            turn.pacer.acknowledge(ack.sample, self._service.clock.now())

    async def _steer(self, turn: Turn, event: g.Interrupt | g.Pause | g.Continue) -> None:
        now = self._service.clock.now()
        if isinstance(event, g.Interrupt):
            await self._interrupt(turn, event)
        elif isinstance(event, g.Pause):
            turn.pause(event.heard, now)
            heard = turn.heard(event.heard, now)
            self._relay("pause", encode(g.Pause(turn=turn.number, heard=heard)))
        else:
            turn.go_on(now)
            self._relay("continue", encode(event))

    async def _revise(self, turn: SpokenTurn, event: g.Splice | g.Seek) -> None:
        now = self._service.clock.now()
        if isinstance(event, g.Splice):
            cut = turn.splice(event.char, event.heard, now)
        else:
            cut = turn.seek(event.back, event.heard, now)
        if cut:
            await self.send(g.Discard(turn=turn.number, sample=cut[0], char=cut[1]))

    async def _interrupt(self, turn: Turn, event: g.Interrupt) -> None:
        if turn.interrupt:
            return
        turn.interrupt = event
        if turn.task:
            turn.task.cancel()
        elif not turn.over:
            await self._done(turn, "interrupted")

    # what is spoken

    async def _speak_turns(self) -> None:
        free_since = 0.0
        while True:
            turn = await self._queue.get()
            if turn.over:
                continue
            turn.called = max(turn.opened, free_since)
            turn.task = asyncio.create_task(self._speak(turn))
            try:
                await turn.task
                await self._done(turn, "end")
            except asyncio.CancelledError:
                me = asyncio.current_task()
                if me and me.cancelling():
                    raise  # the session is over, whether or not the turn was interrupted as well
                await self._done(turn, "interrupted")
            except FapstreamError as e:
                await self._refuse(turn.number, e)
                await self._done(turn, "failed")
            except Exception:
                log.exception("turn %d failed", turn.number, extra={"session": self.id})
                await self.fail("internal", "the server made a mistake; please connect again")
                return
            free_since = self._service.clock.now()

    async def _speak(self, turn: Turn) -> None:
        clock = self._service.clock
        shared = self.audience is not None
        lead, group = (SHARED_LEAD_S, 0.0) if shared else (LEAD_S - GROUP_S, GROUP_S)

        def heard_s() -> float:
            return turn.pacer.heard(clock.now()) / turn.sample_rate if turn.pacer else 0.0

        begin = await turn.open(self._service, self._hello.fps or 25, heard_s)
        now = clock.now()
        follows = self._heard_at if self._heard_at > now else None
        turn.pacer = Pacer(turn.sample_rate, lead, group, follows)
        try:
            await self.send(begin)
            cuts = -1
            while cuts != len(turn.cuts):  # after its last packet a turn may still be revised
                cuts = len(turn.cuts)
                async with aclosing(turn.packets()) as packets:
                    async for packet in packets:
                        await self._send_packet(turn, packet)
        finally:
            await turn.aclose()

    async def _send_packet(self, turn: Turn, packet: Packet) -> None:
        """Send it when its time has come, unless it is void by then."""
        clock, pacer = self._service.clock, turn.pacer
        assert pacer
        cuts, came = len(turn.cuts), clock.now()
        await self._room()
        while True:
            await turn.going.wait()
            due = pacer.due(packet.start, clock.now())
            await clock.sleep_until(due)
            if turn.going.is_set():
                break
        valid = turn.still_valid(packet, cuts)
        if valid is None:
            return
        end, now = valid.start + len(valid.pcm), clock.now()
        self._measure(turn, now - max(came, due), now)
        turn.sent = end
        pacer.sent(valid.start, end, now)
        data, key = self.session.send_packet(valid)
        self._relay("packet", data, key)
        await self._write(data)

    def _measure(self, turn: Turn, late_s: float, now: float) -> None:
        """Figures of a packet that leaves now, `late_s` after it was due or made."""
        meter = self._service.meter
        if not turn.sent and not turn.cuts:
            meter.time("first_audio", now - turn.called)
        meter.time("packet_lateness", max(0.0, late_s))
        if late_s > LATE_S:
            meter.count("late_packets")
        self._service.sent(late_s, now)

    async def _done(self, turn: Turn, reason: Reason) -> None:
        turn.over = True
        now = self._service.clock.now()
        self._heard_at = turn.pacer.ends(now) if turn.pacer and reason != "interrupted" else now
        self._turns.pop(turn.number, None)
        self._service.meter.count("turns", label=reason)
        if reason != "interrupted":
            await self.send(g.Done(turn=turn.number, reason=reason, samples=turn.sent))
            return
        said = turn.interrupt.heard if turn.interrupt else None
        heard = turn.heard(said, self._service.clock.now())
        char = turn.heard_char(heard)
        await self.send(
            g.Done(turn=turn.number, reason="interrupted", samples=turn.sent, heard=heard, char=char)
        )

    async def _refuse(self, turn: int, error: FapstreamError, failed: bool = False) -> None:
        """Say so; `failed`: that is the end of the turn, or it never began."""
        self._service.meter.count("errors", label=error.code)
        await self.send(g.Error(code=error.code, message=str(error)[:1000], fatal=False, turn=turn))
        if failed:
            await self.send(g.Done(turn=turn, reason="failed", samples=0))

    # what goes out

    async def send(self, message: g.ServerMessage) -> None:
        """Send it, or keep it until the client is back. Returns when the connection takes more."""
        data = self.session.send(message)
        self._relay(message.type, data)
        await self._write(data)

    async def _write(self, data: bytes) -> None:
        link = self.link
        if link is None:
            return
        link.write(data)
        self._service.meter.count("sent_bytes", len(data))
        self.session.sent.shrink(g.RING_MS)
        if link.backlog > HIGH_WATER:
            await self._drained(link)

    async def fail(self, code: str, message: str) -> None:
        """Tell the client why, and close."""
        link = self.link
        with suppress(FapstreamError):
            await self.send(g.Error(code=code, message=message[:1000], fatal=True))
        self.session.state = "closed"
        if link:
            await link.close(1002 if code != "internal" else 1011, code)

    async def goodbye(self, reason: str) -> None:
        """The server goes down."""
        link = self.link
        with suppress(LocalProtocolError):
            await self.send(g.Bye(reason=reason))
        if link:
            await link.close(1001, reason)

    def _relay(self, kind: str, data: bytes, key: bool = False) -> None:
        if self.audience:
            self.audience.tell(kind, data, key)

    async def _room(self) -> None:
        """While nobody takes what is made, no more is made than the ring holds."""
        while self.link is None and self.session.sent.weight >= g.RING_MS:
            self._taken.clear()
            await self._taken.wait()

    async def _drained(self, link: Link) -> None:
        """A client that does not read is dropped; it may come back."""
        try:
            await drained(link)
        except ConnectionClosed:
            self.detach(link)
        except TimeoutError:
            self.detach(link)
            await link.close(1008, "the client does not read")
