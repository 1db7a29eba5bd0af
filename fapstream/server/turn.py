"""A turn from its first fragment to its `done`."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field, replace

from fapstream.errors import InputError, TextTooLong
from fapstream.protocol import generated as g
from fapstream.records import Packet
from fapstream.server.service import Service
from fapstream.stream import Pacer
from fapstream.talk import MAX_PENDING_TEXT, Talk
from fapstream.tts import PHRASE, Manner
from fapstream.tts.voices import Voice

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
    """What is known of it. Until it is spoken its text waits here."""

    opening: g.Speak
    voice: Voice
    opened: float
    """When its first fragment came, on the server's clock."""
    called: float = 0.0
    """When it could begin: then, or when the turn before it was over."""
    text: list[str] = field(default_factory=list)
    ended: bool = False
    talk: Talk | None = None
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
    def number(self) -> int:
        """Its id."""
        return self.opening.turn

    @property
    def text_waiting(self) -> int:
        """Characters that are not spoken yet."""
        return MAX_PENDING_TEXT - self.talk.room if self.talk else sum(map(len, self.text))

    def feed(self, text: str) -> None:
        """More text. Raises TextTooLong, and takes none of it."""
        if self.talk:
            self.talk.feed(text)
            return
        waiting = self.text_waiting + len(text)
        if waiting > MAX_PENDING_TEXT:
            raise TextTooLong(waiting, MAX_PENDING_TEXT)
        self.text.append(text)

    def end(self) -> None:
        """The text is complete."""
        self.ended = True
        if self.talk:
            self.talk.end()

    def hand_over(self, talk: Talk) -> None:
        """Text that came while the turn waited goes to its talk, and from now on all text."""
        for text in self.text:
            talk.feed(text)
        self.text.clear()
        self.talk = talk
        if self.ended:
            talk.end()

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

    def splice(self, char: int, said: int | None, now: float) -> tuple[int, int] | None:
        """Drop the text from a character on: the first void sample, and the characters that stay. None for a
        turn that is not spoken yet: its text alone is changed.
        """
        self.ended = False
        if self.talk is None:
            self.text = ["".join(self.text)[:char]]
            return None
        return self._void(self.talk.splice(self._soon(said, now), char))

    def seek(self, back: int, said: int | None, now: float) -> tuple[int, int] | None:
        """Say it again from the beginning of a sentence: the first void sample, and the character said next.
        None for a turn that is not spoken yet.
        """
        if self.talk is None:
            return None
        found = self._void(self.talk.seek(self._soon(said, now), back))
        if self.ended:
            self.talk.end()
        return found

    def _soon(self, said: int | None, now: float) -> int:
        """A sample that will not be heard before the client knows."""
        return self.heard(said, now) + round(ON_THE_WAY_S * self.voice.sample_rate)

    def _void(self, cut: tuple[int, int]) -> tuple[int, int]:
        assert self.pacer
        self.cuts.append(cut[0])
        self.sent = min(self.sent, cut[0])
        self.pacer.discard(cut[0])
        return cut

    def still_valid(self, packet: Packet, cuts: int) -> Packet | None:
        """What is left of a packet that was made when there were so many cuts."""
        for cut in self.cuts[cuts:]:
            if packet.start >= cut:
                return None
            packet = _until(packet, cut)
        return packet


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
