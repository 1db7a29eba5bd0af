"""A turn with the real front-end and a voice made of arithmetic, in time that costs nothing."""

from __future__ import annotations

import asyncio
import gc
import os
import random
import shutil
import tracemalloc
from collections.abc import Callable
from contextlib import aclosing
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.adapters.mbrola import MbrolaPool
from fapstream.errors import SynthesisError, TextTooLong
from fapstream.pipeline import Pipeline
from fapstream.ports import Synthesizer
from fapstream.records import Packet, TurnFormat, Utterance
from fapstream.talk import AHEAD_S, MAX_PENDING_TEXT, SLICE, Talk
from fapstream.tts import PHRASE, FrontEnd, Manner
from fapstream.tts.voices import voice
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


# cut and seek

LONG = "One two three, four five. Six seven? Eight nine ten eleven twelve. "


def cuttable(voices: list[FakeVoice], fail: Callable[[], None] = lambda: None) -> Talk:
    """`voices` collects those that are acquired."""

    async def again() -> FakeVoice:
        await asyncio.sleep(0)
        fail()
        voices.append(FakeVoice(RATE))
        return voices[-1]

    voices.append(FakeVoice(RATE))
    turn = TurnFormat(1, "v", "en", RATE, 25)
    front = FrontEnd("en", Manner(look_ahead=PHRASE))
    return Talk(Pipeline(turn, front, seed=1), voices[0], None, again)


