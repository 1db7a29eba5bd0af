"""One client against the server's half: what it may do wrong, and what it is always answered.

No socket and no waiting: two queues, a voice made of arithmetic, and a loop whose time costs nothing.
"""

from __future__ import annotations

import asyncio
from typing import Any

import msgpack
import numpy as np
import pytest

from fapstream.protocol import generated as g
from fapstream.server import link as module
from fapstream.tts import Manner, read_lexicon
from tests.unit.fakes import Failing, FakeVoices, in_virtual_time
from tests.unit.server.peer import Peer, peer

TEXT = "Hello world, it is late. He said: go home! "


def say(turn: int, text: str = TEXT, **options: Any) -> tuple[g.Speak, g.End]:
    return g.Speak(turn=turn, text=text.encode(), **options), g.End(turn=turn)


def words(packets: list[g.Packet]) -> list[str]:
    return [m.text for p in packets for m in p.marks or () if m.kind == "word"]


# a good conversation


@in_virtual_time
async def test_ready_tells_what_there_is() -> None:
    made = Peer(FakeVoices())
    made.send(g.Hello(fps=50))
    ready = await made.next()
    assert isinstance(ready, g.Ready)
    assert ready.fps == 50
    assert ready.faps == bytes(range(3, 69))
    assert ready.heads == ("generic",)
    assert {v.name for v in ready.voices} == {v.name for v in made.voices.all()}
    made.send(g.Bye())
    await made.running
    assert made.socket.closed == (1000, "")


@in_virtual_time
async def test_a_turn() -> None:
    async with peer() as p:
        p.send(*say(1, lang="el"))
        begin = await p.next()
        assert begin == g.Begin(turn=1, voice="gr2", lang="el", sample_rate=22050, fps=25)
        packets, done = await p.rest_of_turn(1)
        at = 0
        for packet in packets:
            assert packet.sample == at
            at += len(packet.pcm)
        assert done == g.Done(turn=1, reason="end", samples=at)
        assert all(packet.key for packet in packets[::25]), "a key a second"
        assert all(len(packet.mask) == 9 for packet in packets[:-1]), "a frame in each"


@in_virtual_time
async def test_turns_are_spoken_one_after_the_other() -> None:
    async with peer() as p:
        p.send(*say(1, "one."), *say(5, "two."), *say(6, "three."))
        order: list[tuple[str, int]] = []
        while len(order) < 6:
            message = await p.next()
            if isinstance(message, g.Begin | g.Done):
                order.append((message.type, message.turn))
        assert order == [(kind, turn) for turn in (1, 5, 6) for kind in ("begin", "done")]


@in_virtual_time
async def test_text_may_be_cut_inside_a_character() -> None:
    async with peer() as p:
        data = "Γεια σου, κόσμε. ".encode()
        p.send(*(g.Speak(turn=1, text=data[i : i + 1], lang="el") for i in range(len(data))), g.End(turn=1))
        packets, _ = await p.rest_of_turn(1)
        assert words(packets) == ["Γεια", "σου", "κόσμε"]


@in_virtual_time
async def test_packets_do_not_run_ahead_of_the_listener() -> None:
    loop = asyncio.get_running_loop()
    async with peer() as p:
        p.send(*say(1, TEXT * 5))
        begin = await p.until(g.Begin)
        start = loop.time()
        while not isinstance(packet := await p.next(), g.Done):
            ahead = packet.sample / begin.sample_rate - (loop.time() - start)
            assert ahead <= 1.5 + 0.001


@in_virtual_time
async def test_an_acknowledgement_that_lags_holds_back() -> None:
    loop = asyncio.get_running_loop()
    async with peer() as p:
        p.send(*say(1, TEXT * 5))
        for _ in range(20):
            await p.until(g.Packet)
        p.send(g.Ack(turn=1, sample=0, queue=20 * 640, underruns=0, skew=0))
        await asyncio.sleep(0)
        before = loop.time()
        while (await p.until(g.Packet)).sample < 3 * 16000:
            pass
        assert loop.time() - before >= 3 - 1.5 - 0.1


