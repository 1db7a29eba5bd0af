"""MBROLA as it is: samples to the last one, processes that are killed, turns that follow each other."""

from __future__ import annotations

import asyncio
import errno
import os
import random
import shutil
import signal
from collections.abc import AsyncIterator, Callable
from contextlib import suppress
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from fapstream.adapters import mbrola, mbrola_process
from fapstream.adapters.mbrola import MAX_RESTARTS, MbrolaPool, MbrolaSynthesizer, amplified
from fapstream.adapters.mbrola_process import MbrolaProcess
from fapstream.adapters.spares import Limits
from fapstream.errors import SynthesisError, VoiceOverloaded, VoiceUnavailable
from fapstream.records import SILENCE, Pcm, Phone, Speech, TimedPhone, Utterance, Word
from fapstream.tts import FrontEnd, Manner, phone_set
from fapstream.tts.voices import Voice, voice

pytestmark = pytest.mark.skipif(shutil.which("mbrola") is None, reason="MBROLA is not installed")

VOICES = ["us1", "gr2"]


@pytest.fixture
async def pool() -> AsyncIterator[MbrolaPool]:
    made = MbrolaPool()
    yield made
    await made.aclose()


def utterance(name: str, n: int, seed: int, closed: bool = True) -> Utterance:
    """n random phones that the voice can say, then a pause if it is closed."""
    rng = np.random.default_rng(seed)
    v = voice(name)
    names = [p for p in phone_set(v.lang) if p != SILENCE]
    phones = [
        Phone(str(rng.choice(names)), float(rng.uniform(35, 110)), ((0.0, v.f0_hz),), word=0)
        for _ in range(n)
    ]
    if closed:
        phones.append(Phone(SILENCE, 120.0))
    return Utterance(v.lang, tuple(phones), (Word(f"w{seed}", seed, seed + 1),), closed)


async def spoken(
    synthesizer: MbrolaSynthesizer,
    utterances: list[Utterance],
    meanwhile: Callable[[int], None] = lambda _: None,
    finish_first: bool = True,
) -> tuple[Pcm, list[TimedPhone]]:
    """A whole turn; `meanwhile` is told how many samples have come."""
    pcm: list[Pcm] = []
    phones: list[TimedPhone] = []

    async def listen() -> None:
        async for speech in synthesizer.speech():
            check(speech, sum(map(len, pcm)), phones)
            pcm.append(speech.pcm)
            phones.extend(speech.phones)
            meanwhile(sum(map(len, pcm)))

    listening = asyncio.create_task(listen())
    for u in utterances:
        await synthesizer.write(u)
        if not finish_first:
            await asyncio.sleep(0.05)
    await synthesizer.finish()
    await asyncio.wait_for(listening, 5)
    return np.concatenate(pcm or [np.zeros(0, np.int16)]), phones


def check(speech: Speech, given: int, phones: list[TimedPhone]) -> None:
    """Gapless, and no phone later than the sound in which it is heard."""
    assert speech.start == given
    if speech.phones:
        assert speech.phones[0].start >= given


async def turn(pool: MbrolaPool, name: str, utterances: list[Utterance]) -> tuple[Pcm, list[TimedPhone]]:
    synthesizer = await pool.acquire(voice(name))
    try:
        return await spoken(synthesizer, utterances)
    finally:
        await synthesizer.aclose()


