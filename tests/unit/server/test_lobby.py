"""Who is there: shared sessions, pauses relayed to listeners, and what is left when all have gone."""

from __future__ import annotations

import asyncio

import pytest

from fapstream.protocol import generated as g
from fapstream.server.lobby import SHARED
from tests.unit.fakes import FakeVoices, in_virtual_time
from tests.unit.server.peer import Peer, World
from tests.unit.server.test_connection import TEXT, say
from tests.unit.server.test_conversation import received


@in_virtual_time
async def test_a_shared_session_can_be_listened_to_by_who_knows_its_name() -> None:
    world = World(FakeVoices(), channels=())
    speaker = Peer(world.voices, world=world)
    speaker.send(g.Hello(share=True))
    ready = await speaker.until(g.Ready)
    assert ready.channel
    assert ready.channel.startswith(SHARED)
    ear = Peer(world.voices, world=world)
    ear.send(g.Listen(channel=ready.channel))
    await ear.until(g.Ready)
    speaker.send(*say(1))
    mine, done = await speaker.rest_of_turn(1)
    theirs, same = await ear.rest_of_turn(1)
    assert [p.sample for p in theirs] == [p.sample for p in mine]
    assert same == done
    await speaker.gone()
    live = [m for m in received(ear) if isinstance(m, g.Live)]
    assert [m.on for m in live] == [False]
    await ear.gone()
    assert world.gate.inside == 0


@in_virtual_time
async def test_a_session_that_is_not_shared_says_nothing_to_the_bus() -> None:
    world = World(FakeVoices())
    p = Peer(world.voices, world=world)
    p.send(g.Hello(), *say(1))
    await p.rest_of_turn(1)
    assert not world.bus.entries
    await p.gone()


@in_virtual_time
async def test_pauses_and_interrupts_reach_those_who_listen() -> None:
    world = World(FakeVoices())
    ear = Peer(world.voices, world=world)
    ear.send(g.Listen(channel="news"))
    speaker = Peer(world.voices, world=world)
    speaker.send(g.Hello(channel="news"), *say(1, TEXT * 9))
    await asyncio.sleep(2)
    speaker.send(g.Pause(turn=1))
    pause = await ear.until(g.Pause)
    assert pause.heard == pytest.approx(32000, abs=2000)
    speaker.send(g.Continue(turn=1))
    assert (await ear.until(g.Continue)).turn == 1
    speaker.send(g.Interrupt(turn=1))
    assert (await ear.until(g.Done)).reason == "interrupted"
    await speaker.gone()
    await ear.gone()


@in_virtual_time
async def test_channels_that_nobody_listens_to_are_closed() -> None:
    world = World(FakeVoices())
    ear = Peer(world.voices, world=world)
    ear.send(g.Listen(channel="news"))
    await ear.until(g.Live)
    await ear.gone()
    assert not world.lobby._channels
    await world.lobby.aclose()
    assert not world.bus._queues


@in_virtual_time
async def test_the_lobby_closes_what_is_still_there() -> None:
    world = World(FakeVoices())
    ear, speaker = Peer(world.voices, world=world), Peer(world.voices, world=world)
    ear.send(g.Listen(channel="news"))
    speaker.send(g.Hello(channel="news"), *say(1, TEXT * 9))
    await ear.until(g.Packet)
    await world.lobby.goodbye("going")
    await world.lobby.aclose()
    await asyncio.wait_for(asyncio.gather(ear.running, speaker.running), 5)
    assert ear.socket.closed == speaker.socket.closed == (1001, "going")
    assert all(v.closes == 1 for v in world.voices.acquired)
    assert world.gate.inside == 0


@pytest.mark.parametrize(
    ("key", "index"),
    [(None, None), ("", None), ("0.abc", None), ("3.abc", 3), ("x.abc", None), ("-1.a", None), ("3", None)],
)
@in_virtual_time
async def test_keys_say_which_process_has_the_session(key: str | None, index: int | None) -> None:
    assert World(FakeVoices()).lobby.elsewhere(key) == index


@in_virtual_time
async def test_draining_waits_for_those_who_speak_and_not_for_those_who_are_gone() -> None:
    world = World(FakeVoices())
    here, gone = Peer(world.voices, world=world), Peer(world.voices, world=world)
    for p in (here, gone):
        p.send(g.Hello(), *say(1, TEXT * 2))
        await p.until(g.Packet)
    gone.socket.cut()
    await gone.running
    loop = asyncio.get_running_loop()
    start = loop.time()
    await world.lobby.drain(60)
    took = loop.time() - start
    assert isinstance([m for m in received(here) if not isinstance(m, g.Packet)][-1], g.Done)
    assert took < 15
    late = Peer(world.voices, world=world)
    late.send(g.Hello())
    error = await late.until(g.Error)
    assert (error.code, error.fatal) == ("busy", True)
    await world.lobby.aclose()
    await here.gone()
