"""protocol/SPEC.md 4.4: a listener that takes too little gets less, then nothing, then is let go."""

from __future__ import annotations

import asyncio
from typing import Any, Literal

import pytest

from fapstream.protocol import generated as g
from fapstream.server.listener import GIVE_UP_S, SKIP_BYTES, THIN_BYTES
from tests.unit.fakes import FakeVoices, in_virtual_time
from tests.unit.server.peer import Peer, World
from tests.unit.server.test_connection import TEXT, say
from tests.unit.server.test_conversation import received

LONG = TEXT * 12


async def listening(world: World, **wishes: Any) -> Peer:
    p = Peer(world.voices, world=world)
    p.send(g.Listen(channel="news", **wishes))
    ready = await p.next()
    assert isinstance(ready, g.Ready)
    assert ready.channel == "news"
    assert isinstance(await p.next(), g.Live)
    return p


async def speaking(world: World, text: str = LONG) -> Peer:
    p = Peer(world.voices, world=world)
    p.send(g.Hello(channel="news"))
    await p.until(g.Ready)
    p.send(*say(1, text))
    return p


def packets(p: Peer) -> list[g.Packet]:
    return [m for m in received(p) if isinstance(m, g.Packet)]


@pytest.mark.parametrize("prefer", ["sound", "face"])
@in_virtual_time
async def test_a_slow_listener_gets_what_it_prefers(prefer: Literal["sound", "face"]) -> None:
    world = World(FakeVoices())
    slow, other = await listening(world, prefer=prefer), await listening(world)
    slow.socket.backlog = THIN_BYTES + 1
    speaker = await speaking(world)
    await asyncio.sleep(3)
    thin, whole = packets(slow), packets(other)
    assert [p.sample for p in thin] == [p.sample for p in whole]
    for a, b in zip(thin, whole, strict=True):
        assert (a.mask is None) == (prefer == "sound")
        assert a.marks == b.marks
        if prefer == "face":
            assert a.pcm is None
            assert (a.samples, a.mask, a.key) == (len(b.pcm), b.mask, b.key)
    slow.socket.backlog = 0
    await asyncio.sleep(1)
    assert all(p.pcm is not None and p.mask for p in packets(slow))
    for p in (slow, other, speaker):
        await p.gone()
    assert world.gate.inside == 0


@in_virtual_time
async def test_a_stuck_listener_skips_to_live_and_holds_nobody_up() -> None:
    world = World(FakeVoices())
    stuck, other = await listening(world), await listening(world)
    speaker = await speaking(world)
    await asyncio.sleep(1)
    before = packets(stuck)
    stuck.socket.backlog = SKIP_BYTES + 1
    await asyncio.sleep(4)
    assert not received(stuck)
    assert len(packets(other)) > 100
    stuck.socket.backlog = 0
    await asyncio.sleep(2)
    skip, begin, first, *_ = received(stuck)
    assert skip == g.Skip(reason="slow")
    assert isinstance(begin, g.Begin)
    assert isinstance(first, g.Packet)
    assert first.key
    assert begin.sample == first.sample > before[-1].sample
    assert {m.kind for m in begin.marks or ()} == {"caption", "word"}
    for p in (stuck, other, speaker):
        await p.gone()


@in_virtual_time
async def test_who_never_catches_up_is_let_go() -> None:
    world = World(FakeVoices())
    stuck = await listening(world)
    speaker = await speaking(world, LONG * 4)
    await asyncio.sleep(1)
    received(stuck)
    stuck.socket.backlog = SKIP_BYTES + 1
    await asyncio.sleep(GIVE_UP_S + 3)
    [error] = received(stuck)
    assert isinstance(error, g.Error)
    assert (error.code, error.fatal) == ("too_slow", True)
    assert stuck.socket.closed == (1013, "too slow")
    await asyncio.wait_for(stuck.running, 5)
    await speaker.gone()
    assert world.gate.inside == 0


@in_virtual_time
async def test_a_listener_may_ping_and_acknowledge_but_not_speak() -> None:
    world = World(FakeVoices())
    p = await listening(world)
    p.send(g.Ping(id=3), g.Ack(turn=1, sample=0, queue=0, underruns=0, skew=0))
    assert (await p.next()).id == 3
    p.send(*say(1))
    error = await p.next()
    assert (error.code, error.fatal) == ("protocol", True)
    await p.running
    assert world.gate.inside == 0


@in_virtual_time
async def test_a_channel_that_is_none_is_told() -> None:
    world = World(FakeVoices())
    for message in (g.Listen(channel="olds"), g.Hello(channel="olds")):
        p = Peer(world.voices, world=world)
        p.send(message)
        error = await p.next()
        assert (error.code, error.fatal) == ("unknown_channel", True)
        assert "news" in error.message
        await p.running
    assert world.gate.inside == 0