@pytest.mark.parametrize("name", VOICES)
async def test_marks_and_length(pool: MbrolaPool, name: str) -> None:
    """Phones follow each other from sample P on, as long as they wish, but for what the voice's table says
    of its database; the sound ends in their last pause."""
    v = voice(name)
    utterances = [utterance(name, 30, seed) for seed in range(3)]
    pcm, phones = await turn(pool, name, utterances)
    assert phones[0].start == v.period
    assert all(a.end == b.start for a, b in pairwise(phones))
    assert [t.phone for t in phones] == [p for u in utterances for p in u.phones]
    assert [t.text and t.text.text for t in phones] == 30 * ["w0"] + [None] + 30 * ["w1"] + [None] + 30 * [
        "w2"
    ] + [None]
    at = float(v.period)
    for u, k in zip(utterances, range(0, 93, 31), strict=True):
        for i, p in enumerate(u.phones):
            at += p.duration_ms * v.sample_rate / 1000
            shift = v.heard_shift(p.name, u.phones[i + 1].name) if i + 1 < len(u.phones) else 0
            low, high = sorted((at, at + shift))
            assert low - 2 <= phones[k + i].end <= high + 2
    planned = phones[-1].end - v.period
    assert len(pcm) == planned - v.period
    assert np.abs(pcm).max() > 3000
    assert np.abs(pcm[-v.period :]).max() < 100


@pytest.mark.parametrize("name", VOICES)
async def test_the_second_turn_of_a_process_sounds_like_the_first(pool: MbrolaPool, name: str) -> None:
    utterances = [utterance(name, 25, seed) for seed in range(2)]
    first = await pool.acquire(voice(name))
    pid = first._process.pid
    one = await spoken(first, utterances)
    await first.aclose()
    second = await pool.acquire(voice(name))
    assert second._process.pid == pid
    two = await spoken(second, utterances)
    await second.aclose()
    assert [(t.start, t.end) for t in one[1]] == [(t.start, t.end) for t in two[1]]
    assert np.array_equal(one[0], two[0])


@pytest.mark.parametrize("name", VOICES)
async def test_when_the_turn_is_finished_does_not_change_its_sound(pool: MbrolaPool, name: str) -> None:
    utterances = [utterance(name, 12, 1)]
    early = await turn(pool, name, utterances)
    late = await pool.acquire(voice(name))
    other = await spoken(late, utterances, finish_first=False)
    await late.aclose()
    assert np.array_equal(early[0], other[0])


