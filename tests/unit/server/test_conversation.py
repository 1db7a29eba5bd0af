"""protocol/SPEC.md 4.2 and 4.3: pauses, and sessions that outlive their connection."""

from __future__ import annotations

import asyncio

import numpy as np
import pytest

from fapstream.ears import MAX_PENDING_S
from fapstream.protocol import generated as g
from fapstream.protocol.codec import decode
from tests.unit.fakes import FakeVoices, in_virtual_time
from tests.unit.server.peer import Peer, peer
from tests.unit.server.test_connection import TEXT, say
from tests.unit.voicing import voicing

LONG = TEXT * 12


async def greeted(p: Peer, hello: g.Hello) -> g.Ready:
    p.send(hello)
    ready = await p.next()
    assert isinstance(ready, g.Ready)
    return ready


def received(p: Peer) -> list[g.ServerMessage]:
    """Everything that has come and was not looked at."""
    out = []
    while not p.quiet():
        message = decode(p.socket.to_client.get_nowait(), "server")
        assert message is not None
        out.append(message)
    return out  # type: ignore[return-value]


def sound(messages: list[g.ServerMessage]) -> list[tuple[int, int]]:
    return [(m.sample, len(m.pcm)) for m in messages if isinstance(m, g.Packet) and m.pcm is not None]


def hear(turn: int, pcm: np.ndarray, rate: int | None = None) -> g.Hear:
    return g.Hear(turn=turn, pcm=pcm, sample_rate=rate)


@in_virtual_time
async def test_a_turn_of_sound_comes_back_with_a_face() -> None:
    p = Peer(FakeVoices())
    await greeted(p, g.Hello(lang="en"))
    pcm = voicing(1.2, 24000)
    p.send(hear(1, pcm[:0], 24000), *(hear(1, part) for part in np.array_split(pcm, 7)), g.End(turn=1))
    begin = await p.until(g.Begin)
    assert (begin.voice, begin.lang, begin.sample_rate, begin.fps) == ("", "en", 24000, 25)
    assert 0 < (begin.delay or 0) <= 0.3 * 24000
    packets, done = await p.rest_of_turn(1)
    assert np.array_equal(np.concatenate([m.pcm for m in packets]), pcm)
    assert any(m.faps is not None for m in packets)
    assert done == g.Done(turn=1, reason="end", samples=len(pcm))
    assert p.voices.acquired == []
    await p.gone()


@in_virtual_time
async def test_turns_of_sound_and_text_wait_for_each_other() -> None:
    p = Peer(FakeVoices())
    await greeted(p, g.Hello())
    p.send(
        hear(1, voicing(0.5), 16000),
        *say(2, "one two. "),
        g.End(turn=1),
        hear(3, voicing(0.3), 16000),
        g.End(turn=3),
    )
    begun = []
    for turn in (1, 2, 3):
        begun.append((await p.until(g.Begin)).turn)
        await p.rest_of_turn(turn)
    assert begun == [1, 2, 3]
    await p.gone()


@in_virtual_time
async def test_an_interrupted_turn_of_sound_says_what_was_heard() -> None:
    p = Peer(FakeVoices())
    await greeted(p, g.Hello())
    p.send(hear(1, voicing(0.4), 16000), hear(1, voicing(0.4)))
    await p.until(g.Packet)
    p.send(g.Interrupt(turn=1, heard=320))
    done = await p.until(g.Done)
    assert (done.reason, done.heard, done.char) == ("interrupted", 320, 0)
    await p.gone()


@in_virtual_time
async def test_sound_beyond_the_limit_is_refused_and_the_rest_is_heard() -> None:
    p = Peer(FakeVoices())
    await greeted(p, g.Hello())
    part = np.ones(8192, np.int16)
    n = int(MAX_PENDING_S * 8000 / 8192) + 40
    p.send(hear(1, part, 8000), *(hear(1, part) for _ in range(n)))
    error = await p.until(g.Error)
    assert (error.code, error.fatal, error.turn) == ("sound_too_long", False, 1)
    p.send(g.Interrupt(turn=1))
    assert (await p.until(g.Done)).reason == "interrupted"
    await p.gone()


@in_virtual_time
async def test_too_many_turns_of_sound_are_refused_one_by_one() -> None:
    p = Peer(FakeVoices())
    await greeted(p, g.Hello())
    nothing = np.zeros(0, np.int16)
    p.send(*(hear(turn, nothing, 16000) for turn in range(1, g.MAX_PENDING_TURNS + 2)))
    error = await p.until(g.Error)
    assert (error.code, error.turn) == ("too_many_turns", g.MAX_PENDING_TURNS + 1)
    await p.gone()


