"""A turn with the real front-end and a voice made of arithmetic, in time that costs nothing."""

from __future__ import annotations

import asyncio
import random
from collections.abc import Callable
from contextlib import aclosing

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.errors import SynthesisError, TextTooLong
from fapstream.pipeline import Pipeline
from fapstream.records import Packet, TurnFormat, Utterance
from fapstream.talk import AHEAD_S, MAX_PENDING_TEXT, SLICE, Talk
from fapstream.tts import PHRASE, FrontEnd, Manner
from tests.unit.fakes import Failing, FakeVoice, VirtualLoop, in_virtual_time

RATE = 16000
TEXT = "Hello world, it is late. \\:)300 He said: go home! The rain in Spain stays mainly in the plain. "


def build(voice: FakeVoice, heard_s: Callable[[], float] | None = None, look_ahead: int = PHRASE) -> Talk:
    turn = TurnFormat(1, "v", "en", voice.sample_rate, 25)
    return Talk(Pipeline(turn, FrontEnd("en", Manner(look_ahead=look_ahead)), seed=1), voice, heard_s)


async def all_packets(talk: Talk) -> list[Packet]:
    async with aclosing(talk.packets()) as packets:
        return [p async for p in packets]


def shape(packets: list[Packet]) -> list[object]:
    """All but the FAP values: how the face leaves a pause depends on when the next phone was known."""
    return [(p.start, p.pcm.tobytes(), p.marks, [f.sample for f in p.frames]) for p in packets]


def words(packets: list[Packet]) -> list[str]:
    return [m.text for p in packets for m in p.marks if m.kind == "word"]


async def said(pieces: list[str]) -> list[Packet]:
    """A turn whose text comes in pieces, everything else getting a chance to run between them."""
    voice = FakeVoice(RATE)
    talk = build(voice)

    async def feed() -> None:
        for piece in pieces:
            talk.feed(piece)
            await asyncio.sleep(0)
        talk.end()

    feeding = asyncio.create_task(feed())
    packets = await all_packets(talk)
    await feeding
    await talk.aclose()
    assert voice.closes == 1
    return packets


def cut(text: str, seed: int) -> list[str]:
    rng, pieces, at = random.Random(seed), [], 0
    while at < len(text):
        size = rng.choice([1, 2, 5, 30, 300])
        pieces.append(text[at : at + size])
        at += size
    return pieces


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10**6))
def test_fragments_do_not_matter(seed: int) -> None:
    with asyncio.Runner(loop_factory=VirtualLoop) as runner:
        whole = runner.run(said([TEXT * 4]))
        assert shape(runner.run(said(cut(TEXT * 4, seed)))) == shape(whole)
    assert words(whole)[:3] == ["Hello", "world", "it"]
    assert len(words(whole)) == 4 * 18


@in_virtual_time
async def test_an_empty_turn_ends_without_a_packet() -> None:
    assert await said([]) == []
    assert await said(["", " \n", "🫨\x00"]) == []


@in_virtual_time
async def test_text_that_stalls_is_held() -> None:
    voice = FakeVoice(RATE)
    talk = build(voice, lambda: asyncio.get_running_loop().time(), look_ahead=0)
    talk.feed("one two thr")
    got: list[Packet] = []

    async def listen() -> None:
        async with aclosing(talk.packets()) as packets:
            async for p in packets:
                got.append(p)

    listening = asyncio.create_task(listen())
    await asyncio.sleep(0.15)
    assert [w.text for u in voice.written for w in u.words] == ["one", "two"]
    assert not voice.written[0].closed
    assert len(voice.written) == 1, "what was made is still being heard"
    await asyncio.sleep(2)
    [hold] = voice.written[1:]
    assert all(p.hold for p in hold.phones)
    assert hold.closed
    assert words(got) == ["one", "two"]
    assert got[-1].hold
    await asyncio.sleep(100)
    assert len(voice.written) == 2, "held once, however long it stays silent"
    talk.feed("ee four.")
    talk.end()
    await listening
    await talk.aclose()
    assert words(got) == ["one", "two", "three", "four"]
    assert not got[-1].hold


@in_virtual_time
async def test_nobody_listens_nothing_is_cut_short() -> None:
    """Into a file (no `heard_s`) a stall changes nothing."""
    voice = FakeVoice(RATE)
    talk = build(voice)
    listening = asyncio.create_task(all_packets(talk))
    for piece in ("Hello wor", "ld, it is", " late. "):
        talk.feed(piece)
        await asyncio.sleep(3)
    talk.end()
    stalled = await listening
    await talk.aclose()
    assert shape(stalled) == shape(await said(["Hello world, it is late. "]))
    assert voice.flushes == 0