@in_virtual_time
async def test_defaults_of_hello_and_wishes_of_the_turn() -> None:
    async with peer(lang="el") as p:
        p.send(*say(1, "a."), *say(2, "a.", voice="en1"), *say(3, "a.", lang="en"))
        assert [(await p.until(g.Begin, t)).voice for t in (1, 2, 3)] == ["gr2", "en1", "us1"]
    async with peer(voice="gr1") as p:
        p.send(*say(1, "a."), *say(2, "a.", lang="en"))
        assert [(await p.until(g.Begin, t)).voice for t in (1, 2)] == ["gr1", "us1"]


@in_virtual_time
async def test_rate() -> None:
    lengths = []
    for rate in (100, 200):
        async with peer() as p:
            p.send(*say(1, rate=rate))
            lengths.append((await p.until(g.Done)).samples)
    assert lengths[1] < 0.75 * lengths[0]


@in_virtual_time
async def test_pitch_volume_and_look_ahead() -> None:
    async with peer() as p:
        p.send(*say(1), *say(2, pitch=200, volume=50), *say(3, volume=0))
        for turn in (1, 2, 3):
            await p.until(g.Done, turn)
    plain, high, silent = (v.written[0].phones[2] for v in p.voices.acquired)
    assert high.pitch[0][1] > 1.7 * plain.pitch[0][1]
    assert (plain.gain, high.gain, silent.gain) == (1.0, 0.5, 0.0)


@in_virtual_time
async def test_look_ahead_is_the_turns_or_the_servers() -> None:
    text = "one two three four "
    for wish, server, words in ((None, 0, 4), (2, 0, 2), (None, 3, 1), (g.LONGEST_LOOK_AHEAD, 0, 0)):
        async with peer(manner=Manner(look_ahead=server)) as p:
            p.send(g.Speak(turn=1, text=text.encode(), look_ahead=wish))
            await asyncio.sleep(0.01)
            written = [w.text for v in p.voices.acquired for u in v.written for w in u.words]
            assert written == text.split()[:words]


@in_virtual_time
async def test_the_servers_lexicon_is_for_its_language() -> None:
    lexicon = read_lexicon("Hello\tt E1 s t", "f", "en")
    async with peer(manner=Manner(lexicon=lexicon)) as p:
        p.send(*say(1, "Hello."), *say(2, "Hello.", lang="el"))
        for turn in (1, 2):
            await p.until(g.Done, turn)
    english, greek = ([ph.name for ph in v.written[0].phones] for v in p.voices.acquired)
    assert english[1:-1] == ["t", "E", "s", "t"]
    assert greek[1] == "x"


@in_virtual_time
async def test_ping() -> None:
    async with peer() as p:
        p.send(g.Ping(id=7), g.Ping(id=4294967295))
        assert (await p.until(g.Pong)).id == 7
        assert (await p.until(g.Pong)).id == 4294967295


# what cannot be done


@in_virtual_time
async def test_no_hello_in_time() -> None:
    made = Peer(FakeVoices())
    error = await made.next()
    assert asyncio.get_running_loop().time() == pytest.approx(g.HELLO_DEADLINE_MS / 1000)
    assert (error.code, error.fatal) == ("timeout", True)
    await made.running
    assert made.socket.closed


@pytest.mark.parametrize(
    ("options", "code"),
    [({"voice": "nobody"}, "unknown_voice"), ({"lang": "xx"}, "unknown_language")],
)
@in_virtual_time
async def test_a_refused_turn_is_told_and_done(options: dict[str, str], code: str) -> None:
    async with peer() as p:
        p.send(*say(1, **options), *say(2))
        error = await p.next()
        assert (error.code, error.turn, error.fatal) == (code, 1, False)
        assert await p.next() == g.Done(turn=1, reason="failed", samples=0)
        assert (await p.until(g.Done)).turn == 2


@in_virtual_time
async def test_too_many_turns() -> None:
    async with peer() as p:
        for turn in range(1, g.MAX_PENDING_TURNS + 2):
            p.send(g.Speak(turn=turn, text=b"hi."))
        error = await p.until(g.Error)
        assert (error.code, error.turn) == ("too_many_turns", g.MAX_PENDING_TURNS + 1)
        done = await p.until(g.Done)
        assert (done.turn, done.reason) == (g.MAX_PENDING_TURNS + 1, "failed")
        for turn in range(1, g.MAX_PENDING_TURNS + 1):
            p.send(g.End(turn=turn))
            assert (await p.until(g.Done)).reason == "end"


