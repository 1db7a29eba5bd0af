"""What a server on the internet has to survive, each against a real one: nobody else is harmed, every error
is typed, nothing is left behind.
"""

from __future__ import annotations

import asyncio
import os
import random
import signal
import sys
from collections.abc import AsyncIterator
from itertools import pairwise

import msgpack
import pytest
from websockets.asyncio.client import ClientConnection
from websockets.asyncio.client import connect as dial
from websockets.exceptions import ConnectionClosed
from websockets.typing import Subprotocol

from fapstream.client import Audience, ServerError, Talker, connect, listen
from fapstream.protocol import generated as g
from fapstream.protocol.codec import decode, encode
from fapstream.records import Packet
from tests.e2e.servers import Server, serving

TEXT = "The quick brown fox jumps over the lazy dog, while seven small birds watch it from a branch. " * 3
PROTOCOLS = [Subprotocol(g.SUBPROTOCOL)]


@pytest.fixture
async def server() -> AsyncIterator[Server]:
    async with serving("--channel", "news") as made:
        yield made


async def sound(talker: Talker, text: str = TEXT) -> bytes:
    """All of a turn, gapless, taken as fast as it is made."""
    turn = await talker.say(text, lang="en", voice="us1")
    out = b""
    async for event in turn:
        if isinstance(event, Packet):
            assert event.start * 2 == len(out)
            out += event.pcm.tobytes()
            await talker.acknowledge(turn, len(out) // 2)
    assert turn.done
    assert turn.done.reason == "end"
    return out


async def bystander(server: Server, stop: asyncio.Event) -> int:
    """Somebody else who speaks all the time; how many turns were whole."""
    turns = 0
    async with connect(server.url) as talker:
        while not stop.is_set():
            await sound(talker, "Nobody disturbs me.")
            turns += 1
    return turns


async def unharmed(server: Server) -> None:
    """The server works as on its first day."""
    async with connect(server.url) as talker:
        assert len(await sound(talker, "Still here.")) > 8000


async def test_mbrola_killed_at_any_time(server: Server) -> None:
    async with connect(server.url) as talker:
        whole = await sound(talker)
        stop = asyncio.Event()

        async def kill() -> int:
            killed = 0
            while not stop.is_set():
                for pid in server.programs("mbrola"):
                    os.kill(pid, signal.SIGKILL)
                    killed += 1
                await asyncio.sleep(0.3)
            return killed

        killing = asyncio.create_task(kill())
        again = [await sound(talker) for _ in range(3)]
        stop.set()
        assert await killing > 3
        assert all(one == whole for one in again), "nobody hears the seam"
    await unharmed(server)


async def test_mbrola_that_hangs(server: Server) -> None:
    async with connect(server.url) as talker:
        whole = await sound(talker)
        for pid in server.programs("mbrola"):
            os.kill(pid, signal.SIGSTOP)
        assert await asyncio.wait_for(sound(talker), 30) == whole
    await unharmed(server)


async def test_a_full_disk_for_the_log() -> None:
    async with serving("--log-file", "/dev/full", "--log-level", "debug") as server:
        async with connect(server.url) as talker:
            await sound(talker, "The disk is full.")
        assert await server.stop() == 0


async def test_a_listener_that_stops_reading(server: Server) -> None:
    async with dial(server.url, subprotocols=PROTOCOLS, compression=None, max_queue=1) as stuck:
        await stuck.send(encode(g.Listen(channel="news")))
        await stuck.recv()
        stuck.transport.pause_reading()
        async with listen(server.url, "news") as audience, connect(server.url, channel="news") as talker:
            spoken = asyncio.create_task(_real_time(talker, 16.0))
            arrivals = await _arrivals(audience)
            samples = await spoken
        assert sum(n for _, n in arrivals) == samples, "the other listener got everything"
        gaps = [b - a for (a, _), (b, _) in pairwise(arrivals[10:])]
        assert max(gaps) < 1.0
        stuck.transport.resume_reading()
        codes = [m.code async for m in _messages(stuck) if isinstance(m, g.Error)]
        assert codes[-1:] in ([], ["too_slow"])
        assert stuck.close_code in (1013, 1006)
    await unharmed(server)


async def _real_time(talker: Talker, seconds: float) -> int:
    """Speak at least so long, as a card would play it; samples in all."""
    turn = await talker.say(TEXT * 3, lang="en", voice="us1")
    loop = asyncio.get_running_loop()
    start = loop.time()
    async for event in turn:
        if isinstance(event, Packet):
            await talker.acknowledge(turn, max(0, event.start - 8000))
            if loop.time() - start > seconds:
                break
    done = await turn.interrupt()
    return done.samples


async def _arrivals(audience: Audience) -> list[tuple[float, int]]:
    out = []
    async for event in audience:
        if isinstance(event, Packet):
            out.append((asyncio.get_running_loop().time(), len(event.pcm)))
        elif isinstance(event, g.Done):
            return out
    return out


async def _messages(socket: ClientConnection) -> AsyncIterator[g.Message]:
    try:
        async with asyncio.timeout(30):
            while True:
                data = await socket.recv()
                assert isinstance(data, bytes)
                if message := decode(data, "server"):
                    yield message
    except (ConnectionClosed, TimeoutError):
        return


async def test_a_connection_cut_in_the_middle_of_a_message(server: Server) -> None:
    host, _, port = server.address.rpartition(":")
    stop = asyncio.Event()
    other = asyncio.create_task(bystander(server, stop))
    for cut in (1, 2, 5, 20):
        reader, writer = await asyncio.open_connection(host, int(port))
        writer.write(
            f"GET /ws HTTP/1.1\r\nHost: {server.address}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n"
            f"Sec-WebSocket-Protocol: {g.SUBPROTOCOL}\r\n\r\n".encode()
        )
        await reader.readuntil(b"\r\n\r\n")
        hello, speak = encode(g.Hello()), encode(g.Speak(turn=1, text=TEXT.encode()))
        writer.write(b"\x82" + bytes((128 | len(hello),)) + bytes(4) + hello)
        frame = b"\x82" + b"\xfe" + len(speak).to_bytes(2, "big") + bytes(4) + speak
        writer.write(frame[:cut])
        await writer.drain()
        writer.transport.abort()
    stop.set()
    assert await other > 0
    await unharmed(server)


async def test_ten_thousand_malformed_frames(server: Server) -> None:
    chance = random.Random(6)
    stop = asyncio.Event()
    other = asyncio.create_task(bystander(server, stop))
    files = server.open_files()
    sent = 0
    while sent < 10_000:
        async with dial(server.url, subprotocols=PROTOCOLS, compression=None) as socket:
            await socket.send(encode(g.Hello()))
            drain = asyncio.create_task(_drain(socket))
            try:
                for _ in range(500):
                    await socket.send(_malformed(chance))
                    sent += 1
            except ConnectionClosed:
                pass
            errors = await drain
            assert errors <= {"protocol", "bad_message", "unknown_turn", "text_too_long", "too_many_turns",
                              "unknown_voice", "unknown_language", "voice_unavailable"}  # fmt: skip
    stop.set()
    assert await other > 0
    await unharmed(server)
    await asyncio.sleep(1)
    assert server.open_files() <= files + 4


async def _drain(socket: ClientConnection) -> set[str]:
    """Codes of the errors that come, until the connection ends or falls silent."""
    codes = set()
    try:
        while True:
            data = await asyncio.wait_for(socket.recv(), 1.5)
            assert isinstance(data, bytes)
            message = decode(data, "server")
            if isinstance(message, g.Error):
                codes.add(message.code)
    except (ConnectionClosed, TimeoutError):
        return codes


def _malformed(chance: random.Random) -> bytes:
    """A frame that is broken in one of several ways; most do not end the session."""
    kind = chance.randrange(20)
    if kind == 0:
        return chance.randbytes(chance.randrange(40))
    if kind == 1:
        return encode(g.Speak(turn=1, text=b"x"))[: chance.randrange(1, 20)]
    names = ["speak", "end", "interrupt", "splice", "seek", "pause", "continue", "ack", "ping", "dance"]
    fields: dict[str, object] = {"type": chance.choice(names)}
    for name in ("turn", "text", "char", "back", "heard", "sample", "queue", "id", "voice"):
        if chance.random() < 0.4:
            fields[name] = chance.choice([-1, 0, 1, 2, 2**31, 2**53, None, 1.5, "x", b"\xff", [1], {}])
    data: bytes = msgpack.packb(fields)
    return data


async def test_the_server_is_told_to_stop_under_load() -> None:
    async with serving("--workers", "2", "--drain", "6") as server:
        tasks = [asyncio.create_task(_short_turn(server)) for _ in range(20)]
        await asyncio.sleep(1.5)
        pids = [*server.programs("mbrola"), server.process.pid]
        stopping = asyncio.create_task(server.stop())
        results = await asyncio.gather(*tasks)
        assert all(result == "end" for result in results), "those who spoke could end"
        assert await stopping == 0
        await asyncio.sleep(0.2)
        assert not [pid for pid in pids if os.path.exists(f"/proc/{pid}")]
        with pytest.raises(OSError):  # noqa: PT011
            async with connect(server.url):
                pass


async def _short_turn(server: Server) -> str:
    async with connect(server.url) as talker:
        turn = await talker.say("One two three four five six seven eight nine ten eleven twelve.")
        return (await turn.finished()).reason


async def test_while_it_drains_newcomers_are_told_to_come_later() -> None:
    async with serving("--drain", "8") as server, connect(server.url) as talker:
        turn = await talker.say(TEXT)
        late = await dial(server.url, subprotocols=PROTOCOLS, compression=None)
        stopping = asyncio.create_task(server.stop())
        await asyncio.sleep(0.5)
        await late.send(encode(g.Hello()))
        errors = [m async for m in _messages(late) if isinstance(m, g.Error)]
        assert [(e.code, e.fatal) for e in errors] == [("busy", True)]
        assert (errors[0].retry_ms or 0) > 0
        await turn.interrupt()
        assert await stopping == 0


async def test_no_room_is_a_typed_refusal_and_nobody_else_is_touched() -> None:
    async with serving("--max-sessions", "2") as server, connect(server.url) as a, connect(server.url):
        spoken = asyncio.create_task(sound(a))
        with pytest.raises(ServerError) as caught:
            async with connect(server.url):
                pass
        assert (caught.value.code, caught.value.fatal) == ("busy", True)
        assert (caught.value.retry_ms or 0) > 0
        assert len(await spoken) > 100_000


async def test_slow_handshakes_are_cut_off(server: Server) -> None:
    """Slow loris: connections that say nothing, or a byte now and then, are closed; others are served."""
    host, _, port = server.address.rpartition(":")
    pairs = [await asyncio.open_connection(host, int(port)) for _ in range(50)]
    for _, writer in pairs[:25]:
        writer.write(b"GET /ws HTTP/1.1\r\nHost: ")
    await unharmed(server)
    for reader, writer in pairs:
        assert await asyncio.wait_for(reader.read(), 10) == b""
        writer.close()


async def test_the_clock_of_the_machine_steps() -> None:
    """Only tokens look at the time of day: a server whose clock jumps by hours goes on as if nothing was."""
    faketime = "import time; real = time.time; time.time = lambda: real() + 7200 * (int(real()) % 2)\n"
    code = faketime + "import sys; from fapstream.cli import main; sys.exit(main(sys.argv[1:]))"
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-c", code, "serve", "--port", "0", stdout=asyncio.subprocess.PIPE
    )
    assert process.stdout
    address = (await process.stdout.readline()).decode().split("://")[1].strip().rstrip("/")
    try:
        server = Server(process, address)
        async with connect(server.url) as talker:
            first = await sound(talker)
            assert await sound(talker) == first
    finally:
        process.terminate()
        await process.wait()