@pytest.mark.parametrize("taken", [0, 1, 5, 20])
@in_virtual_time
async def test_a_session_goes_on_over_another_connection(taken: int) -> None:
    """The client has `taken` messages then; nothing is missing and nothing comes twice."""
    first = Peer(FakeVoices())
    ready = await greeted(first, g.Hello())
    first.send(*say(1, LONG))
    had = [await first.next() for _ in range(taken)]
    await asyncio.sleep(2.0)
    first.socket.cut()
    await first.running
    await asyncio.sleep(5.0)
    again = Peer(first.voices, world=first.world)
    welcome = await greeted(again, g.Hello(resume=ready.resume, received=taken))
    assert welcome.resumed
    assert welcome.session == ready.session
    assert welcome.received == 2, "speak and end"
    assert welcome.resume == ready.resume
    packets, done = await again.rest_of_turn(1)
    heard = [m for m in had if isinstance(m, g.Packet)] + packets
    ends = np.cumsum([len(p.pcm) for p in heard if p.pcm is not None])
    assert [p.sample for p in heard] == [0, *ends[:-1]]
    assert done == g.Done(turn=1, reason="end", samples=int(ends[-1]))
    await again.gone()
    assert first.world.gate.inside == 0


@in_virtual_time
async def test_what_the_client_sends_again_is_not_taken_twice() -> None:
    first = Peer(FakeVoices())
    ready = await greeted(first, g.Hello())
    first.send(g.Speak(turn=1, text=b"one two "))
    await first.until(g.Begin)
    first.socket.cut()
    await first.running
    again = Peer(first.voices, world=first.world)
    welcome = await greeted(again, g.Hello(resume=ready.resume, received=1))
    assert welcome.received == 1, "the client knows that `speak` has come and sends only what follows"
    again.send(g.Speak(turn=1, text=b"three. "), g.End(turn=1))
    packets, _ = await again.rest_of_turn(1)
    words = [m.text for p in packets for m in p.marks or () if m.kind == "word"]
    assert words == ["one", "two", "three"]
    await again.gone()


@in_virtual_time
async def test_while_nobody_is_there_no_more_is_made_than_the_ring_holds() -> None:
    p = Peer(FakeVoices())
    ready = await greeted(p, g.Hello())
    p.send(*say(1, LONG * 10))
    await p.until(g.Packet)
    p.socket.cut()
    await p.running
    await asyncio.sleep(g.LINGER_MS / 1000 - 5)
    again = Peer(p.voices, world=p.world)
    await greeted(again, g.Hello(resume=ready.resume, received=2))
    at_once = sound(received(again))
    assert sum(n for _, n in at_once) == pytest.approx(16 * g.RING_MS, abs=2 * 640)
    assert at_once[0][0] == 640
    await again.gone()


@in_virtual_time
async def test_an_old_connection_that_is_not_missed_yet_gives_way() -> None:
    first = Peer(FakeVoices())
    ready = await greeted(first, g.Hello())
    first.send(*say(1, LONG))
    await first.until(g.Begin)
    again = Peer(first.voices, world=first.world)
    welcome = await greeted(again, g.Hello(resume=ready.resume, received=1))
    assert welcome.resumed
    await asyncio.wait_for(first.running, 5)
    assert first.socket.closed == (1000, "resumed over another connection")
    packets, _ = await again.rest_of_turn(1)
    assert packets[0].sample == 0
    await again.gone()


@pytest.mark.parametrize("key", ["0.nobody", "", "7.elsewhere", "x" * 128])
@in_virtual_time
async def test_a_key_that_nobody_knows_begins_a_new_session(key: str) -> None:
    p = Peer(FakeVoices())
    ready = await greeted(p, g.Hello(resume=key, received=3))
    assert not ready.resumed
    p.send(*say(1))
    assert (await p.until(g.Done)).reason == "end"
    await p.gone()


@pytest.mark.parametrize("wrong", [99, 2**53 - 1])
@in_virtual_time
async def test_a_count_that_cannot_be_begins_a_new_session_and_leaves_the_old_one(wrong: int) -> None:
    first = Peer(FakeVoices())
    ready = await greeted(first, g.Hello())
    other = Peer(first.voices, world=first.world)
    assert not (await greeted(other, g.Hello(resume=ready.resume, received=wrong))).resumed
    first.send(g.Ping(id=1))
    assert (await first.next()).id == 1
    await other.gone()
    await first.gone()


@in_virtual_time
async def test_who_says_goodbye_cannot_come_back() -> None:
    p = Peer(FakeVoices())
    ready = await greeted(p, g.Hello())
    p.send(g.Bye())
    await p.running
    await asyncio.sleep(0.1)
    assert p.world.gate.inside == 0
    again = Peer(p.voices, world=p.world)
    assert not (await greeted(again, g.Hello(resume=ready.resume, received=0))).resumed
    await again.gone()


