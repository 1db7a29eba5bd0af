"""What a voice was asked to say, as .pho, while everything passes through."""

from __future__ import annotations

import pytest

from fapstream.adapters.record import PhoRecorder
from fapstream.records import SILENCE, Phone, Utterance
from fapstream.tts import FrontEnd, pho
from fapstream.tts.voices import voice
from tests.unit.fakes import FakeVoice


def planned() -> list[Utterance]:
    front = FrontEnd("en")
    return front.feed("Hello there. Water boils. ") + front.end()


async def test_everything_passes_through() -> None:
    inner = FakeVoice(16000)
    recorder = PhoRecorder(inner, voice("us1"))
    assert recorder.sample_rate == 16000
    for u in planned():
        await recorder.write(u)
    await recorder.flush()
    await recorder.finish()
    assert inner.written[:-1] == planned()
    assert inner.flushes == 1
    assert (await anext(recorder.speech())).start == 0
    await recorder.aclose()
    assert inner.closes == 1


async def test_the_lines_are_those_of_the_voice() -> None:
    recorder = PhoRecorder(FakeVoice(16000), voice("us1"))
    for u in planned():
        await recorder.write(u)
    lines = pho.parse("".join(recorder.lines))
    assert {line.name for line in lines} <= voice("us1").inventory
    wished = sum(p.duration_ms for u in planned() for p in u.phones)
    assert sum(line.duration_ms for line in lines) == pytest.approx(wished, abs=0.1 * len(lines))
    assert all(line.pitch for line in lines)


async def test_other_voices_are_written_in_the_languages_own_phones() -> None:
    recorder = PhoRecorder(FakeVoice(22050), voice("espeak-en"))
    phones = (Phone("h", 50.0), Phone("@U", 120.4, ((0.0, 110.0), (50.0, 120.0))), Phone(SILENCE, 0.0))
    await recorder.write(Utterance("en", phones))
    lines = pho.parse("".join(recorder.lines))
    assert [line.name for line in lines] == ["h", "@U", "_"]
    assert [round(line.duration_ms) for line in lines] == [50, 120, 0]
    assert lines[1].pitch == ((0.0, 110.0), (50.0, 120.0))