@pytest.mark.parametrize("waiting", [False, True])
@in_virtual_time
async def test_too_much_text_is_refused_and_nothing_accepted_is_lost(waiting: bool) -> None:
    """Also in a turn that still waits for its own to come."""
    async with peer() as p:
        turn = 1
        if waiting:
            p.send(g.Speak(turn=1, text=b"first. "))
            turn = 2
        big = g.Speak(turn=turn, text=b"la. " + b" " * (g.MAX_FRAGMENT_BYTES - 4))
        p.send(*[big] * 8)
        error = await p.until(g.Error)
        assert (error.code, error.turn, error.fatal) == ("text_too_long", turn, False)
        await asyncio.sleep(1)
        while not p.quiet():
            await p.next()
        p.send(g.Interrupt(turn=turn))
        assert (await p.until(g.Done, turn)).reason == "interrupted"


@in_virtual_time
async def test_too_much_text_by_a_truncated_last_character() -> None:
    """A queue filled to the brim, and then an end that leaves one more character behind."""
    async with peer() as p:
        p.send(g.Speak(turn=1, text=b"first. "))
        await p.until(g.Packet)
        p.send(*[g.Speak(turn=2, text=b" " * g.MAX_FRAGMENT_BYTES)] * 3)
        p.send(g.Speak(turn=2, text=b" " * (g.MAX_FRAGMENT_BYTES - 1)), g.Speak(turn=2, text=b" \xce"))
        p.send(g.End(turn=2), g.End(turn=1), *say(3, "on."))
        error = await p.until(g.Error)
        assert (error.code, error.turn, error.fatal) == ("text_too_long", 2, False)
        assert (await p.until(g.Done, 2)).reason == "end"
        assert (await p.until(g.Done, 3)).reason == "end"


@pytest.mark.parametrize(
    "data",
    [
        *(b"", b"\xc1", b"\xff" * 50, b"\x81", b"\x90", b"\x81" * 2000, "text"),
        *(msgpack.packb(m) for m in ({"type": 5}, {"a": 1}, {"type": "hello"}, {"type": "ready"})),
    ],
)
@in_virtual_time
async def test_a_broken_contract_closes_this_session_only(data: bytes | str) -> None:
    async with peer() as other:
        other.send(g.Speak(turn=1, text=TEXT.encode()))
        await other.until(g.Packet)
        async with peer() as p:
            p.raw(data)
            error = await p.next()
            assert (error.code, error.fatal) == ("protocol", True)
            await asyncio.wait_for(p.running, 5)
            assert p.socket.closed
            assert p.socket.closed[0] == 1002
        other.send(g.End(turn=1))
        assert (await other.until(g.Done)).reason == "end"


@pytest.mark.parametrize(
    ("message", "code"),
    [
        ({"type": "speak", "turn": 0, "text": b""}, "bad_message"),
        ({"type": "speak", "turn": 1}, "bad_message"),
        ({"type": "speak", "turn": 1, "text": b"", "rate": 401}, "bad_message"),
        ({"type": "ping", "id": -1}, "bad_message"),
        ({"type": "end", "turn": 9}, "unknown_turn"),
        ({"type": "interrupt", "turn": 9}, "unknown_turn"),
    ],
)
@in_virtual_time
async def test_a_bad_message_is_answered_and_the_session_goes_on(message: dict[str, Any], code: str) -> None:
    async with peer() as p:
        p.raw(msgpack.packb(message))
        error = await p.next()
        assert (error.code, error.fatal) == (code, False)
        p.send(*say(1, "on."))
        assert (await p.until(g.Done)).reason == "end"


@in_virtual_time
async def test_messages_of_a_later_version_are_skipped() -> None:
    async with peer() as p:
        p.raw(msgpack.packb({"type": "dance", "turn": 1}))
        p.send(g.Ping(id=1))
        assert (await p.until(g.Pong)).id == 1


# interrupts


