"""protocol/SPEC.md 4.4: what those who listen get, whenever they come, and what is left out for them."""

from __future__ import annotations

import time
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.errors import RemoteProtocolError
from fapstream.protocol import generated as g
from fapstream.protocol.codec import encode
from fapstream.protocol.session import ClientSession
from fapstream.records import Packet
from fapstream.server.channel import Channel, Stage, pack_entry, unpack_entry
from tests.unit.fakes import FakeBus, FakeVoices, in_virtual_time
from tests.unit.server.peer import Peer, World
from tests.unit.server.test_connection import TEXT, say

LONG = TEXT * 12


class Ear:
    """A listener who decodes what it gets as a client does."""

    def __init__(self) -> None:
        self.session = ClientSession()
        self.session.send(g.Listen(channel="news"))
        ready = g.Ready(server="s", session="1", fps=25, faps=bytes(range(3, 69)), voices=(), heads=())
        self.session.receive(encode(ready))
        self.events: list[Any] = []

    def offer(self, item: Any) -> None:
        self.events += self.session.receive(encode(item.message))

    def of(self, kind: type) -> list[Any]:
        return [e for e in self.events if isinstance(e, kind)]


def words(events: list[Any]) -> list[str]:
    return [m.text for e in events if isinstance(e, Packet) for m in e.marks if m.kind == "word"]


async def spoken(text: str = LONG, turns: int = 1) -> list[bytes]:
    """What the bus carries of a talk."""
    world = World(FakeVoices())
    p = Peer(world.voices, world=world)
    p.send(g.Hello(channel="news"))
    for turn in range(1, turns + 1):
        p.send(*say(turn, text))
    for turn in range(1, turns + 1):
        await p.rest_of_turn(turn)
    await p.gone()
    return [e for e in world.bus.entries["news"] if e]


def taken(entries: list[bytes | None], late: int = 0) -> Ear:
    """A listener who comes after `late` entries."""
    channel, ear = Channel("news", lambda: 0.0), Ear()
    for i, entry in enumerate([*entries, None][: len(entries)]):
        if i == late:
            channel.join(ear)
        channel.take(entry)
    return ear


@in_virtual_time
async def test_who_listens_from_the_beginning_gets_everything_once() -> None:
    ear = taken(list(await spoken(turns=2)))
    assert [e.turn for e in ear.of(g.Begin)] == [1, 2]
    assert [e.turn for e in ear.of(g.Done)] == [1, 2]
    for turn, done in zip((1, 2), ear.of(g.Done), strict=True):
        packets = [p for p in ear.of(Packet) if p.turn == turn]
        assert sum(len(p.pcm) for p in packets) == done.samples
        assert all(a.start + len(a.pcm) == b.start for a, b in pairwise(packets))
    assert [e.on for e in ear.of(g.Live)] == [False, True, False]


@in_virtual_time
async def test_who_comes_late_starts_with_a_key_the_word_and_the_caption() -> None:
    entries = list(await spoken())
    whole = taken(entries)
    faces = {f.sample: f.values for p in whole.of(Packet) for f in p.frames}
    for late in range(3, len(entries) - 40, 37):
        ear = taken(entries, late)
        begin = ear.of(g.Begin)[0]
        packets = ear.of(Packet)
        assert packets[0].start == (begin.sample or 0)
        for packet in packets:
            for frame in packet.frames:
                assert (frame.values == faces[frame.sample]).all()
        all_words = words(whole.events)
        assert words(ear.events) == all_words[len(all_words) - len(words(ear.events)) :]
        if begin.sample:
            before = [m for p in whole.of(Packet) if p.start < begin.sample for m in p.marks]
            word = next(m for m in reversed(before) if m.kind == "word")
            caption = next(m for m in reversed(before) if m.kind == "caption")
            assert [m.text for m in begin.marks] == [caption.text, word.text]


@in_virtual_time
async def test_a_gap_on_the_bus_is_said_and_it_goes_on_with_a_key() -> None:
    entries: list[bytes | None] = list(await spoken())
    at = len(entries) // 2
    ear = taken([*entries[:at], None, *entries[at + 40 :]])
    assert [e.reason for e in ear.of(g.Skip)] == ["bus"]
    i = ear.events.index(ear.of(g.Skip)[0])
    begin, first = ear.events[i + 1 : i + 3]
    assert isinstance(begin, g.Begin)
    assert first.start == begin.sample
    whole = {f.sample: f.values for p in taken(entries).of(Packet) for f in p.frames}
    assert all((f.values == whole[f.sample]).all() for p in ear.of(Packet) for f in p.frames)
    assert ear.of(g.Done)