@pytest.mark.parametrize("name", VOICES)
@pytest.mark.parametrize("kills", [1, MAX_RESTARTS])
async def test_a_killed_process_is_not_heard(pool: MbrolaPool, name: str, kills: int) -> None:
    utterances = [utterance(name, 20, seed) for seed in range(6)]
    whole, phones = await turn(pool, name, utterances)
    synthesizer = await pool.acquire(voice(name))
    left = [len(whole) * (k + 1) // (kills + 2) for k in range(kills)]

    killed = []

    def kill(given: int) -> None:
        process = synthesizer._process  # none between two processes
        if left and given > left[0] and process and process not in killed and process.alive:
            left.pop(0)
            killed.append(process)
            os.kill(process.pid, signal.SIGKILL)

    try:
        again, same = await spoken(synthesizer, utterances, kill)
    finally:
        await synthesizer.aclose()
    assert killed
    assert same == phones
    assert len(again) == len(whole)
    assert np.array_equal(again, whole)


async def test_killed_before_it_says_anything(pool: MbrolaPool) -> None:
    utterances = [utterance("us1", 20, seed) for seed in range(2)]
    whole, _ = await turn(pool, "us1", utterances)
    synthesizer = await pool.acquire(voice("us1"))
    os.kill(synthesizer._process.pid, signal.SIGKILL)
    again, _ = await spoken(synthesizer, utterances)
    await synthesizer.aclose()
    assert np.array_equal(again, whole)


async def test_killed_once_too_often_it_gives_up(pool: MbrolaPool, monkeypatch: pytest.MonkeyPatch) -> None:
    started, start = [], MbrolaProcess.start

    async def doomed(v: Voice, *more: Any) -> MbrolaProcess:
        process = await start(v, *more)
        started.append(process)
        os.kill(process.pid, signal.SIGKILL)
        return process

    monkeypatch.setattr(MbrolaProcess, "start", doomed)
    synthesizer = await pool.acquire(voice("us1"))
    with pytest.raises(SynthesisError, match="died 4 times"):
        await spoken(synthesizer, [utterance("us1", 20, seed) for seed in range(3)])
    assert len(started) == 1 + MAX_RESTARTS
    with pytest.raises(SynthesisError):
        await synthesizer.write(utterance("us1", 3, 0))
    await synthesizer.aclose()


async def test_other_turns_never_notice(pool: MbrolaPool) -> None:
    utterances = [utterance("us1", 20, seed) for seed in range(4)]
    whole, _ = await turn(pool, "us1", utterances)
    other, victim = await pool.acquire(voice("us1")), await pool.acquire(voice("us1"))
    speaking = asyncio.create_task(spoken(other, utterances))
    os.kill(victim._process.pid, signal.SIGKILL)
    assert np.array_equal((await speaking)[0], whole)
    await victim.aclose()
    await other.aclose()


async def test_a_flush_inside_a_phrase_brings_out_everything(pool: MbrolaPool) -> None:
    synthesizer = await pool.acquire(voice("us1"))
    speech = synthesizer.speech()
    open_one = utterance("us1", 6, 1, closed=False)
    await synthesizer.write(open_one)
    await synthesizer.flush()
    end = voice("us1").period + round(sum(p.duration_ms for p in open_one.phones) * 16)
    given = 0
    phones: list[TimedPhone] = []
    while given < end:
        got = await asyncio.wait_for(anext(speech), 5)
        given += len(got.pcm)
        phones += got.phones
    assert phones[-1].phone == Phone(SILENCE, mbrola.CLOSING_MS)
    assert phones[-1].start == pytest.approx(end, abs=1)
    await synthesizer.flush()
    await synthesizer.finish()
    rest = [s async for s in speech]
    assert not any(s.phones for s in rest), "what is closed needs no second closing"
    await synthesizer.aclose()


async def test_an_empty_turn(pool: MbrolaPool) -> None:
    pcm, phones = await turn(pool, "us1", [])
    assert len(pcm) == 0
    assert phones == []
    pcm, phones = await turn(pool, "us1", [Utterance("en", ())])
    assert len(pcm) == 0


async def test_a_missing_database_is_told() -> None:
    nobody = replace(voice("us1"), name="zz9")
    assert mbrola_process.database(nobody) is None
    pool = MbrolaPool()
    with pytest.raises(VoiceUnavailable, match="zz9"):
        await pool.acquire(nobody)
    with pytest.raises(VoiceUnavailable):
        await pool.warm(nobody)
    await pool.aclose()


async def test_a_missing_program_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mbrola_process, "which", lambda _: None)
    with pytest.raises(VoiceUnavailable, match="not installed"):
        await MbrolaPool().acquire(voice("us1"))


async def test_a_finished_turn_gives_its_process_back_once(pool: MbrolaPool) -> None:
    synthesizer = await pool.acquire(voice("us1"))
    await spoken(synthesizer, [utterance("us1", 3, 0)])
    await synthesizer.aclose()
    await synthesizer.aclose()
    a, b = await pool.acquire(voice("us1")), await pool.acquire(voice("us1"))
    assert a._process is not b._process
    await a.aclose()
    await b.aclose()


async def test_a_turn_left_in_the_middle_ends_its_process(pool: MbrolaPool) -> None:
    synthesizer = await pool.acquire(voice("us1"))
    process = synthesizer._process
    await synthesizer.write(utterance("us1", 30, 0, closed=False))
    await anext(synthesizer.speech())
    await synthesizer.aclose()
    assert not process.alive


async def test_left_with_much_unread_it_still_ends(pool: MbrolaPool) -> None:
    """Half a megabyte in the pipes, and nobody to take it."""
    synthesizer = await pool.acquire(voice("us1"))
    process = synthesizer._process
    synthesizer._reader.cancel()
    pause = Utterance("en", (Phone(SILENCE, 9000.0),))
    for _ in range(3):
        await asyncio.wait_for(synthesizer.write(pause), 5)
    for _ in range(200):
        await asyncio.sleep(0.001)
    await asyncio.wait_for(synthesizer.aclose(), 5)
    assert not process.alive


