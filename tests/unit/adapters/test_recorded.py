"""A recording as a voice: its sound is untouched, its phones are where they were heard."""

from __future__ import annotations

import itertools
import wave
from pathlib import Path

import numpy as np
import pytest

from fapstream.adapters.recorded import ALIGNED_RATE, RecordedVoice, Recording, read_recording
from fapstream.errors import ClipError
from fapstream.pipeline import Pipeline
from fapstream.records import (
    SILENCE,
    Heard,
    HeardPhone,
    HeardWord,
    Packet,
    Pcm,
    Speech,
    TimedPhone,
    TurnFormat,
)
from fapstream.talk import Talk
from fapstream.tts import FrontEnd

RATE = 24000
TEXT = "Hi, you."
HEARD = Heard(
    TEXT,
    (
        HeardWord("", 0.0, 0.2, (HeardPhone("SIL", 0.0, 0.2),)),
        HeardWord("hi", 0.2, 0.5, (HeardPhone("HH", 0.2, 0.3), HeardPhone("AY1", 0.3, 0.5)), 0, 2),
        HeardWord("", 0.5, 0.7, (HeardPhone("SIL", 0.5, 0.7),)),
        HeardWord("you", 0.7, 1.1, (HeardPhone("Y", 0.7, 0.8), HeardPhone("UW1", 0.8, 1.1)), 4, 7),
    ),
    0.0,
    1.0,
)


def sound(seconds: float = 1.4, rate: int = RATE) -> Pcm:
    return (np.arange(int(seconds * rate)) % 2000).astype(np.int16)


class FakeAligner:
    """Hears what it was told to; remembers what it was given."""

    def __init__(self) -> None:
        self.given: tuple[Pcm, str | None] | None = None

    def align(self, pcm: Pcm, transcript: str) -> Heard:
        self.given = pcm, transcript
        return HEARD

    def recognise(self, pcm: Pcm) -> Heard:
        self.given = pcm, None
        return HEARD


async def spoken(pcm: Pcm, heard: Heard = HEARD) -> list[Speech]:
    voice = RecordedVoice(Recording(pcm, RATE, heard))
    front = FrontEnd("en")
    for utterance in front.feed(heard.text) + front.end():
        await voice.write(utterance)
    await voice.finish()
    return [speech async for speech in voice.speech()]


async def test_the_sound_is_the_recording() -> None:
    pcm = sound()
    parts = await spoken(pcm)
    assert np.array_equal(np.concatenate([p.pcm for p in parts]), pcm)
    assert [p.start for p in parts] == list(np.cumsum([0, *(len(p.pcm) for p in parts[:-1])]))


async def test_phones_are_where_they_were_heard_and_belong_to_the_words_of_the_text() -> None:
    phones = [phone for part in await spoken(sound()) for phone in part.phones]
    assert [(p.phone.name, p.start / RATE, p.end / RATE) for p in phones] == [
        (SILENCE, 0.0, 0.2), ("h", 0.2, 0.3), ("AI", 0.3, 0.5), (SILENCE, 0.5, 0.7),
        ("j", 0.7, 0.8), ("u", 0.8, 1.1), (SILENCE, 1.1, 1.4),
    ]  # fmt: skip
    assert [p.phone.stress for p in phones] == [0, 0, 1, 0, 0, 1, 0]
    assert [p.text.text if p.text else None for p in phones] == [None, "Hi", "Hi", None, "you", "you", None]


async def test_no_phone_comes_after_the_sound_in_which_it_begins() -> None:
    for part in await spoken(sound()):
        assert all(part.start <= p.start < part.start + len(part.pcm) for p in part.phones)


@pytest.mark.parametrize("seconds", [0.3, 0.7, 1.0999, 1.1])
async def test_times_beyond_the_sound_end_with_it(seconds: float) -> None:
    pcm = sound(seconds)
    phones: list[TimedPhone] = [phone for part in await spoken(pcm) for phone in part.phones]
    assert phones[-1].end <= len(pcm)
    assert all(a.end == b.start for a, b in itertools.pairwise(phones))


async def test_a_talk_is_made_of_it() -> None:
    """Packets with the recording's sound, the face to it, and words and captions when they are heard."""
    turn = TurnFormat(1, "recorded", "en", RATE, 25)
    talk = Talk(Pipeline(turn, FrontEnd("en"), 1), RecordedVoice(Recording(sound(), RATE, HEARD)), None)
    talk.feed(TEXT)
    talk.end()
    packets: list[Packet] = [packet async for packet in talk.packets()]
    await talk.aclose()
    assert sum(len(p.pcm) for p in packets) == int(1.4 * RATE)
    marks = [mark for p in packets for mark in p.marks]
    assert [(m.text, m.sample / RATE) for m in marks if m.kind == "word"] == [("Hi", 0.2), ("you", 0.7)]
    assert [m.text for m in marks if m.kind == "caption"] == ["Hi,", "you."]
    assert len([f for p in packets for f in p.frames]) == 35


@pytest.mark.parametrize("rate", [8000, 16000, 24000, 44100, 96000])
def test_a_file_is_heard_at_the_aligners_rate_and_played_at_its_own(tmp_path: Path, rate: int) -> None:
    path = tmp_path / "talk.wav"
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(rate)
        file.writeframes(sound(1.0, rate).tobytes())
    aligner = FakeAligner()
    recording = read_recording(path, TEXT, aligner)
    assert recording.sample_rate == min(rate, 48000)
    assert len(recording.pcm) == pytest.approx(recording.sample_rate, abs=2)
    assert aligner.given is not None
    assert len(aligner.given[0]) == pytest.approx(ALIGNED_RATE, abs=2)
    assert aligner.given[1] == TEXT
    read_recording(path, None, aligner)
    assert aligner.given[1] is None


def test_what_is_no_sound_is_refused(tmp_path: Path) -> None:
    (tmp_path / "talk.wav").write_bytes(b"RIFF nothing")
    with pytest.raises(ClipError, match=r"talk\.wav"):
        read_recording(tmp_path / "talk.wav", TEXT, FakeAligner())