@in_virtual_time
async def test_after_half_a_minute_a_lost_session_is_given_up() -> None:
    p = Peer(FakeVoices())
    await greeted(p, g.Hello())
    p.send(*say(1, LONG * 10))
    await p.until(g.Packet)
    p.socket.cut()
    await p.running
    await asyncio.sleep(g.LINGER_MS / 1000 - 1)
    assert p.world.gate.inside == 1
    await asyncio.sleep(2)
    assert p.world.gate.inside == 0
    assert all(v.closes == 1 for v in p.voices.acquired)


@in_virtual_time
async def test_what_the_client_has_is_kept_no_longer() -> None:
    async with peer() as p:
        p.send(*say(1, LONG))
        for _ in range(30):
            await p.next()
        [guest] = p.world.lobby._guests.values()
        sent = guest.conversation.session.sent
        p.send(g.Ack(turn=1, sample=0, queue=0, underruns=0, skew=0, received=30))
        await asyncio.sleep(0)
        assert sent.after(30) is not None
        assert sent.after(29) is None
        await p.rest_of_turn(1)


@in_virtual_time
async def test_a_client_that_never_acknowledges_costs_ten_seconds_of_sound() -> None:
    async with peer() as p:
        p.send(*say(1, LONG * 4))
        [guest] = p.world.lobby._guests.values()
        for _ in range(600):
            await p.next()
            assert guest.conversation.session.sent.weight <= g.RING_MS


# pauses


@in_virtual_time
async def test_a_pause_stops_the_sending_and_what_follows_goes_on_where_it_stood() -> None:
    async with peer() as p:
        p.send(*say(1, LONG))
        await p.until(g.Packet)
        await asyncio.sleep(3.0)
        p.send(g.Pause(turn=1, heard=16000))
        await asyncio.sleep(0.1)
        before = sound(received(p))
        await asyncio.sleep(20)
        assert p.quiet()
        p.send(g.Continue(turn=1))
        await asyncio.sleep(3)
        after = sound(received(p))
        assert after, "it has gone on, once what was in store is heard"
        assert after[0][0] == sum(before[-1])
        p.send(g.Interrupt(turn=1))
        done = await p.until(g.Done)
        assert done.heard == pytest.approx(16000 + 3 * 16000, abs=1000)


@in_virtual_time
async def test_a_turn_can_be_paused_before_it_is_spoken_and_interrupted_while_it_stands() -> None:
    async with peer() as p:
        p.send(g.Speak(turn=1, text=b"one "), *say(2))
        p.send(g.Pause(turn=2), g.Interrupt(turn=1))
        assert (await p.until(g.Done)).turn == 1
        await asyncio.sleep(5)
        assert not [m for m in received(p) if isinstance(m, g.Packet)]
        p.send(g.Interrupt(turn=2))
        assert await p.until(g.Done) == g.Done(turn=2, reason="interrupted", samples=0, heard=0, char=0)


@in_virtual_time
async def test_acknowledgements_during_a_pause_say_where_it_goes_on() -> None:
    async with peer() as p:
        p.send(*say(1, LONG))
        await asyncio.sleep(3.0)
        p.send(g.Pause(turn=1))
        p.send(g.Ack(turn=1, sample=8000, queue=0, underruns=0, skew=0))
        await asyncio.sleep(5.0)
        p.send(g.Interrupt(turn=1))
        assert (await p.until(g.Done)).heard == 8000


# revisions


class Player:
    """What a client hears: packets, less what was discarded."""

    def __init__(self) -> None:
        self.marks: list[g.Mark] = []
        self.end = 0
        self.discards: list[g.Discard] = []
        self.done: g.Done | None = None

    def take(self, messages: list[g.ServerMessage]) -> None:
        for m in messages:
            if isinstance(m, g.Packet) and m.pcm is not None:
                assert m.sample == self.end
                self.end += len(m.pcm)
                self.marks += m.marks or ()
            elif isinstance(m, g.Discard):
                self.discards.append(m)
                self.end = min(self.end, m.sample)
                self.marks = [x for x in self.marks if x.sample < m.sample]
            elif isinstance(m, g.Done):
                self.done = m

    @property
    def words(self) -> list[str]:
        return [m.text for m in self.marks if m.kind == "word"]

    def spoken(self, text: str) -> bool:
        """Whether the words carry the offsets that they have in a text."""
        return all(text[m.char_start : m.char_end] == m.text for m in self.marks if m.kind == "word")


OLD = "one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen. "
NEW = "and the other ones. "