@in_virtual_time
async def test_a_process_that_subscribes_late_knows_within_a_second_of_sound_what_is_spoken() -> None:
    entries = list(await spoken())
    for start in range(0, len(entries) - 60, 23):
        ear = taken(list(entries[start:]))
        assert ear.of(g.Begin)
        first = ear.of(Packet)[0].start
        missed = [i for i in range(start) if b"packet" in entries[i]]
        assert first <= (len(missed) + g.KEY_PACKETS) * 640


@in_virtual_time
async def test_who_was_here_before_goes_on_without_a_gap() -> None:
    entries = list(await spoken())
    talk, _ = unpack_entry(entries[0])
    channel, ear = Channel("news", lambda: 0.0), Ear()
    channel.join(ear)
    for entry in entries[:200]:
        channel.take(entry)
    channel.leave(ear)
    had = ear.of(Packet)[-1]
    end = had.start + len(had.pcm)
    for entry in entries[200:300]:
        channel.take(entry)
    ear.session.reconnect()
    ear.session.send(g.Listen(channel="news", talk=talk, turn=1, sample=end))
    channel.join(ear, (talk, 1, end))
    for entry in entries[300:]:
        channel.take(entry)
    packets = ear.of(Packet)
    assert all(a.start + len(a.pcm) == b.start for a, b in pairwise(packets))
    assert len(ear.of(g.Begin)) == 1
    assert not ear.of(g.Skip)


@in_virtual_time
async def test_the_newest_speaker_has_the_channel() -> None:
    old, new = list(await spoken("old. ")), list(await spoken("new. "))
    first, second = sorted((old, new), key=lambda entries: unpack_entry(entries[0])[0])
    mixed = [e for pair in zip(first, second, strict=False) for e in pair]
    ear = taken(list(mixed))
    talk = unpack_entry(second[0])[0]
    assert [e.talk for e in ear.of(g.Live) if e.on][-1] == talk
    i = max(ear.events.index(e) for e in ear.of(g.Live) if e.on)
    assert set(words(ear.events[i:])) <= {"new" if second is new else "old"}


@in_virtual_time
async def test_the_older_speaker_is_told() -> None:
    world = World(FakeVoices())
    old = Peer(world.voices, world=world)
    old.send(g.Hello(channel="news"))
    await old.until(g.Ready)
    time.sleep(0.002)  # names of talks sort by the millisecond they began
    new = Peer(world.voices, world=world)
    new.send(g.Hello(channel="news"))
    await new.until(g.Ready)
    error = await old.until(g.Error)
    assert (error.code, error.fatal) == ("channel_taken", True)
    await old.running
    new.send(*say(1))
    assert (await new.until(g.Done)).reason == "end"
    await new.gone()
    assert world.gate.inside == 0


def test_a_speaker_who_falls_silent_is_gone() -> None:
    now = 0.0
    channel, ear = Channel("news", lambda: now), Ear()
    channel.join(ear)
    bus = FakeBus()
    Stage(bus, "news", "1")
    channel.take(bus.entries["news"][0])
    now = 6.9
    channel.look()
    assert [e.on for e in ear.of(g.Live)] == [False, True]
    now = 7.1
    channel.look()
    assert [e.on for e in ear.of(g.Live)] == [False, True, False]


@pytest.mark.parametrize("message", [g.Pong(id=1), g.Error(code="x", message="", fatal=False)])
def test_what_is_between_the_server_and_the_speaker_goes_no_further(message: g.ServerMessage) -> None:
    bus = FakeBus()
    stage = Stage(bus, "news", "1")
    stage.tell(message.type, encode(message))
    assert len(bus.entries["news"]) == 1, "that it is there"


@given(st.binary(max_size=64))
def test_no_entry_whatever_harms_a_channel(entry: bytes) -> None:
    channel, ear = Channel("news", lambda: 0.0), Ear()
    channel.join(ear)
    channel.take(entry)
    channel.take(pack_entry("1", entry))


@settings(deadline=None)
@given(st.lists(st.integers(0, 200), max_size=20))
def test_entries_may_be_lost_anywhere(lost: list[int]) -> None:
    """What a listener decodes is never wrong, whatever the bus loses as long as it says so."""
    entries: list[bytes | None] = list(ENTRIES)
    for at in sorted(set(lost), reverse=True):
        entries[at : at + 3] = [None]
    ear = taken(entries)
    packets = ear.of(Packet)
    assert all(a.start + len(a.pcm) <= b.start for a, b in pairwise(packets))


def _entries() -> list[bytes]:
    out: list[bytes] = []

    @in_virtual_time
    async def run() -> None:
        out.extend(await spoken(TEXT * 3))

    run()
    return out


ENTRIES = _entries()


def test_entries_are_read_back() -> None:
    assert unpack_entry(pack_entry("5f1e", b"data")) == ("5f1e", b"data")
    for bad in (b"", b"\x05abc"):
        with pytest.raises(ValueError, match="cut off"):
            unpack_entry(bad)
    with pytest.raises(RemoteProtocolError):
        ClientSession().receive(b"")