@in_virtual_time
async def test_interrupting_the_running_turn() -> None:
    async with peer() as p:
        p.send(g.Speak(turn=1, text=(TEXT * 4).encode()), *say(2, "next."))
        marks, seen = [], 0
        while seen < 30:
            packet = await p.until(g.Packet)
            marks += [m for m in packet.marks or () if m.kind == "word"]
            seen += 1
        heard = marks[2].sample + 10
        p.send(g.Interrupt(turn=1, heard=heard))
        _, done = await p.rest_of_turn(1)
        assert (done.reason, done.heard, done.char) == ("interrupted", heard, marks[2].char_end)
        assert done.samples >= 30 * 640
        assert (await p.until(g.Done)).turn == 2


@in_virtual_time
async def test_nobody_can_have_heard_more_than_was_sent() -> None:
    async with peer() as p:
        p.send(*say(1, TEXT * 4))
        await p.until(g.Packet)
        p.send(g.Interrupt(turn=1, heard=10**9))
        done = await p.until(g.Done)
        assert done.heard == done.samples > 0


@in_virtual_time
async def test_an_interrupt_that_says_nothing_is_answered_from_the_clock_and_the_acknowledgements() -> None:
    async with peer() as p:
        p.send(*say(1, TEXT * 4))
        await p.until(g.Packet)
        await asyncio.sleep(1.0)
        p.send(g.Interrupt(turn=1))
        done = await p.until(g.Done)
        assert done.heard == pytest.approx(16000, abs=700)
    async with peer() as p:
        p.send(*say(1, TEXT * 4))
        await p.until(g.Packet)
        await asyncio.sleep(1.0)
        p.send(g.Ack(turn=1, sample=4000, queue=1, underruns=0, skew=0), g.Interrupt(turn=1))
        done = await p.until(g.Done)
        assert done.heard == pytest.approx(4000, abs=2)


@in_virtual_time
async def test_interrupting_a_turn_that_waits_and_one_that_is_over() -> None:
    async with peer() as p:
        p.send(g.Speak(turn=1, text=b"one."), *say(2), *say(3, "three."))
        p.send(g.Interrupt(turn=2))
        assert await p.until(g.Done) == g.Done(turn=2, reason="interrupted", samples=0, heard=0, char=0)
        p.send(g.End(turn=1))
        assert (await p.until(g.Done)).turn == 1
        p.send(g.Interrupt(turn=1), g.Interrupt(turn=2))
        assert (await p.until(g.Done)).turn == 3
        p.send(g.Ping(id=1))
        assert (await p.until(g.Pong)).id == 1


@in_virtual_time
async def test_interrupting_twice_answers_once_and_gives_the_voice_back() -> None:
    async with peer() as p:
        p.send(*say(1, TEXT * 4))
        await p.until(g.Packet)
        p.send(g.Interrupt(turn=1, heard=5), g.Interrupt(turn=1, heard=900))
        done = await p.until(g.Done)
        assert (done.reason, done.heard) == ("interrupted", 5)
        p.send(g.Ping(id=1))
        assert isinstance(await p.next(), g.Pong)


@in_virtual_time
async def test_interrupting_and_leaving_gives_the_voice_back() -> None:
    async with peer() as p:
        p.send(*say(1, TEXT * 4))
        await p.until(g.Packet)
        p.send(g.Interrupt(turn=1))
        p.socket.to_server.put_nowait(None)
        await p.running


# a voice that breaks, a client that leaves or does not read


@pytest.mark.parametrize("where", ["write", "speech"])
@in_virtual_time
async def test_a_voice_that_breaks_fails_its_turn_and_the_next_one_works(where: str) -> None:
    async with peer(Failing(where, 2)) as p:
        p.send(*say(1, TEXT * 3), *say(2))
        error = await p.until(g.Error)
        assert (error.code, error.turn, error.fatal) == ("synthesis_failed", 1, False)
        done = await p.next()
        assert (done.turn, done.reason) == (1, "failed")
        assert (await p.until(g.Done)).reason == "end"