async def test_gain(pool: MbrolaPool) -> None:
    """The voice's gain is on the sound, clipped to 16 bits."""
    utterances = [utterance("us1", 10, 0)]
    plain, _ = await turn(pool, "us1", utterances)
    for gain in (0.5, 40.0):
        made = await pool.acquire(voice("us1"))
        made._voice = replace(voice("us1"), gain=gain)
        louder, _ = await spoken(made, utterances)
        await made.aclose()
        expected = np.clip(np.rint(plain * (gain / voice("us1").gain)), -32768, 32767)
        assert np.abs(louder - expected).max() <= 1 + gain


def test_amplified() -> None:
    pcm = np.array([-32768, -3, 0, 3, 20000], np.int16)
    assert amplified(pcm, 1.0) is pcm
    assert amplified(pcm, 2.0).tolist() == [-32768, -6, 0, 6, 32767]
    assert amplified(pcm, 0.5).tolist() == [-16384, -2, 0, 2, 10000]


TEXTS = {
    "us1": "Hello world, it is 21:45. The apples that you left are in the <emphasis>red</emphasis> box! ",
    "gr2": "Καλημέρα, είδα τον πατέρα σου στις 21:45. Πού πας; Τα ψάρια και τα ξύλα είναι έξω! ",
}


@pytest.mark.parametrize("look_ahead", [0, 1, 1000])
@pytest.mark.parametrize("name", TEXTS)
async def test_the_pieces_in_which_text_comes_cannot_be_heard(
    pool: MbrolaPool, name: str, look_ahead: int
) -> None:
    """The same text and look-ahead: the same samples and phone times, however it was cut."""
    v = voice(name)

    async def said(pieces: list[str]) -> tuple[Pcm, list[TimedPhone]]:
        front = FrontEnd(v.lang, Manner(look_ahead=look_ahead).of(v))
        return await turn(pool, name, [u for piece in pieces for u in front.feed(piece)] + front.end())

    text = TEXTS[name]
    whole, phones = await said([text])
    for size in (1, 5):
        pcm, timed = await said([text[at : at + size] for at in range(0, len(text), size)])
        assert pcm.tobytes() == whole.tobytes()
        assert [(t.start, t.end, t.text, t.phone._replace(word=0)) for t in timed] == [
            (t.start, t.end, t.text, t.phone._replace(word=0)) for t in phones
        ]


@pytest.mark.parametrize("name", TEXTS)
async def test_a_hold_is_smooth_and_takes_nothing_away(pool: MbrolaPool, name: str) -> None:
    """The last vowel goes on at its level and fades before the pause; all else is as without the hold."""
    v = voice(name)
    front = FrontEnd(v.lang, Manner(look_ahead=0).of(v))
    before = front.feed(
        TEXTS[name].split(",")[0].rsplit(" ", 1)[0] + (" you now " if v.lang == "en" else " τώρα ")
    )
    held = front.hold()
    after = front.feed("everything. " if v.lang == "en" else "όλα. ") + front.end()
    pcm, phones = await turn(pool, name, before + held + after)
    drawn = next(t for t in phones if t.phone.hold)
    vowel = next(t for t in phones if t.end == drawn.start)
    assert (drawn.phone.name, vowel.phone.name) == (vowel.phone.name, drawn.phone.name)
    frame = v.sample_rate // 100
    level = [
        float(np.sqrt((pcm[at : at + frame].astype(float) ** 2).mean()))
        for at in range(vowel.start + 2 * frame, drawn.end - 3 * frame, frame)
    ]
    steps = 20 * np.abs(np.diff(np.log10(level)))
    assert steps.max() < 6.0, "no dip and no click where it is drawn out"
    pause = next(t for t in phones if t.phone.hold and t.phone.name == SILENCE)
    assert np.abs(pcm[pause.start + 5 * frame : pause.end - 2 * frame]).max() < 300


