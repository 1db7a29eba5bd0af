"""A turn from its first fragment to its `done`."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncGenerator, Callable
from dataclasses import dataclass, field, replace
from typing import Literal

from fapstream.ears import Ears
from fapstream.errors import InputError, TextTooLong
from fapstream.hearing import Hearing
from fapstream.pipeline import Pipeline
from fapstream.protocol import generated as g
from fapstream.records import Packet, Pcm, TurnFormat
from fapstream.server.service import Service
from fapstream.stream import Pacer
from fapstream.talk import MAX_PENDING_TEXT, Talk
from fapstream.tts import PHRASE, FrontEnd, Manner
from fapstream.tts.voices import Voice

Fps = Literal[25, 50]

ON_THE_WAY_S = 0.15
"""What is heard until a client has been told of a cut: nothing of it can be taken back."""


class TooManyTurns(InputError):
    """More turns wait than the protocol allows."""

    code = "too_many_turns"

    def __init__(self, waiting: int) -> None:
        super().__init__(f"{waiting} turns are waiting already; wait until one is done")
        self.waiting = waiting


def _going() -> asyncio.Event:
    event = asyncio.Event()
    event.set()
    return event


@dataclass(slots=True)
class Turn:
    """What turns of text and of sound have in common."""

    number: int
    """Its id."""
    sample_rate: int
    opened: float
    """When its first fragment came, on the server's clock."""
    called: float = 0.0
    """When it could begin: then, or when the turn before it was over."""
    ended: bool = False
    pacer: Pacer | None = None
    task: asyncio.Task[None] | None = None
    sent: int = 0
    """Samples sent, as far as they are not void."""
    interrupt: g.Interrupt | None = None
    over: bool = False
    going: asyncio.Event = field(default_factory=_going)
    """Clear while it is paused."""
    cuts: list[int] = field(default_factory=list)
    """Samples at which it was revised."""

    @property
    def text_waiting(self) -> int:
        """Characters that are not spoken yet."""
        return 0

    def end(self) -> None:
        """Its text or sound is complete."""
        self.ended = True

    async def open(self, service: Service, fps: Fps, clear_s: Callable[[], float]) -> g.Begin:
        """Its turn has come: what it begins with. `clear_s`: how many seconds of it have been heard. Raises
        SynthesisError."""
        raise NotImplementedError

    def packets(self) -> AsyncGenerator[Packet, None]:
        """Its packets, in order, as early as they can be made; again after a cut."""
        raise NotImplementedError

    async def aclose(self) -> None:
        """Give back what it holds."""

    def heard_char(self, sample: int) -> int:
        """Code points of its text heard by a sample."""
        return 0

    def heard(self, said: int | None, now: float) -> int:
        """Samples heard: as the client said, else as we think; never more than were sent."""
        thought = self.pacer.heard(now) if self.pacer else 0
        return min(thought if said is None else said, self.sent)

    def pause(self, said: int | None, now: float) -> None:
        """Stop after what was heard."""
        self.going.clear()
        if self.pacer:
            if said is not None:
                self.pacer.acknowledge(said, now)
            self.pacer.pause(now)

    def go_on(self, now: float) -> None:
        """Go on after a pause."""
        if self.pacer:
            self.pacer.go_on(now)
        self.going.set()

    def still_valid(self, packet: Packet, cuts: int) -> Packet | None:
        """What is left of a packet that was made when there were so many cuts."""
        for cut in self.cuts[cuts:]:
            if packet.start >= cut:
                return None
            packet = _until(packet, cut)
        return packet