@in_virtual_time
async def test_a_mistake_of_ours_is_told_and_closes_only_this_session() -> None:
    def fail(where: str) -> None:
        if where == "speech":
            raise ZeroDivisionError

    async with peer() as other, peer(fail) as p:
        p.send(*say(1))
        error = await p.until(g.Error)
        assert (error.code, error.fatal) == ("internal", True)
        await asyncio.wait_for(p.running, 5)
        assert p.socket.closed
        assert p.socket.closed[0] == 1011
        other.send(g.Ping(id=1))
        assert (await other.until(g.Pong)).id == 1


@in_virtual_time
async def test_a_client_that_leaves_gives_everything_back() -> None:
    async with peer() as p:
        p.send(*say(1, TEXT * 9), *say(2))
        await p.until(g.Packet)
        p.socket.to_server.put_nowait(None)
        await asyncio.wait_for(p.running, 5)


@pytest.mark.parametrize("ping", [False, True])
@in_virtual_time
async def test_a_client_that_never_reads_is_dropped(monkeypatch: pytest.MonkeyPatch, ping: bool) -> None:
    """Whether it is sent packets or answers."""
    monkeypatch.setattr(module, "SEND_DEADLINE_S", 0.5)
    async with peer() as p:
        p.socket.stuck()
        p.send(g.Ping(id=1) if ping else g.Speak(turn=1, text=TEXT.encode()))
        start = asyncio.get_running_loop().time()
        await asyncio.wait_for(p.running, 10)
        assert asyncio.get_running_loop().time() - start <= 1.5
        assert p.socket.closed


@in_virtual_time
async def test_the_server_goes_down_in_the_middle_of_a_turn() -> None:
    async with peer() as p:
        p.send(*say(1, TEXT * 9))
        await p.until(g.Packet)
        await p.world.lobby.goodbye("maintenance")
        await asyncio.wait_for(p.running, 5)
        left = []
        while not p.quiet():
            left.append(await p.next())
        assert left[-1] == g.Bye(reason="maintenance")
        assert p.socket.closed == (1001, "maintenance")


# bad text


@pytest.mark.parametrize(
    "data",
    [b"", b" \n\t ", b"\x00\x01\x07\x1b[2J\x7f", "🙂🙃 👩‍👩‍👧".encode(), b"\xed\xa0\x80 \xff\xfe",
     "漢字 Привет".encode(), b"...!?", b"\\:)", b"\\:)99999999999999999999"],
)  # fmt: skip
@in_virtual_time
async def test_any_bytes_end_well(data: bytes) -> None:
    async with peer() as p:
        p.send(g.Speak(turn=1, text=data), g.End(turn=1), *say(2, "still here."))
        first, done = await p.rest_of_turn(1)
        assert done.reason == "end"
        assert done.samples == sum(len(packet.pcm) for packet in first)
        packets, done = await p.rest_of_turn(2)
        assert words(packets) == ["still", "here"]


@in_virtual_time
async def test_text_around_the_garbage_is_spoken() -> None:
    async with peer() as p:
        p.send(g.Speak(turn=1, text=b"one \xff\xfe two \xed\xa0\x80 three \xf0\x9f\x98"), g.End(turn=1))
        packets, _ = await p.rest_of_turn(1)
        assert [w for w in words(packets) if w.isascii()] == ["one", "two", "three"]


@in_virtual_time
async def test_a_megabyte_of_text_waits_for_nobody() -> None:
    """Accepted up to the limit, refused beyond, and the session answers all the while."""
    async with peer() as p:
        p.send(*[g.Speak(turn=1, text=b"a" * g.MAX_FRAGMENT_BYTES)] * 16, g.Ping(id=3))
        errors = []
        while not isinstance(message := await p.next(), g.Pong):
            if isinstance(message, g.Error):
                errors.append(message.code)
        assert set(errors) == {"text_too_long"}
        assert len(errors) >= 10
        p.send(g.Interrupt(turn=1))
        assert (await p.until(g.Done)).reason == "interrupted"


@in_virtual_time
async def test_sound_is_what_the_voice_made() -> None:
    async with peer() as p:
        p.send(*say(1))
        packets, done = await p.rest_of_turn(1)
        pcm = np.concatenate([packet.pcm for packet in packets])
        assert np.array_equal(pcm, np.arange(done.samples) % 32768)