LONG = {
    "us1": (TEXTS["us1"] + "He said: go home, now! I never saw a thing like that, did you? ") * 3,
    "gr2": (TEXTS["gr2"] + "Είπε: πήγαινε σπίτι, τώρα! Δεν είδα ποτέ τέτοιο πράγμα, εσύ; ") * 3,
}


def planned(name: str, look_ahead: int = 1000) -> list[Utterance]:
    front = FrontEnd(voice(name).lang, Manner(look_ahead=look_ahead).of(voice(name)))
    return front.feed(LONG[name]) + front.end()


def sounds(phones: list[TimedPhone]) -> list[tuple[int, int, str]]:
    return [(t.start, t.end, t.phone.name) for t in phones]


Said = dict[tuple[str, int], tuple[Pcm, list[TimedPhone]]]
"""By voice and look-ahead."""


@pytest.fixture(scope="module")
def undisturbed() -> Said:
    """Each long text said by one process that never rests: its bytes are what everything is held to."""

    async def said(name: str, look_ahead: int) -> tuple[Pcm, list[TimedPhone]]:
        pool = MbrolaPool()
        synthesizer = await pool.acquire(voice(name))
        synthesizer._rest = lambda _: asyncio.sleep(3600)  # type: ignore[method-assign, assignment]
        try:
            pid = synthesizer._process.pid
            result = await spoken(synthesizer, planned(name, look_ahead))
            assert synthesizer._process.pid == pid
            return result
        finally:
            await synthesizer.aclose()
            await pool.aclose()

    return {(name, ahead): asyncio.run(said(name, ahead)) for name in LONG for ahead in LOOK_AHEAD}


LOOK_AHEAD = (1, 1000)


