"""A voice that times its phones itself."""

from __future__ import annotations

import asyncio
import base64
import json
import sys
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.adapters.timed import MAX_LINE, TimedVoice
from fapstream.errors import SynthesisError, VoiceUnavailable
from fapstream.records import SILENCE, Speech, Utterance
from fapstream.tts import FrontEnd, Manner

PROGRAM = Path(__file__).parents[2] / "e2e" / "sine_voice.py"
RATE = 16000


def pcm(n: int, value: int = 1000) -> dict[str, str]:
    return {"pcm": base64.b64encode(np.full(n, value, "<i2").tobytes()).decode()}


def phone(name: str, start: float, duration: float) -> dict[str, Any]:
    return {"phone": name, "start": start, "duration": duration}


def written(path: Path, *rows: object) -> Path:
    path.write_text("\n".join(json.dumps(r) for r in ({"sample_rate": RATE}, *rows)) + "\n")
    return path


def planned(text: str, look_ahead: int = 0) -> list[Utterance]:
    front = FrontEnd("en", Manner(look_ahead=look_ahead))
    return front.feed(text) + front.end()


async def heard(voice: TimedVoice, utterances: list[Utterance]) -> list[Speech]:
    for u in utterances:
        await voice.write(u)
    await voice.finish()
    try:
        return [s async for s in voice.speech()]
    finally:
        await voice.aclose()


async def test_a_file_with_phones_and_sound(tmp_path: Path) -> None:
    rows = [
        phone("h", 0.0, 0.05),
        phone("@", 0.05, 0.05),
        pcm(1600),
        phone("l", 0.1, 0.05),
        phone("@U", 0.15, 0.1),
        pcm(2400, 2000),
        phone("_", 0.3, 0.1),
        pcm(2400, 0),
    ]
    voice = await TimedVoice.read(written(tmp_path / "a.jsonl", *rows), "en")
    assert voice.sample_rate == RATE
    speech = await heard(voice, planned("Hello."))
    assert [(s.start, len(s.pcm)) for s in speech] == [(0, 1600), (1600, 2400), (4000, 2400)]
    phones = [p for s in speech for p in s.phones]
    assert [(p.phone.name, p.start, p.end) for p in phones] == [
        ("h", 0, 800),
        ("@", 800, 1600),
        ("l", 1600, 2400),
        ("@U", 2400, 4000),
        ("_", 4000, 4800),
        ("_", 4800, 6400),
    ]
    assert [p.text.text if p.text else None for p in phones] == ["Hello"] * 4 + [None] * 2
    assert phones[3].phone.stress == 1, "what was planned of a phone goes with it"
    assert phones[3].phone.duration_ms == pytest.approx(100)


async def test_phones_that_were_not_planned_or_are_left_out(tmp_path: Path) -> None:
    rows = [phone("h", 0, 0.1), phone("l", 0.1, 0.1), phone("z", 0.2, 0.1), phone("@U", 0.3, 0.1), pcm(6400)]
    voice = await TimedVoice.read(written(tmp_path / "a.jsonl", *rows), "en")
    (speech,) = await heard(voice, planned("Hello."))
    assert [(p.phone.name, p.text.text if p.text else None) for p in speech.phones] == [
        ("h", "Hello"),
        ("l", "Hello"),
        ("z", None),
        ("@U", "Hello"),
    ]


@pytest.mark.parametrize(
    ("row", "reason"),
    [
        ("{", "not a line of JSON"),
        ("[1]", "not an object"),
        ('{"phone": "q9", "start": 0, "duration": 1}', "there are"),
        ('{"phone": "h", "start": -1, "duration": 1}', "start is -1"),
        ('{"phone": "h", "start": 0}', "duration is None"),
        ('{"phone": "h", "start": 0, "duration": NaN}', "duration is nan"),
        ('{"phone": "h", "start": true}', "start"),
        ('{"pcm": "!"}', "base64"),
        ('{"pcm": "AAAA"}', "no int16"),
        ('{"pcm": 5}', "base64"),
        ("[" * 5000, "JSON"),
        ('{"x": "' + "y" * MAX_LINE + '"}', "more than"),
    ],
)
async def test_bad_lines_are_named(tmp_path: Path, row: str, reason: str) -> None:
    path = tmp_path / "bad.jsonl"
    path.write_text('{"sample_rate": 16000}\n' + row + "\n")
    voice = await TimedVoice.read(path, "en")
    with pytest.raises(SynthesisError, match=reason) as caught:
        await heard(voice, [])
    assert "bad.jsonl, line 2" in str(caught.value)


@pytest.mark.parametrize(
    "first", ["", "{}", '{"sample_rate": 1}', '{"sample_rate": "16000"}', '{"sample_rate": 1e4}']
)
async def test_the_first_line_says_the_rate(tmp_path: Path, first: str) -> None:
    path = tmp_path / "a.jsonl"
    path.write_text(first)
    with pytest.raises(SynthesisError, match="line 1"):
        await TimedVoice.read(path, "en")


@settings(max_examples=60, deadline=None)
@given(
    st.lists(
        st.binary(max_size=60)
        | st.sampled_from([b'{"pcm": ""}', b'{"phone": "h", "start": 0, "duration": 1}']),
        max_size=8,
    )
)
def test_any_lines_are_speech_or_a_typed_error(rows: list[bytes]) -> None:
    async def lines() -> AsyncIterator[bytes]:
        for row in rows:
            yield row

    async def run() -> None:
        try:
            await heard(TimedVoice(lines(), "x", "en", RATE), [])
        except SynthesisError:
            return

    asyncio.run(run())


async def test_a_program_speaks_as_it_is_told() -> None:
    voice = await TimedVoice.run(f"{sys.executable} {PROGRAM}", "en")
    utterances = planned("Hello world, it is late.")
    speech = await heard(voice, utterances)
    phones = [p for s in speech for p in s.phones]
    wished = [p for u in utterances for p in u.phones]
    assert [p.phone.name for p in phones] == [p.name for p in wished]
    for timed, wish in zip(phones, wished, strict=True):
        assert (timed.end - timed.start) / voice.sample_rate == pytest.approx(
            wish.duration_ms / 1000, abs=2e-4
        )
    assert sum(len(s.pcm) for s in speech) == phones[-1].end
    assert {p.text.text for p in phones if p.text} == {"Hello", "world", "it", "is", "late"}
    loud = [np.abs(np.concatenate([s.pcm for s in speech])[p.start : p.end]).max(initial=0) for p in phones]
    assert all((level > 0) == (p.phone.name != SILENCE) for level, p in zip(loud, phones, strict=True))


@pytest.mark.parametrize(
    ("command", "reason"),
    [
        ("no-such-program-at-all", "cannot be run"),
        ("'", "cannot be run"),
        ("true", "line 1"),
        ("echo hello", "JSON"),
    ],
)
async def test_programs_that_are_none(command: str, reason: str) -> None:
    with pytest.raises(SynthesisError, match=reason):
        await TimedVoice.run(command, "en")
    assert issubclass(VoiceUnavailable, SynthesisError)


async def test_a_program_that_fails_is_told() -> None:
    code = "print('{\"sample_rate\": 16000}', flush=True); input(); raise SystemExit(3)"
    voice = await TimedVoice.run(f'{sys.executable} -c "{code.replace(chr(34), chr(92) + chr(34))}"', "en")
    with pytest.raises(SynthesisError, match="status 3"):
        await heard(voice, planned("Hello."))