@pytest.mark.parametrize("after", [0.0, 0.7, 2.0])
@pytest.mark.parametrize("kept", ["", "one two ", "one two three four five six seven ", OLD])
@in_virtual_time
async def test_a_splice_replaces_what_was_not_heard(after: float, kept: str) -> None:
    async with peer() as p:
        player = Player()
        p.send(*say(1, OLD + OLD))
        await p.until(g.Begin)
        await asyncio.sleep(after)
        player.take(received(p))
        before = [(m.text, m.sample) for m in player.marks if m.kind == "word"]
        p.send(g.Splice(turn=1, char=len(kept)), g.Speak(turn=1, text=NEW.encode()), g.End(turn=1))
        await asyncio.sleep(60)
        player.take(received(p))
        assert player.done
        assert player.done.samples == player.end
        [discard] = player.discards
        whole = (OLD + OLD)[: discard.char] + NEW
        assert discard.char >= len(kept)
        assert player.words == f"{whole[: discard.char]} {NEW}".replace(".", "").split()
        assert player.spoken(whole)
        heard = [w for w, sample in before if sample <= 16000 * after]
        assert player.words[: len(heard)] == heard
        if discard.char > len(kept):
            assert len(whole) - len(NEW) <= len(" ".join(heard)) + 12, "no more stays than had to"


@in_virtual_time
async def test_a_splice_of_a_turn_that_waits_changes_its_text() -> None:
    async with peer() as p:
        p.send(g.Speak(turn=1, text=b"first "), *say(2, OLD))
        p.send(g.Splice(turn=2, char=8), g.Speak(turn=2, text=b"more."), g.End(turn=2), g.End(turn=1))
        packets, _ = await p.rest_of_turn(2)
        assert [m.text for q in packets for m in q.marks or () if m.kind == "word"] == ["one", "two", "more"]


@pytest.mark.parametrize(("back", "said_again"), [(0, "Four"), (1, "One"), (9, "One")])
@in_virtual_time
async def test_seeking_says_a_sentence_again(back: int, said_again: str) -> None:
    text = "One two three. Four five six seven eight nine. Ten eleven twelve. "
    async with peer() as p:
        player = Player()
        p.send(*say(1, text))
        while "five" not in player.words:
            player.take([await p.next()])
        at = next(m.sample for m in player.marks if m.text == "five")
        p.send(g.Seek(turn=1, back=back, heard=at))
        await asyncio.sleep(60)
        player.take(received(p))
        [discard] = player.discards
        assert text[discard.char :].startswith(said_again)
        assert player.spoken(text)
        cut = max(i for i, w in enumerate(player.words) if w == said_again)
        assert player.words[cut:] == text[discard.char :].replace(".", "").split()
        assert player.words[:cut][:5] == ["One", "two", "three", "Four", "five"]
        assert player.done
        assert player.done.samples == player.end


@in_virtual_time
async def test_a_revised_turn_can_be_interrupted_and_says_what_was_heard_of_the_new_text() -> None:
    async with peer() as p:
        player = Player()
        p.send(*say(1, OLD))
        await asyncio.sleep(1.0)
        player.take(received(p))
        p.send(g.Splice(turn=1, char=0), g.Speak(turn=1, text=NEW.encode()))
        await asyncio.sleep(1.0)
        player.take(received(p))
        [discard] = player.discards
        the = next(m for m in player.marks if m.text == "the")
        p.send(g.Interrupt(turn=1, heard=the.sample + 10))
        done = await p.until(g.Done)
        assert done.char == the.char_end == discard.char + NEW.index("the ") + 3
        assert all(v.closes == 1 for v in p.voices.acquired)


@in_virtual_time
async def test_revisions_of_a_turn_that_is_over_are_ignored() -> None:
    async with peer() as p:
        p.send(*say(1, "one."))
        await p.rest_of_turn(1)
        p.send(
            g.Splice(turn=1, char=0),
            g.Seek(turn=1, back=0),
            g.Pause(turn=1),
            g.Continue(turn=1),
            g.Ping(id=1),
        )
        assert (await p.next()).id == 1


@in_virtual_time
async def test_the_lead_does_not_add_up_over_turns() -> None:
    """SPEC 3.1: at most 1.5 s ahead of what is heard, over all turns."""
    async with peer() as p:
        for turn in range(1, 9):
            p.send(*say(turn, "One two three. "))
        loop = asyncio.get_running_loop()
        start, sent = None, 0.0
        while True:
            message = await p.next()
            start = loop.time() if start is None else start
            if isinstance(message, g.Packet) and message.pcm is not None:
                sent += len(message.pcm) / 16000
                assert sent <= loop.time() - start + 1.5 + 0.04
            if isinstance(message, g.Done) and message.turn == 8:
                break


@in_virtual_time
async def test_a_connection_lost_again_has_its_half_minute_again() -> None:
    p = Peer(FakeVoices())
    ready = await greeted(p, g.Hello())
    for _ in range(4):
        p.socket.cut()
        await p.running
        await asyncio.sleep(g.LINGER_MS / 1000 - 2)
        p = Peer(p.voices, world=p.world)
        assert (await greeted(p, g.Hello(resume=ready.resume, received=0))).resumed
    await p.gone()
    assert p.world.gate.inside == 0
