"""eSpeak NG as it is, in its worker process: phones in order over all of the sound, pauses to the sample."""

from __future__ import annotations

import asyncio
import os
import signal
from collections.abc import AsyncIterator
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from fapstream.adapters import espeak
from fapstream.adapters.espeak import EspeakPool, EspeakProcess, EspeakSynthesizer, split_at_pauses
from fapstream.adapters.spares import Limits
from fapstream.errors import SynthesisError, VoiceUnavailable
from fapstream.records import SILENCE, Pcm, Phone, TimedPhone, Utterance
from fapstream.tts import FrontEnd, Manner
from fapstream.tts.voices import voice

pytestmark = pytest.mark.skipif(not espeak.installed(), reason="the extra `espeak` is not installed")

TEXTS = {
    "en": "Hello world, it is nine. A stitch in time \\:)250 saves nine!",
    "el": "Καλημέρα κόσμε, τι κάνεις; Έλα \\:)250 τώρα.",
}


@pytest.fixture
async def pool() -> AsyncIterator[EspeakPool]:
    made = EspeakPool()
    yield made
    await made.aclose()


def planned(lang: str) -> list[Utterance]:
    front = FrontEnd(lang)
    return front.feed(TEXTS[lang]) + front.end()


async def spoken(synthesizer: EspeakSynthesizer, utterances: list[Utterance]) -> tuple[Pcm, list[TimedPhone]]:
    for u in utterances:
        await synthesizer.write(u)
    await synthesizer.finish()
    pcm: list[Pcm] = []
    phones: list[TimedPhone] = []
    async for speech in synthesizer.speech():
        assert speech.start == sum(map(len, pcm))
        assert all(speech.start <= t.start <= t.end <= speech.start + len(speech.pcm) for t in speech.phones)
        pcm.append(speech.pcm)
        phones += speech.phones
    return np.concatenate(pcm or [np.zeros(0, np.int16)]), phones


async def turn(pool: EspeakPool, lang: str, utterances: list[Utterance]) -> tuple[Pcm, list[TimedPhone]]:
    synthesizer = await pool.acquire(voice(f"espeak-{lang}"))
    try:
        return await spoken(synthesizer, utterances)
    finally:
        await synthesizer.aclose()


@pytest.mark.parametrize("lang", ["en", "el"])
async def test_phones_cover_the_sound(pool: EspeakPool, lang: str) -> None:
    utterances = planned(lang)
    pcm, phones = await turn(pool, lang, utterances)
    assert [t.phone for t in phones] == [p for u in utterances for p in u.phones]
    assert phones[0].start == 0
    assert phones[-1].end == len(pcm)
    assert all(a.end == b.start for a, b in pairwise(phones))
    words = [w.text for u in utterances for w in u.words]
    assert list(dict.fromkeys(t.text.text for t in phones if t.text)) == list(dict.fromkeys(words))


@pytest.mark.parametrize("lang", ["en", "el"])
async def test_pauses_are_silent_and_exact(pool: EspeakPool, lang: str) -> None:
    pcm, phones = await turn(pool, lang, planned(lang))
    pauses = [t for t in phones if t.phone.name == SILENCE]
    assert len(pauses) >= 4
    for t in pauses:
        assert t.end - t.start == round(t.phone.duration_ms * 22050 / 1000)
        assert not pcm[t.start : t.end].any()
    assert any(t.phone.expression == "joy" and t.end - t.start == round(0.25 * 22050) for t in pauses)


@pytest.mark.parametrize("lang", ["en", "el"])
async def test_phones_last_a_while_and_vowels_sound(pool: EspeakPool, lang: str) -> None:
    pcm, phones = await turn(pool, lang, planned(lang))
    sounding = [t for t in phones if t.phone.name != SILENCE]
    long_enough = sum(t.end - t.start >= 0.015 * 22050 for t in sounding)
    assert long_enough >= 0.9 * len(sounding)
    stressed = [t for t in sounding if t.phone.stress == 1]
    assert stressed
    assert all(np.abs(pcm[t.start : t.end]).max(initial=0) > 2000 for t in stressed)


async def test_a_killed_worker_says_the_phrase_again(pool: EspeakPool) -> None:
    utterances = planned("en")
    whole, phones = await turn(pool, "en", utterances)
    synthesizer = await pool.acquire(voice("espeak-en"))
    os.kill(synthesizer._process._process.pid, signal.SIGKILL)
    again, same = await spoken(synthesizer, utterances)
    await synthesizer.aclose()
    assert np.array_equal(again, whole)
    assert same == phones