class Listener:
    """Hears what is left when void packets are dropped."""

    def __init__(self) -> None:
        self.packets: list[Packet] = []

    def take(self, packet: Packet) -> None:
        self.packets.append(packet)

    def splice(self, t: int) -> None:
        kept = []
        for p in self.packets:
            if p.start < t:
                marks = tuple(m for m in p.marks if m.sample < t)
                frames = tuple(f for f in p.frames if f.sample < t)
                kept.append(replace(p, pcm=p.pcm[: t - p.start], marks=marks, frames=frames))
        self.packets = kept

    def check(self) -> None:
        """Gapless, and frames on the turn's grid."""
        assert all(a.start + len(a.pcm) == b.start for a, b in pairwise(self.packets))
        frames = [f.sample for p in self.packets for f in p.frames]
        end = self.packets[-1].start + len(self.packets[-1].pcm)
        assert frames == list(range(0, end, RATE // 25))
        for p in self.packets:
            assert all(p.start <= m.sample < p.start + len(p.pcm) for m in p.marks)


@pytest.mark.parametrize("after", [3, 20, 45, 200])
@in_virtual_time
async def test_after_a_cut_other_text_is_spoken_from_the_end_of_the_word(after: int) -> None:
    voices: list[FakeVoice] = []
    talk, ears = cuttable(voices), Listener()
    talk.feed(LONG * 3)
    talk.end()
    async with aclosing(talk.packets()) as packets:
        async for packet in packets:
            ears.take(packet)
            if len(ears.packets) == after:
                break
        heard = max(0, ears.packets[-1].start - RATE)
        word = talk.heard_word(heard)
        t = talk.cut(heard, 1000, "")
        ears.splice(t)
        marks = [m for p in ears.packets for m in p.marks if m.kind == "word"]
        if marks:
            last = marks[-1]
            assert (last.char_start, last.char_end) == word
            assert t == max(heard, last.sample + last.duration)
        talk.feed("Now something else. ")
        talk.end()
        first = await anext(packets)
        assert first.start == t
        ears.take(first)
        async for packet in packets:
            ears.take(packet)
    ears.check()
    await talk.aclose()
    assert [v.closes for v in voices] == [1, 1]
    fresh = await said(["Now something else. "])
    new = np.concatenate([p.pcm for p in ears.packets if p.start >= t])
    assert np.array_equal(new, np.concatenate([p.pcm for p in fresh]))
    expected = [(m.kind, m.sample + t, m.duration, m.text) for p in fresh for m in p.marks]
    assert [(m.kind, m.sample, m.duration, m.text) for p in ears.packets for m in p.marks
            if m.sample >= t] == expected  # fmt: skip
    said_again = [m for p in ears.packets for m in p.marks if m.kind == "word" and m.sample >= t]
    assert [(m.char_start, m.char_end) for m in said_again] == [(1000, 1003), (1004, 1013), (1014, 1018)]


@in_virtual_time
async def test_a_turn_that_was_over_can_be_sought_back() -> None:
    """Also when its packets were all taken: they are still being heard."""
    voices: list[FakeVoice] = []
    talk, ears = cuttable(voices), Listener()
    talk.feed(LONG)
    talk.end()
    for packet in await all_packets(talk):
        ears.take(packet)
    eight = next(m for p in ears.packets for m in p.marks if m.text == "Eight")
    assert talk.heard_word(eight.sample) == (LONG.index("Eight"), LONG.index("Eight") + 5)
    assert talk.seek_char(eight.sample, 0) == LONG.index("Eight")
    assert talk.seek_char(eight.sample, 1) == LONG.index("Six")
    assert talk.seek_char(eight.sample, 2) == talk.seek_char(eight.sample, 9) == 0
    char = talk.seek_char(eight.sample, 1)
    t = talk.cut(eight.sample, char, talk.text_from(char))
    talk.end()
    ears.splice(t)
    for packet in await all_packets(talk):
        ears.take(packet)
    ears.check()
    await talk.aclose()
    heard = words(ears.packets)
    assert heard == [w.strip(",.?") for w in (LONG[: LONG.index("nine")] + LONG[char:]).split()]
    assert talk.text_from(0) == LONG


@pytest.mark.parametrize("seed", range(12))
@in_virtual_time
async def test_cut_at_any_moment_and_again(seed: int) -> None:
    """Before anything was said, while voices are being acquired, twice at once, with text on its way."""
    rng = random.Random(seed)
    voices: list[FakeVoice] = []
    talk, ears = cuttable(voices), Listener()
    talk.feed(LONG)
    done = False

    async def listen() -> None:
        async with aclosing(talk.packets()) as packets:
            async for packet in packets:
                ears.take(packet)
                await asyncio.sleep(0.01)

    listening = asyncio.create_task(listen())
    for k in range(8):
        for _ in range(rng.choice([0, 1, 3, 30])):
            await asyncio.sleep(rng.choice([0, 0.01]))
        made = ears.packets[-1].start if ears.packets else 0
        t = talk.cut(rng.randrange(0, made + 1), 100 * k)
        ears.splice(t)
        if rng.random() < 0.8:
            talk.feed(LONG)
    talk.feed("The end.")
    talk.end()
    await asyncio.wait_for(listening, 100)
    ears.check()
    assert words(ears.packets)[-2:] == ["The", "end"]
    await talk.aclose()
    assert all(v.closes == 1 for v in voices)
    assert not done


@in_virtual_time
async def test_no_other_voice_ends_the_turn_with_its_error() -> None:
    def fail() -> None:
        raise SynthesisError("none is left")

    voices: list[FakeVoice] = []
    talk = cuttable(voices, fail)
    talk.feed(LONG)
    async with aclosing(talk.packets()) as packets:
        await anext(packets)
        talk.cut(0, 0, LONG)
        with pytest.raises(SynthesisError, match="none is left"):
            async for _ in packets:
                pass
    await talk.aclose()
    assert voices[0].closes == 1


@in_virtual_time
async def test_text_said_again_may_be_longer_than_what_may_wait() -> None:
    voices: list[FakeVoice] = []
    talk = cuttable(voices)
    talk.feed("x. " * (MAX_PENDING_TEXT // 3))
    text = talk.text_from(0)
    talk.cut(0, 0, text + text)
    assert talk.room == 0
    with pytest.raises(TextTooLong):
        talk.feed("x")
    talk.cut(0, 0)
    assert talk.room == MAX_PENDING_TEXT
    assert talk.text_from(0) == ""
    await talk.aclose()


@in_virtual_time
async def test_a_talk_without_another_voice_cannot_be_cut() -> None:
    talk = build(FakeVoice(RATE))
    with pytest.raises(ValueError, match="cannot be cut"):
        talk.cut(0, 0)
    await talk.aclose()


@in_virtual_time
async def test_half_an_hour_of_text_leaves_nothing_behind() -> None:
    """Memory after ten minutes and after half an hour is the same, but for what text and words are kept."""
    text = "The rain in Spain, they said \\:) in 1234, stays <mark name='m'/>mainly in the plain! " * 40
    talk = build(FakeVoice(RATE))
    sizes: list[int] = []
    talk.feed(text)
    tracemalloc.start()
    try:
        async with aclosing(talk.packets()) as packets:
            async for packet in packets:
                if packet.start >= 1800 * RATE:
                    break
                if talk.room > MAX_PENDING_TEXT - len(text):
                    talk.feed(text)
                talk._synthesizer.written.clear()  # type: ignore[attr-defined]
                if packet.start // (300 * RATE) > len(sizes):
                    gc.collect()
                    sizes.append(tracemalloc.get_traced_memory()[0])
    finally:
        tracemalloc.stop()
        await talk.aclose()
    assert len(sizes) >= 5
    assert max(sizes[2:]) < sizes[1] + 200_000


TEXTS = {
    "us1": (
        "The rain in Spain stays mainly in the plain, they say. Is it true? ",
        "Now something else, at last. ",
    ),
    "gr2": ("Η βροχή στην Ισπανία πέφτει στον κάμπο, λένε. Είναι αλήθεια; ", "Τώρα κάτι άλλο, επιτέλους. "),
}
FACE_SPEED = 1.05
"""The seam may move a FAP by so much of what speech moves it, before it or in a turn of what comes after."""


def real(pool: MbrolaPool, name: str, synthesizer: Synthesizer) -> Talk:
    v = voice(name)
    turn = TurnFormat(1, name, v.lang, v.sample_rate, 25)
    front = FrontEnd(v.lang, Manner().of(v))
    return Talk(Pipeline(turn, front, seed=3), synthesizer, None, lambda: pool.acquire(v))


@pytest.mark.skipif(shutil.which("mbrola") is None, reason="MBROLA is not installed")
@pytest.mark.parametrize("after", [10, 60, 130])
@pytest.mark.parametrize("name", TEXTS)
async def test_a_real_voice_is_cut_and_goes_on(name: str, after: int) -> None:
    """What was before t stays; from t on it is the sound of a turn of its own; the face does not jump."""
    pool, (text, other) = MbrolaPool(), TEXTS[name]
    rate = voice(name).sample_rate

    async def whole(said: str) -> list[Packet]:
        talk = real(pool, name, await pool.acquire(voice(name)))
        talk.feed(said)
        talk.end()
        packets = await all_packets(talk)
        await talk.aclose()
        return packets

    before, fresh = await whole(text * 3), await whole(other)
    talk, ears = real(pool, name, await pool.acquire(voice(name))), Listener()
    talk.feed(text * 3)
    async with aclosing(talk.packets()) as packets:
        async for packet in packets:
            ears.take(packet)
            if len(ears.packets) == after + 30:
                break
        t = talk.cut(after * rate // 25, 500, other)
        talk.end()
        ears.splice(t)
        async for packet in packets:
            ears.take(packet)
    await talk.aclose()
    await pool.aclose()
    assert after * rate // 25 <= t <= (after + 30) * rate // 25
    assert all(a.start + len(a.pcm) == b.start for a, b in pairwise(ears.packets))
    sound = np.concatenate([p.pcm for p in ears.packets])
    assert np.array_equal(sound[:t], np.concatenate([p.pcm for p in before])[:t])
    assert np.array_equal(sound[t:], np.concatenate([p.pcm for p in fresh]))
    frames = [f for p in ears.packets for f in p.frames]
    assert [f.sample for f in frames] == [k * rate // 25 for k in range(len(frames))]
    speed = np.abs(np.diff([f.values for f in frames], axis=0))
    seam = next(k for k, f in enumerate(frames) if f.sample >= t)
    usual = np.max(
        [
            np.abs(np.diff([f.values for p in of for f in p.frames], axis=0)).max(axis=0)
            for of in (before, fresh)
        ],
        axis=0,
    )
    assert (speed[seam - 1 : seam + 3] <= np.maximum(FACE_SPEED * usual, 60)).all()
    marks = [m for p in ears.packets for m in p.marks if m.kind == "word" and m.sample >= t]
    assert [other[m.char_start - 500 : m.char_end - 500] for m in marks] == [m.text for m in marks]
    assert [m.text for m in marks] == [m.text for p in fresh for m in p.marks if m.kind == "word"]


@pytest.mark.skipif(shutil.which("mbrola") is None, reason="MBROLA is not installed")
async def test_turns_that_are_cut_and_left_leave_no_process_behind() -> None:
    pool = MbrolaPool()
    fds = len(os.listdir("/proc/self/fd")) if os.path.isdir("/proc/self/fd") else 0
    for k in range(6):
        talk = real(pool, "us1", await pool.acquire(voice("us1")))
        talk.feed(TEXTS["us1"][0] * 5)
        async with aclosing(talk.packets()) as packets:
            for _ in range(k + 1):
                await anext(packets)
                talk.cut(0, 0, TEXTS["us1"][0])
        await talk.aclose()
    await pool.aclose()
    with pytest.raises(ChildProcessError):
        os.waitpid(-1, os.WNOHANG)
    await asyncio.sleep(0.01)
    assert len(asyncio.all_tasks()) == 1
    if fds:
        assert len(os.listdir("/proc/self/fd")) <= fds + 2