async def paced(
    pool: MbrolaPool, name: str, trouble: Callable[[MbrolaSynthesizer, random.Random], None], seed: int
) -> tuple[Pcm, list[TimedPhone]]:
    """The long text, word by word or phrase by phrase, with trouble at random and time to rest between."""
    rng = random.Random(seed)
    synthesizer = await pool.acquire(voice(name))
    pcm: list[Pcm] = []
    phones: list[TimedPhone] = []

    async def listen() -> None:
        async for speech in synthesizer.speech():
            check(speech, sum(map(len, pcm)), phones)
            pcm.append(speech.pcm)
            phones.extend(speech.phones)
            trouble(synthesizer, rng)

    listening = asyncio.create_task(listen())
    try:
        for u in planned(name, LOOK_AHEAD[seed % 2]):
            await synthesizer.write(u)
            trouble(synthesizer, rng)
            for _ in range(rng.choice([0, 0, 1, 5])):
                await asyncio.sleep(0)
            if rng.random() < 0.3:
                await asyncio.sleep(0.004)
        await synthesizer.finish()
        await asyncio.wait_for(listening, 20)
    finally:
        await synthesizer.aclose()
    return np.concatenate(pcm), phones


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", VOICES)
async def test_killed_anywhere_the_bytes_are_the_same(
    pool: MbrolaPool, name: str, seed: int, undisturbed: Said,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Also while it rests, just taken, just replaced, with nothing read or everything."""
    monkeypatch.setattr(mbrola, "MAX_RESTARTS", 1000)
    killed = []

    def kill(synthesizer: MbrolaSynthesizer, rng: random.Random) -> None:
        process = synthesizer._process
        if process and process.alive and rng.random() < 0.15:
            killed.append(process.pid)
            with suppress(ProcessLookupError):
                os.kill(process.pid, signal.SIGKILL)

    pcm, phones = await paced(pool, name, kill, seed)
    assert len(set(killed)) >= 3
    whole = undisturbed[name, LOOK_AHEAD[seed % 2]]
    assert pcm.tobytes() == whole[0].tobytes()
    assert sounds(phones) == sounds(whole[1])


@pytest.mark.parametrize("name", VOICES)
async def test_a_turn_that_rests_is_said_by_many_and_sounds_the_same(
    pool: MbrolaPool, name: str, undisturbed: Said
) -> None:
    """Other turns take the process meanwhile: each begins where the last one left it."""
    pids = set()
    others = [
        asyncio.create_task(paced(pool, name, lambda s, _: pids.add(s._process and s._process.pid), seed))
        for seed in range(5)
    ]
    for seed, (pcm, phones) in enumerate(await asyncio.gather(*others)):
        whole = undisturbed[name, LOOK_AHEAD[seed % 2]]
        assert pcm.tobytes() == whole[0].tobytes()
        assert sounds(phones) == sounds(whole[1])
    assert None in pids
    assert len(pids) > 2


async def test_a_turn_that_waits_for_text_holds_no_process() -> None:
    limits = Limits(most=1)
    pool = MbrolaPool(limits)
    utterances = [utterance("us1", 12, seed) for seed in range(2)]
    turns = [await asyncio.wait_for(pool.acquire(voice("us1")), 5) for _ in range(6)]
    done = await asyncio.gather(*(spoken(s, utterances) for s in turns))
    assert len({pcm.tobytes() for pcm, _ in done}) == 1
    for s in turns:
        await s.aclose()
    await pool.aclose()


@pytest.mark.parametrize("name", VOICES)
@pytest.mark.parametrize("at", [0.0, 0.4, 0.8])
async def test_one_that_hangs_is_replaced_without_a_gap(
    name: str,
    at: float,
    undisturbed: Said,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Stopped, it neither speaks nor reads; the lines do not drain in the end."""
    monkeypatch.setattr(mbrola_process, "HANG_S", 0.2)
    events: list[str] = []
    pool = MbrolaPool(on_event=events.append)
    whole, timed = undisturbed[name, 1000]
    stopped = []

    def stop(given: int) -> None:
        process = synthesizer._process
        if not stopped and given >= at * len(whole) and process:
            stopped.append(process.pid)
            os.kill(process.pid, signal.SIGSTOP)

    synthesizer = await pool.acquire(voice(name))
    if not at:
        stop(0)
    pcm, phones = await spoken(synthesizer, planned(name), stop)
    await synthesizer.aclose()
    await pool.aclose()
    assert pcm.tobytes() == whole.tobytes()
    assert sounds(phones) == sounds(timed)
    if at < 0.8:  # at the end nothing may be due any more
        assert (events.count("hang"), events.count("restart")) == (1, 1)


async def test_what_is_kept_to_be_said_again_is_bounded(pool: MbrolaPool) -> None:
    """A long turn at full speed, with a listener: only what was not said yet is remembered."""
    synthesizer = await pool.acquire(voice("us1"))
    listening = asyncio.create_task(_drained(synthesizer))
    longest = 0
    for seed in range(400):
        await synthesizer.write(utterance("us1", 20, seed))
        longest = max(longest, len(synthesizer._log))
    await synthesizer.finish()
    await asyncio.wait_for(listening, 10)
    await synthesizer.aclose()
    assert longest <= mbrola.MAX_LOG + 1


async def _drained(synthesizer: MbrolaSynthesizer) -> int:
    return sum([len(speech.pcm) async for speech in synthesizer.speech()])


async def test_a_machine_without_room_is_told_and_recovers(monkeypatch: pytest.MonkeyPatch) -> None:
    events: list[str] = []
    pool, start = MbrolaPool(on_event=events.append), asyncio.create_subprocess_exec

    async def refused(*_: Any, **__: Any) -> Any:
        raise OSError(errno.ENOMEM, "Cannot allocate memory")

    monkeypatch.setattr(asyncio, "create_subprocess_exec", refused)
    for _ in range(10):
        with pytest.raises(VoiceOverloaded, match="Cannot allocate"):
            await pool.acquire(voice("us1"))
    monkeypatch.setattr(asyncio, "create_subprocess_exec", start)
    pcm, _ = await turn(pool, "us1", [utterance("us1", 10, 1)])
    assert len(pcm)
    assert events.count("refused") == 10
    await pool.aclose()
