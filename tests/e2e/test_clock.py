"""One phoneme clock: real MBROLA, thousands of phones, marks held against the sound itself."""

from __future__ import annotations

import random

import numpy as np
import pytest
from numpy.typing import NDArray

from fapstream.adapters.mbrola import MbrolaPool
from fapstream.records import SILENCE, Phone, TimedPhone, Utterance
from fapstream.tts import phone_set
from fapstream.tts.voices import voice
from tests.e2e.boundaries import level_db

BLOCKS = 200
PHONES_A_BLOCK = 21


def block(rng: random.Random, names: list[str], lang: str) -> Utterance:
    """Random phones, then the marker: a vowel alone between two silences."""
    chosen = [
        Phone(rng.choice(names), rng.uniform(40, 180), ((0.0, rng.uniform(80, 220)),))
        for _ in range(PHONES_A_BLOCK)
    ]
    marker = Phone("A" if lang == "en" else "a", 200.0, ((0.0, 120.0),))
    return Utterance(lang, (*chosen, Phone(SILENCE, 200.0), marker, Phone(SILENCE, 300.0)))


async def speak(name: str, utterances: list[Utterance]) -> tuple[NDArray[np.int16], list[TimedPhone]]:
    pool = MbrolaPool()
    synthesizer = await pool.acquire(voice(name))
    sound: list[NDArray[np.int16]] = []
    phones: list[TimedPhone] = []
    for utterance in utterances:
        await synthesizer.write(utterance)
    await synthesizer.finish()
    async for speech in synthesizer.speech():
        sound.append(speech.pcm)
        phones += speech.phones
    await synthesizer.aclose()
    await pool.aclose()
    return np.concatenate(sound), phones


@pytest.mark.parametrize("name", ["us1", "en1", "gr1", "gr2"])
async def test_marks_do_not_drift(name: str) -> None:
    """The offset between marks and onsets heard changes by less than 1 ms per 1000 phones, over 4800."""
    chosen = voice(name)
    rng = random.Random(7)
    names = [p for p in phone_set(chosen.lang) if p != SILENCE]
    pcm, phones = await speak(name, [block(rng, names, chosen.lang) for _ in range(BLOCKS)])
    assert len(phones) == BLOCKS * (PHONES_A_BLOCK + 3)
    level = level_db(pcm, chosen.sample_rate, 90, 7000)
    index, offset_ms = [], []
    for i, timed in enumerate(phones):
        before = phones[i - 1].phone.name if i else ""
        if before == SILENCE and i + 1 < len(phones) and phones[i + 1].phone.name == SILENCE:
            start, end = timed.start - chosen.sample_rate // 20, (timed.start + timed.end) // 2
            part = level[start:end]
            onset = start + int(np.argmax(part >= (part.min() + part.max()) / 2))
            index.append(i)
            offset_ms.append(1000 * (onset - timed.start) / chosen.sample_rate)
    assert len(index) == BLOCKS
    slope_per_1000 = 1000 * np.polyfit(index, offset_ms, 1)[0]
    assert abs(slope_per_1000) < 1.0
    assert abs(np.median(offset_ms)) < 15.0
    print(f"{name}: {slope_per_1000:+.3f} ms per 1000 phones, median offset {np.median(offset_ms):+.2f} ms")
