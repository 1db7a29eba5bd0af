"""A channel as this process has it: what the bus brings, made once and given to all who listen here."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

from fapstream.errors import RemoteProtocolError
from fapstream.ports import Bus
from fapstream.protocol import generated as g
from fapstream.protocol.codec import decode, encode
from fapstream.server.link import framed

KEEP_PACKETS = g.RING_MS // g.PACKET_MS
JOIN_PACKETS = 10
"""One who comes late begins with a key at least so far back: that is its first store."""

BEAT_S = 2.0
"""So often a speaker says that it is there."""

RELAYED = frozenset({"begin", "packet", "discard", "pause", "continue", "done"})
"""What is spoken; the rest is between the server and the speaker."""

SILENT_S = 7.0
"""A speaker of whom nothing has come for so long is gone."""


class Item:
    """One message on its way to listeners; each form of it is made at most once."""

    def __init__(self, message: g.ServerMessage, data: bytes, in_force: tuple[g.Mark, ...] = ()) -> None:
        self.message = message
        self.in_force = in_force
        """Word and caption that hold where a packet begins."""
        self.whole = framed(data)

    @cached_property
    def without_face(self) -> bytes:
        """The packet without its frames."""
        assert isinstance(self.message, g.Packet)
        return framed(encode(replace(self.message, key=None, mask=None, faps=None, wide=None)))

    @cached_property
    def without_sound(self) -> bytes:
        """The packet without its sound."""
        assert isinstance(self.message, g.Packet)
        return framed(encode(replace(self.message, pcm=None, samples=length_of(self.message))))


def length_of(packet: g.Packet) -> int:
    """Samples that a packet lasts."""
    return packet.samples or 0 if packet.pcm is None else len(packet.pcm)


class Listener(Protocol):
    """Whoever the channel tells."""

    def offer(self, item: Item) -> None:
        """The next message. Returns at once."""


@dataclass(slots=True)
class _State:
    """What one who comes now has to know."""

    talk: str | None = None
    on: bool = False
    heard_of: float = 0.0
    begin: g.Begin | None = None
    announced: bool = False
    """Listeners know of the turn."""
    ring: deque[Item] = field(default_factory=lambda: deque(maxlen=KEEP_PACKETS))
    end: int = 0
    """Samples of the turn that have come."""
    word: g.Mark | None = None
    caption: g.Mark | None = None
    broken: bool = False
    """Something is missing: what comes is of use from the next key on."""

    @property
    def in_force(self) -> tuple[g.Mark, ...]:
        return tuple(m for m in (self.caption, self.word) if m)


class Channel:
    """`now`: the server's clock."""

    def __init__(self, name: str, now: Callable[[], float]) -> None:
        self.name = name
        self.listeners: set[Listener] = set()
        self._now = now
        self._state = _State()

    # what comes

    def take(self, entry: bytes | None) -> None:
        """What the bus brings; None: something may be missing here."""
        if entry is None:
            self._state.broken = True
            self._tell(g.Skip(reason="bus"))
            return
        try:
            talk, data = unpack_entry(entry)
            message = decode(data, "server")
        except (RemoteProtocolError, ValueError):
            return  # another version of us, or somebody else's: nobody is harmed by leaving it out
        if isinstance(message, g.Live):
            self._live(message, talk)
        elif talk == self._state.talk:
            self._state.heard_of = self._now()
            self._follow(message, data)

    def look(self) -> None:
        """Now and then: a speaker that fell silent without a word is gone."""
        state = self._state
        if state.on and self._now() - state.heard_of > SILENT_S:
            self._go(False, state.talk)

    def _live(self, message: g.Live, talk: str) -> None:
        state = self._state
        if talk == state.talk:
            state.heard_of = self._now()
            if message.on != state.on:
                self._go(message.on, talk)
        elif message.on and (not state.on or talk > (state.talk or "")):
            self._state = _State(talk, heard_of=self._now())
            self._go(True, talk)

    def _go(self, on: bool, talk: str | None) -> None:
        self._state.on = on
        if not on:
            self._state.begin = None
            self._state.ring.clear()
        self._tell(g.Live(channel=self.name, on=on, talk=talk))

    def _follow(self, message: g.Message | None, data: bytes) -> None:
        match message:
            case g.Begin():
                self._begin(message)
            case g.Packet():
                self._packet(message, data)
            case g.Discard():
                self._discard(message, data)
            case g.Done():
                self._state.begin = None
                self._state.ring.clear()
                self._offer(Item(message, data))
            case g.Pause() | g.Continue():
                self._offer(Item(message, data))
            case _:
                pass

    def _begin(self, message: g.Begin) -> None:
        """A turn begins, or is said again to have begun for those who did not know."""
        state = self._state
        if state.begin and state.begin.turn == message.turn:
            return
        state.begin, state.word, state.caption = message, None, None
        state.announced, state.end = False, 0
        state.ring.clear()

    def _packet(self, message: g.Packet, data: bytes) -> None:
        state = self._state
        new = not state.announced or state.broken
        if state.begin is None or message.turn != state.begin.turn or (new and not message.key):
            return
        if message.sample < state.end:
            return  # the bus says again what it said before
        state.end = message.sample + length_of(message)
        item = Item(message, data, state.in_force)
        if new:
            state.announced, state.broken = True, False
            state.ring.clear()
            self._offer(self._begin_at(item))
        state.ring.append(item)
        for mark in message.marks or ():
            if mark.kind == "word":
                state.word = mark
            elif mark.kind == "caption":
                state.caption = mark
        self._offer(item)

    def _discard(self, message: g.Discard, data: bytes) -> None:
        ring = self._state.ring
        while ring and _end_of(ring[-1]) > message.sample:
            ring.pop()
        self._state.word = self._state.caption = None
        self._state.end = min(self._state.end, message.sample)
        self._offer(Item(message, data))

    # who listens

    def join(self, listener: Listener, after: tuple[str, int, int] | None = None) -> None:
        """A listener comes; `after`: talk, turn and sample up to which it has everything already."""
        state = self._state
        listener.offer(_item(g.Live(channel=self.name, on=state.on, talk=state.talk)))
        for item in self._missed(after) if after else self._recent():
            listener.offer(item)
        self.listeners.add(listener)

    def leave(self, listener: Listener) -> None:
        """It is gone."""
        self.listeners.discard(listener)

    def begin_at(self, item: Item) -> Item | None:
        """What to say before `item` to a listener that did not get what lies before it."""
        return self._begin_at(item) if self._state.begin and _packet_of(item).key else None

    def _begin_at(self, item: Item) -> Item:
        assert self._state.begin
        sample = _packet_of(item).sample or None
        return _item(replace(self._state.begin, sample=sample, marks=item.in_force or None))

    def _recent(self) -> list[Item]:
        """For one who comes in the middle of a turn: from a key on that lies a little back."""
        ring = list(self._state.ring)
        keys = [i for i, item in enumerate(ring) if _packet_of(item).key]
        if not keys:
            return []
        start = max((i for i in keys if i <= len(ring) - JOIN_PACKETS), default=keys[0])
        return [self._begin_at(ring[start]), *ring[start:]]

    def _missed(self, after: tuple[str, int, int]) -> list[Item]:
        """For one who was here before."""
        talk, turn, sample = after
        ring = list(self._state.ring)
        begin = self._state.begin
        if not (ring and begin and talk == self._state.talk and turn == begin.turn):
            return self._recent()
        if not _packet_of(ring[0]).sample <= sample:
            return [_item(g.Skip(reason="slow")), *self._recent()]
        return [item for item in ring if _packet_of(item).sample >= sample]

    def _tell(self, message: g.ServerMessage) -> None:
        self._offer(_item(message))

    def _offer(self, item: Item) -> None:
        for listener in tuple(self.listeners):
            listener.offer(item)


