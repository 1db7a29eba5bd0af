"""The client for programs against a real server on a loopback port, with voices made of arithmetic."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

import numpy as np
import pytest
from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.exceptions import ConnectionClosed
from websockets.typing import Subprotocol

import fapstream
from fapstream.client import ServerError, Talker, Turn, connect
from fapstream.errors import ProtocolError
from fapstream.protocol import generated as g
from fapstream.protocol.codec import encode
from fapstream.records import Packet
from fapstream.server import Address, running
from tests.unit.fakes import Failing, FakeVoices, fake_app
from tests.unit.voicing import voicing

LONG = "This is said for quite a while, and then for longer. " * 20


@asynccontextmanager
async def served(fail: Callable[[str], None] | None = None) -> AsyncIterator[str]:
    async with running(fake_app(FakeVoices(fail)), Address()) as server:
        yield address(server)


def address(server: Server) -> str:
    return f"ws://127.0.0.1:{server.sockets[0].getsockname()[1]}/ws"


@pytest.fixture
async def url() -> AsyncIterator[str]:
    async with served() as made:
        yield made


async def all_of(turn: Turn) -> tuple[g.Begin, list[Packet], g.Done]:
    begin, *packets, done = [event async for event in turn]
    assert isinstance(begin, g.Begin)
    assert isinstance(done, g.Done)
    return begin, [p for p in packets if isinstance(p, Packet)], done


def words(packets: list[Packet]) -> list[str]:
    return [m.text for p in packets for m in p.marks if m.kind == "word"]


async def within(seconds: float, what: object) -> object:
    return await asyncio.wait_for(what, seconds)  # type: ignore[arg-type]


def test_connect_is_the_packages_face() -> None:
    assert fapstream.connect is connect
    with pytest.raises(AttributeError):
        fapstream.nothing  # noqa: B018


async def test_say(url: str) -> None:
    async with connect(url) as talker:
        assert talker.ready.heads == ("generic",)
        turn = await talker.say("Hello there. ", lang="en")
        begin, packets, done = await all_of(turn)
        assert (begin.voice, begin.sample_rate) == ("us1", 16000)
        assert words(packets) == ["Hello", "there"]
        pcm = np.concatenate([p.pcm for p in packets])
        assert np.array_equal(pcm, np.arange(done.samples) % 32768)
        assert [f.sample for p in packets for f in p.frames] == list(range(0, done.samples, 640))
        assert turn.done == done
        assert await turn.finished() == done


async def test_defaults_and_frames_a_second(url: str) -> None:
    async with connect(url, lang="el", fps=50) as talker:
        begin, packets, _ = await all_of(await talker.say("Γεια σου."))
        assert (begin.voice, begin.fps) == ("gr2", 50)
        assert [len(p.frames) for p in packets[:-1]] == [2] * (len(packets) - 1)


async def test_rate(url: str) -> None:
    async with connect(url) as talker:
        slow, fast = await talker.say("Hello there."), await talker.say("Hello there.", rate=2.0)
        assert (await fast.finished()).samples < 0.75 * (await slow.finished()).samples


async def test_append_cut_inside_a_character(url: str) -> None:
    async with connect(url) as talker:
        turn = await talker.speak(lang="el")
        data = "Καλημέρα κόσμε. ".encode()
        for at in range(0, len(data), 3):
            await turn.append(data[at : at + 3])
        await turn.append("Ναι.")
        await turn.end()
        _, packets, _ = await all_of(turn)
        assert words(packets) == ["Καλημέρα", "κόσμε", "Ναι"]


async def test_text_longer_than_a_message_is_cut(url: str) -> None:
    async with connect(url) as talker:
        turn = await talker.speak(" " * (2 * g.MAX_FRAGMENT_BYTES + 5))
        await turn.append("yes.")
        await turn.end()
        _, packets, _ = await all_of(turn)
        [mark] = [m for p in packets for m in p.marks if m.kind == "word"]
        assert mark.char_start == 2 * g.MAX_FRAGMENT_BYTES + 5


async def test_two_turns_one_after_the_other(url: str) -> None:
    async with connect(url) as talker:
        first, second = await talker.say("one."), await talker.say("two.")
        assert words((await all_of(second))[1]) == ["two"]
        assert words((await all_of(first))[1]) == ["one"]


async def test_interrupt(url: str) -> None:
    async with connect(url) as talker:
        turn = await talker.say(LONG)
        async for event in turn:
            if isinstance(event, Packet):
                break
        done = await within(5, turn.interrupt(heard=0))
        assert isinstance(done, g.Done)
        assert (done.reason, done.heard, done.char) == ("interrupted", 0, 0)
        assert (await within(5, (await talker.say("on.")).finished())).reason == "end"  # type: ignore[attr-defined]


async def test_interrupting_what_another_task_listens_to(url: str) -> None:
    async with connect(url) as talker:
        turn = await talker.say(LONG)
        listening = asyncio.create_task(all_of(turn))
        await asyncio.sleep(0.05)
        done = await within(5, turn.interrupt())
        await within(5, asyncio.gather(listening, return_exceptions=True))
        assert turn.done is done


async def test_acknowledge(url: str) -> None:
    async with connect(url) as talker:
        turn = await talker.say(LONG)
        async for event in turn:
            if isinstance(event, Packet):
                break
        await talker.acknowledge(turn, 100, queue=540)
        done = await turn.interrupt()
        assert done.heard is not None
        assert done.heard < 4000


async def test_an_unknown_voice(url: str) -> None:
    async with connect(url) as talker:
        turn = await talker.say("Hello.", voice="nobody")
        with pytest.raises(ServerError, match="nobody") as caught:
            await within(5, turn.finished())
        assert (caught.value.code, caught.value.fatal, caught.value.turn) == ("unknown_voice", False, 1)
        assert (await turn.finished()).reason == "failed"
        assert (await (await talker.say("on.")).finished()).reason == "end"


async def test_a_voice_that_breaks() -> None:
    async with served(Failing("speech", 1)) as url, connect(url) as talker:
        turn = await talker.say("Hello.")
        with pytest.raises(ServerError) as caught:
            await within(5, turn.finished())
        assert caught.value.code == "synthesis_failed"
        assert (await (await talker.say("on.")).finished()).reason == "end"


async def test_the_server_goes_down() -> None:
    async with served() as url:
        talking = connect(url)
        talker = await talking.__aenter__()
        turn = await talker.say(LONG)
        listening = asyncio.create_task(turn.finished())
        await asyncio.sleep(0.05)
    with pytest.raises(ServerError, match="going down"):
        await within(5, listening)
    with pytest.raises(ServerError, match="going down"):
        await talker.say("more")
    with pytest.raises(ServerError):
        await within(5, turn.finished())
    await talking.__aexit__(None, None, None)


@asynccontextmanager
async def odd_server(*replies: bytes | str | None) -> AsyncIterator[str]:
    """Answers hello with these messages; None cuts the connection."""

    async def handle(socket: ServerConnection) -> None:
        await socket.recv()
        for reply in replies:
            if reply is None:
                socket.transport.abort()
                return
            await socket.send(reply)
        await socket.wait_closed()

    protocols = [Subprotocol(g.SUBPROTOCOL)]
    async with serve(handle, "127.0.0.1", 0, subprotocols=protocols, close_timeout=0.2) as server:
        yield address(server)


READY = encode(g.Ready(server="s", session="1", fps=25, faps=bytes(range(3, 69)), voices=(), heads=()))


async def open_and_speak(url: str) -> None:
    async with connect(url) as talker:
        await (await talker.say("Hello.")).finished()


@pytest.mark.parametrize("reply", [b"\xc1", "text", encode(g.Ping(id=1))])
async def test_a_server_that_breaks_the_contract(reply: bytes | str) -> None:
    for replies in ([reply], [READY, reply]):
        async with odd_server(*replies) as url:
            with pytest.raises(ProtocolError):
                await within(5, open_and_speak(url))


async def test_a_connection_that_is_cut() -> None:
    for replies in ([None], [READY, None]):
        async with odd_server(*replies) as url:
            with pytest.raises(ConnectionClosed):
                await within(5, open_and_speak(url))


async def test_a_refusal_at_the_door() -> None:
    refusal = encode(g.Error(code="internal", message="not today", fatal=True))
    async with odd_server(refusal) as url:
        with pytest.raises(ServerError, match="not today"):
            await within(5, open_and_speak(url))


async def test_no_server_there() -> None:
    async with served() as url:
        pass
    with pytest.raises(OSError):  # noqa: PT011
        await open_and_speak(url)


async def test_leaving_in_the_middle_of_a_turn(url: str) -> None:
    async with connect(url) as talker:
        assert isinstance(talker, Talker)
        await talker.say(LONG)
    async with connect(url) as talker:
        assert (await (await talker.say("on.")).finished()).reason == "end"


async def test_a_head_says_what_it_is_fed_with(url: str) -> None:
    pcm = voicing(0.8, 48000)
    async with connect(url) as head:
        turn = await head.hear(48000)
        for part in np.array_split(pcm, 3):
            await turn.feed(part)
        await turn.end()
        begin, packets, done = await within(10, all_of(turn))  # type: ignore[misc]
        assert begin.voice == ""
        assert begin.delay <= 0.3 * 48000
        assert np.array_equal(np.concatenate([p.pcm for p in packets]), pcm)
        assert sum(len(p.frames) for p in packets) == 20
        assert done.samples == len(pcm)