@in_virtual_time
async def test_text_that_waits_is_not_stalled(monkeypatch: pytest.MonkeyPatch) -> None:
    """A loop that has other things to do for a second makes no phrase break."""
    voice = FakeVoice(RATE)
    talk = build(voice, heard_s=lambda: 1e9)
    loop, feed = asyncio.get_running_loop(), talk._pipeline.feed
    assert isinstance(loop, VirtualLoop)

    def slow(text: str) -> list[Utterance]:
        loop._virtual.now += 1.0
        return feed(text)

    monkeypatch.setattr(talk._pipeline, "feed", slow)
    text = "la" * 90 + ". " + " ".join(["lalalalalalalalalalalala"] * 15) + ". "
    assert len(text) > 2 * SLICE
    talk.feed(text)
    listening = asyncio.create_task(all_packets(talk))
    for _ in range(20):
        await asyncio.sleep(0)
    talk.end()
    await listening
    await talk.aclose()
    assert [(len(u.words), u.closed) for u in voice.written] == [(1, True), (15, True)]


@pytest.mark.parametrize("where", ["write", "speech"])
@pytest.mark.parametrize("n", [1, 3])
@in_virtual_time
async def test_a_voice_that_breaks_ends_the_turn_with_its_error(where: str, n: int) -> None:
    voice = FakeVoice(RATE, Failing(where, n))
    talk = build(voice)
    talk.feed(TEXT * 3)
    talk.end()
    with pytest.raises(SynthesisError, match=f"broke in {where}"):
        await all_packets(talk)
    await talk.aclose()
    assert voice.closes == 1


@in_virtual_time
async def test_leaving_early_gives_the_voice_back() -> None:
    voice = FakeVoice(RATE)
    talk = build(voice)
    talk.feed(TEXT)
    async with aclosing(talk.packets()) as packets:
        async for _ in packets:
            break
    await talk.aclose()
    assert voice.closes == 1
    assert len(asyncio.all_tasks()) == 1


@in_virtual_time
async def test_never_begun_gives_the_voice_back() -> None:
    voice = FakeVoice(RATE)
    await build(voice).aclose()
    assert voice.closes == 1


@in_virtual_time
async def test_being_cancelled_while_closing_gives_the_voice_back() -> None:
    voice = FakeVoice(RATE)
    talk = build(voice)
    talk.feed(TEXT)
    async with aclosing(talk.packets()) as packets:
        await anext(packets)
    closing = asyncio.create_task(talk.aclose())
    await asyncio.sleep(0)
    closing.cancel()
    await asyncio.gather(closing, return_exceptions=True)
    await asyncio.sleep(0.1)
    assert voice.closes == 1


@in_virtual_time
async def test_too_much_text_is_refused_whole_and_loses_nothing() -> None:
    voice = FakeVoice(RATE)
    talk = build(voice)
    talk.feed("one. " * (MAX_PENDING_TEXT // 5 - 1))
    assert talk.room == MAX_PENDING_TEXT - 5 * (MAX_PENDING_TEXT // 5 - 1)
    room = talk.room
    with pytest.raises(TextTooLong) as caught:
        talk.feed("x" * (room + 1))
    assert (caught.value.pending, caught.value.limit) == (MAX_PENDING_TEXT + 1, MAX_PENDING_TEXT)
    assert talk.room == room
    talk.feed(" " * room)
    assert talk.room == 0
    talk.feed("")
    await talk.aclose()


@in_virtual_time
async def test_what_was_accepted_is_spoken() -> None:
    talk = build(FakeVoice(RATE))
    talk.feed("one two. ")
    with pytest.raises(TextTooLong):
        talk.feed("x" * MAX_PENDING_TEXT)
    talk.feed("three. ")
    talk.end()
    assert words(await all_packets(talk)) == ["one", "two", "three"]
    await talk.aclose()


@in_virtual_time
async def test_the_voice_is_not_driven_far_ahead_of_the_listener() -> None:
    voice = FakeVoice(RATE)
    talk = build(voice)
    talk.feed("one two three four five six. " * 200)
    talk.end()
    phrase_s = 4.0
    async with aclosing(talk.packets()) as packets:
        async for packet in packets:
            await asyncio.sleep(0.04)
            planned = sum(p.duration_ms for u in voice.written for p in u.phones) / 1000
            assert planned - packet.start / RATE <= AHEAD_S + 10 * phrase_s
            if packet.start > 60 * RATE:
                break
    assert len(voice.written) < 100
    assert talk.room < MAX_PENDING_TEXT
    await talk.aclose()


@pytest.mark.parametrize("steps", range(0, 40))
@in_virtual_time
async def test_it_can_be_stopped_at_any_step_while_the_voice_is_far_ahead(steps: int) -> None:
    """All the text has come and most of it waits: no moment is wrong for an interrupt."""
    voice = FakeVoice(RATE)
    talk = build(voice)
    talk.feed("one two three four five six. " * 200)
    talk.end()
    async with aclosing(talk.packets()) as packets:
        async for packet in packets:
            if packet.start > RATE:
                break
    for _ in range(steps):
        await asyncio.sleep(0)
    async with asyncio.timeout(10):
        await talk.aclose()
    assert voice.closes == 1


@in_virtual_time
async def test_heard_char() -> None:
    talk = build(FakeVoice(RATE))
    talk.feed("one two.")
    talk.end()
    packets = await all_packets(talk)
    first, second = (m for p in packets for m in p.marks if m.kind == "word")
    assert talk.heard_char(first.sample) == 3
    assert talk.heard_char(second.sample) == 7
    await talk.aclose()