async def test_a_worker_that_keeps_dying_ends_the_turn(
    pool: EspeakPool, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def speak(self: EspeakProcess, request: object) -> object:
        os.kill(self._process.pid, signal.SIGKILL)
        await self._process.wait()
        raise SynthesisError("eSpeak NG ended in the middle of a phrase")

    monkeypatch.setattr(EspeakProcess, "speak", speak)
    synthesizer = await pool.acquire(voice("espeak-en"))
    with pytest.raises(SynthesisError, match="ended in the middle"):
        await spoken(synthesizer, planned("en"))
    await synthesizer.aclose()


async def test_a_bad_voice_is_a_typed_error_and_spoils_nothing(pool: EspeakPool) -> None:
    nobody = replace(voice("espeak-en"), engine_voice="no-such-voice")
    synthesizer = await pool.acquire(nobody)
    with pytest.raises(SynthesisError, match="no-such-voice"):
        await spoken(synthesizer, planned("en"))
    await synthesizer.aclose()
    pcm, _ = await turn(pool, "en", planned("en"))
    assert len(pcm)


async def test_turns_follow_each_other_on_one_worker(pool: EspeakPool) -> None:
    first = await pool.acquire(voice("espeak-en"))
    process = first._process
    one = await spoken(first, planned("en"))
    await first.aclose()
    await first.aclose()
    second = await pool.acquire(voice("espeak-el"))
    assert second._process is process
    other = await pool.acquire(voice("espeak-en"))
    assert other._process is not process, "a voice closed twice is still only one voice"
    await other.aclose()
    await spoken(second, planned("el"))
    await second.aclose()
    again, phones = await turn(pool, "en", planned("en"))
    assert len(again) == pytest.approx(len(one[0]), abs=32), "it is not exact to the sample"
    assert [t.phone for t in phones] == [t.phone for t in one[1]]


async def test_left_in_the_middle_the_worker_is_not_used_again(pool: EspeakPool) -> None:
    synthesizer = await pool.acquire(voice("espeak-en"))
    process = synthesizer._process
    await synthesizer.write(planned("en")[0])
    speech = synthesizer.speech()
    await anext(speech)
    listening = asyncio.ensure_future(anext(speech))
    await asyncio.sleep(0)
    listening.cancel()
    await asyncio.gather(listening, return_exceptions=True)
    await synthesizer.aclose()
    assert not process.alive


async def test_a_flush_closes_an_open_phrase(pool: EspeakPool) -> None:
    synthesizer = await pool.acquire(voice("espeak-en"))
    [open_one] = FrontEnd("en", Manner(look_ahead=0)).feed("one two ")
    await synthesizer.write(open_one)
    await synthesizer.flush()
    await synthesizer.flush()
    _, phones = await spoken(synthesizer, [])
    await synthesizer.aclose()
    assert [t.phone.name for t in phones][-1] == SILENCE
    assert [t.phone for t in phones][:-1] == list(open_one.phones)


async def test_nothing_to_say(pool: EspeakPool) -> None:
    assert len((await turn(pool, "en", []))[0]) == 0
    assert len((await turn(pool, "en", [Utterance("en", ())]))[0]) == 0


async def test_a_missing_extra_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(espeak, "installed", lambda: False)
    with pytest.raises(VoiceUnavailable, match=r"fapstream\[espeak\]"):
        await EspeakPool().acquire(voice("espeak-en"))


def test_split_at_pauses() -> None:
    a, b, pause = Phone("a", 1.0), Phone("b", 1.0), Phone(SILENCE, 1.0)
    assert split_at_pauses([]) == []
    assert split_at_pauses([pause, a, b, pause, pause, a]) == [[pause], [a, b], [pause], [pause], [a]]


async def test_a_worker_that_hangs_is_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(espeak, "HANG_S", 0.3)
    events: list[str] = []
    pool = EspeakPool(on_event=events.append)
    whole, phones = await turn(pool, "en", planned("en"))
    synthesizer = await pool.acquire(voice("espeak-en"))
    os.kill(synthesizer._process._process.pid, signal.SIGSTOP)
    monkeypatch.setattr(espeak, "HANG_S", 5.0 if len(events) > 1 else 0.3)
    try:
        again, same = await spoken(synthesizer, planned("en"))
    finally:
        await synthesizer.aclose()
        await pool.aclose()
    assert events[:3] == ["start", "hang", "restart"]
    assert len(again) == pytest.approx(len(whole), abs=32)
    assert [t.phone for t in same] == [t.phone for t in phones]


async def test_a_turn_that_waits_for_text_holds_no_worker() -> None:
    pool = EspeakPool(Limits(most=1))
    turns = [await asyncio.wait_for(pool.acquire(voice("espeak-en")), 5)]
    speaking = asyncio.create_task(anext(turns[0].speech(), None))
    turns.append(await asyncio.wait_for(pool.acquire(voice("espeak-en")), 5))
    assert turns[0]._process is None
    await turns[0].finish()
    assert await speaking is None
    for synthesizer in turns:
        await synthesizer.aclose()
    await pool.aclose()


async def test_the_writer_waits_while_a_listener_has_enough(pool: EspeakPool) -> None:
    synthesizer = await pool.acquire(voice("espeak-en"))
    speech = synthesizer.speech()
    await synthesizer.write(planned("en")[0])
    await anext(speech)

    async def write() -> None:
        for _ in range(50):
            for u in planned("en"):
                await synthesizer.write(u)
        await synthesizer.finish()

    writing = asyncio.create_task(write())
    for _ in range(20):
        await asyncio.sleep(0)
    assert len(synthesizer._todo) <= espeak.MAX_TODO + 1
    writing.cancel()
    await asyncio.gather(writing, return_exceptions=True)
    await synthesizer.aclose()