class SpokenTurn(Turn):
    """A turn of text. Until it is spoken its text waits here."""

    __slots__ = ("_opening", "_talk", "_text", "_voice")

    def __init__(self, opening: g.Speak, voice: Voice, opened: float) -> None:
        super().__init__(opening.turn, voice.sample_rate, opened)
        self._opening, self._voice = opening, voice
        self._text: list[str] = []
        self._talk: Talk | None = None

    @property
    def text_waiting(self) -> int:
        """See Turn."""
        return MAX_PENDING_TEXT - self._talk.room if self._talk else sum(map(len, self._text))

    def feed(self, text: str) -> None:
        """More text. Raises TextTooLong, and takes none of it."""
        if self._talk:
            self._talk.feed(text)
            return
        waiting = self.text_waiting + len(text)
        if waiting > MAX_PENDING_TEXT:
            raise TextTooLong(waiting, MAX_PENDING_TEXT)
        self._text.append(text)

    def end(self) -> None:
        """See Turn."""
        self.ended = True
        if self._talk:
            self._talk.end()

    async def open(self, service: Service, fps: Fps, clear_s: Callable[[], float]) -> g.Begin:
        """See Turn: a voice is acquired."""
        voice = self._voice
        manner = manner_of(self._opening, service, voice.lang).of(voice)
        synthesizer = await service.voices.acquire(voice)
        form = TurnFormat(self.number, voice.name, voice.lang, voice.sample_rate, fps)
        pipeline = Pipeline(form, FrontEnd(voice.lang, manner), self.number, service.motion)
        self.hand_over(Talk(pipeline, synthesizer, clear_s, lambda: service.voices.acquire(voice)))
        return g.Begin(
            turn=self.number, voice=voice.name, lang=voice.lang, sample_rate=voice.sample_rate, fps=fps
        )

    def hand_over(self, talk: Talk) -> None:
        """Text that came while the turn waited goes to its talk, and from now on all text."""
        for text in self._text:
            talk.feed(text)
        self._text.clear()
        self._talk = talk
        if self.ended:
            talk.end()

    def packets(self) -> AsyncGenerator[Packet, None]:
        """See Turn."""
        assert self._talk
        return self._talk.packets()

    async def aclose(self) -> None:
        """See Turn: the voice."""
        if self._talk:
            await self._talk.aclose()

    def heard_char(self, sample: int) -> int:
        """See Turn."""
        return self._talk.heard_char(sample) if self._talk and sample else 0

    def splice(self, char: int, said: int | None, now: float) -> tuple[int, int] | None:
        """Drop the text from a character on: the first void sample, and the characters that stay. None for a
        turn that is not spoken yet: its text alone is changed.
        """
        self.ended = False
        if self._talk is None:
            self._text = ["".join(self._text)[:char]]
            return None
        return self._void(self._talk.splice(self._soon(said, now), char))

    def seek(self, back: int, said: int | None, now: float) -> tuple[int, int] | None:
        """Say it again from the beginning of a sentence: the first void sample, and the character said next.
        None for a turn that is not spoken yet.
        """
        if self._talk is None:
            return None
        found = self._void(self._talk.seek(self._soon(said, now), back))
        if self.ended:
            self._talk.end()
        return found

    def _soon(self, said: int | None, now: float) -> int:
        """A sample that will not be heard before the client knows."""
        return self.heard(said, now) + round(ON_THE_WAY_S * self.sample_rate)

    def _void(self, cut: tuple[int, int]) -> tuple[int, int]:
        assert self.pacer
        self.cuts.append(cut[0])
        self.sent = min(self.sent, cut[0])
        self.pacer.discard(cut[0])
        return cut


class HeardTurn(Turn):
    """A turn of sound. It is heard from the first fragment on, whether or not its turn has come."""

    __slots__ = ("_ears", "_lang")

    def __init__(self, opening: g.Hear, service: Service, fps: Fps, lang: str) -> None:
        assert opening.sample_rate
        super().__init__(opening.turn, opening.sample_rate, service.clock.now())
        form = TurnFormat(self.number, "", lang, opening.sample_rate, fps)
        self._ears = Ears(Hearing(form, self.number, service.motion))
        self._lang = lang

    def feed(self, pcm: Pcm) -> None:
        """More sound. Raises SoundTooLong, and takes none of it."""
        self._ears.feed(pcm)

    def end(self) -> None:
        """See Turn."""
        self.ended = True
        self._ears.end()

    async def open(self, service: Service, fps: Fps, clear_s: Callable[[], float]) -> g.Begin:
        """See Turn."""
        rate, delay = self.sample_rate, self._ears.delay
        return g.Begin(turn=self.number, voice="", lang=self._lang, sample_rate=rate, fps=fps, delay=delay)

    def packets(self) -> AsyncGenerator[Packet, None]:
        """See Turn."""
        return self._ears.packets()


def _until(packet: Packet, end: int) -> Packet:
    if packet.start + len(packet.pcm) <= end:
        return packet
    return replace(
        packet,
        pcm=packet.pcm[: end - packet.start],
        frames=tuple(f for f in packet.frames if f.sample < end),
        marks=tuple(m for m in packet.marks if m.sample < end),
    )


def manner_of(opening: g.Speak, service: Service, lang: str) -> Manner:
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