def _item(message: g.ServerMessage) -> Item:
    return Item(message, encode(message))


def _end_of(item: Item) -> int:
    packet = _packet_of(item)
    return packet.sample + length_of(packet)


def _packet_of(item: Item) -> g.Packet:
    assert isinstance(item.message, g.Packet)
    return item.message


# what goes over the bus


def pack_entry(talk: str, data: bytes) -> bytes:
    """A message and whose it is. `talk`: ASCII, at most 255 characters."""
    name = talk.encode("ascii")
    return bytes((len(name),)) + name + data


def unpack_entry(entry: bytes) -> tuple[str, bytes]:
    """The talk and the frame. Raises ValueError."""
    if not entry or len(entry) < 1 + entry[0]:
        raise ValueError("an entry that is cut off")
    end = 1 + entry[0]
    return entry[1:end].decode("ascii"), entry[end:]


class Stage:
    """A conversation's way into a channel. Names of talks sort by when they began: the newest has it."""

    def __init__(self, bus: Bus, name: str, talk: str) -> None:
        self.name = name
        self._bus = bus
        self._talk = talk
        self._begin: bytes | None = None
        self.beat()

    def tell(self, kind: str, data: bytes, key: bool = False) -> None:
        """See Audience. With every key it is said again who speaks and what began, for those who come."""
        if kind not in RELAYED:
            return
        if kind == "begin":
            self._begin = data
        elif kind == "done":
            self._begin = None
        elif key and self._begin:
            self.beat()
            self._publish(self._begin)
        self._publish(data)

    def beat(self) -> None:
        """Say that somebody is there."""
        self._publish(encode(g.Live(channel=self.name, on=True, talk=self._talk)))

    def close(self) -> None:
        """Say that nobody is there any longer."""
        self._publish(encode(g.Live(channel=self.name, on=False, talk=self._talk)))

    def overtaken(self, entry: bytes | None) -> bool:
        """Whether an entry of the channel says that somebody else speaks now."""
        try:
            talk, data = unpack_entry(entry or b"")
            message = decode(data, "server") if talk > self._talk else None
        except (RemoteProtocolError, ValueError):
            return False
        return isinstance(message, g.Live) and message.on

    def _publish(self, data: bytes) -> None:
        self._bus.publish(self.name, pack_entry(self._talk, data))
