"""The program itself: what it owes, what it keeps back, and that one which hangs is ended."""

from __future__ import annotations

import asyncio
import os
import shutil
import signal

import pytest

from fapstream.adapters import mbrola_process
from fapstream.adapters.mbrola_process import MbrolaProcess
from fapstream.records import SILENCE
from fapstream.tts import pho
from fapstream.tts.realise import Join, realise
from fapstream.tts.voices import voice
from tests.unit.adapters.test_mbrola import VOICES, utterance

pytestmark = pytest.mark.skipif(shutil.which("mbrola") is None, reason="MBROLA is not installed")


@pytest.mark.parametrize("n", [100, 1000, 5000])
@pytest.mark.parametrize("name", VOICES)
async def test_the_program_owes_less_than_a_period_for_ever(name: str, n: int) -> None:
    """0 <= sum n_i - emitted < P, counted at the program's own pipe after every flush."""
    v = voice(name)
    process = await MbrolaProcess.start(v)
    try:
        previous = SILENCE
        for k in range(n // 50):
            u = utterance(name, 49, seed=k)
            phones = realise(u.phones, v, Join(previous))
            previous = phones[-1].name
            await process.write(pho.lines(phones, v.sample_rate), sum(p.n_samples for p in phones))
            await process.write("#\n", 0)
            while process.written - process.read >= v.period:
                assert await asyncio.wait_for(process.pcm(), 5) is not None
            assert 0 <= process.written - process.read < v.period
    finally:
        await process.aclose()


def lines(name: str, n: int, seed: int) -> tuple[str, int]:
    phones = realise(utterance(name, n, seed).phones, voice(name))
    return pho.lines(phones, voice(name).sample_rate) + pho.FLUSH, sum(p.n_samples for p in phones)


async def said(process: MbrolaProcess, name: str, seed: int) -> bytes:
    """A phrase, all of it but what is kept back."""
    text, samples = lines(name, 12, seed)
    await process.write(text, samples, voice(name).period)
    out = b""
    while process.owed >= voice(name).period:
        pcm = await asyncio.wait_for(process.pcm(), 5)
        assert pcm is not None
        out += pcm.tobytes()
    return out


@pytest.mark.parametrize("name", VOICES)
async def test_renewed_to_any_remainder_it_goes_on_with_the_same_bytes(name: str) -> None:
    """What a process gives after a flush depends on how many samples it keeps back, and on nothing else."""
    steady, other = await MbrolaProcess.start(voice(name)), await MbrolaProcess.start(voice(name))
    remainders = set()
    for seed in range(25):
        remainder = steady.owed
        remainders.add(remainder)
        await other.renew(voice(name), remainder)
        while other.owed >= voice(name).period:
            await asyncio.wait_for(other.pcm(), 5)
        assert other.owed == remainder
        assert await said(steady, name, seed) == await said(other, name, seed)
        await said(other, name, 100 + seed)
    assert len(remainders) > 10
    for process in (steady, other):
        await process.aclose()


@pytest.mark.parametrize("name", VOICES)
async def test_one_that_is_stopped_is_killed(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mbrola_process, "HANG_S", 0.1)
    events: list[str] = []
    process = await MbrolaProcess.start(voice(name), events.append)
    await said(process, name, 1)
    os.kill(process.pid, signal.SIGSTOP)
    text, samples = lines(name, 12, 2)
    await process.write(text, samples, voice(name).period)
    async with asyncio.timeout(5):
        while await process.pcm() is not None:
            pass
        await process.aclose()
    assert events == ["hang"]
    assert not process.alive


@pytest.mark.parametrize("name", VOICES)
async def test_one_that_owes_nothing_is_left_alone(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """An open phrase, of which it keeps the last phones back; and one that has said everything."""
    monkeypatch.setattr(mbrola_process, "HANG_S", 0.02)
    events: list[str] = []
    process = await MbrolaProcess.start(voice(name), events.append)
    await said(process, name, 1)
    phones = realise(utterance(name, 12, 3, closed=False).phones, voice(name))
    tail = sum(p.n_samples for p in phones[-3:]) + voice(name).period
    total = sum(p.n_samples for p in phones)
    await process.write(pho.lines(phones, voice(name).sample_rate), total, tail)
    while process.owed > tail:
        assert await asyncio.wait_for(process.pcm(), 5) is not None
    await asyncio.sleep(0.1)
    assert events == []
    assert process.alive
    await process.aclose()


async def test_worn_by_use(monkeypatch: pytest.MonkeyPatch) -> None:
    process = await MbrolaProcess.start(voice("us1"))
    assert not process.worn
    monkeypatch.setattr(mbrola_process, "MAX_BYTES", 1000)
    assert process.worn or not os.path.exists("/proc/self/statm")
    monkeypatch.undo()
    monkeypatch.setattr(mbrola_process, "MAX_TURNS", 1)
    await process.renew(voice("us1"))
    assert process.worn
    await process.aclose()
