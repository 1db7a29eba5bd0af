"""Recorded speech behind the Synthesizer port: what somebody said, with its phones where they were heard."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from dataclasses import dataclass
from pathlib import Path

from fapstream.adapters.aligner import Aligner as SphinxAligner
from fapstream.adapters.sound_file import read_sound, sound_rate
from fapstream.ports import Aligner
from fapstream.records import SILENCE, Heard, Pcm, Phone, Speech, TimedPhone, Utterance, Word
from fapstream.tts.cmu import from_cmu

RATES = (8000, 48_000)
ALIGNED_RATE = 16_000
PIECE_S = 0.5
"""Sound is given in pieces of this length."""


@dataclass(frozen=True, slots=True)
class Recording:
    """Sound, at `sample_rate`, and what is said in it."""

    pcm: Pcm
    sample_rate: int
    heard: Heard


def read_recording(path: Path, transcript: str | None, aligner: Aligner | None = None) -> Recording:
    """A file of English speech, put in step with its transcript; without one its words are recognised.

    It is played at the file's own rate, within what turns may have. Raises OSError, SpeechUnavailable,
    ClipError.
    """
    aligner = aligner or SphinxAligner()
    low, high = RATES
    sample_rate = min(max(sound_rate(path), low), high)
    plain = read_sound(path, ALIGNED_RATE)
    heard = aligner.recognise(plain) if transcript is None else aligner.align(plain, transcript)
    pcm = plain if sample_rate == ALIGNED_RATE else read_sound(path, sample_rate)
    return Recording(pcm, sample_rate, heard)


class RecordedVoice:
    """One turn that is a recording; its text is that of what was heard, fed as any text is."""

    def __init__(self, recording: Recording) -> None:
        self.sample_rate = recording.sample_rate
        self._pcm = recording.pcm
        self._heard = recording.heard
        self._words: dict[int, Word] = {}
        """The words of the text by where they begin."""
        self._complete = asyncio.Event()

    async def write(self, utterance: Utterance) -> None:
        """See the port: only the words are wanted."""
        self._words |= {word.start: word for word in utterance.words}

    async def flush(self) -> None:
        """See the port: a recording waits for nobody."""

    async def finish(self) -> None:
        """See the port."""
        self._complete.set()

    async def speech(self) -> AsyncIterator[Speech]:
        """See the port; from when the whole text is known."""
        await self._complete.wait()
        phones = self._phones()
        size = round(PIECE_S * self.sample_rate)
        told = 0
        for start in range(0, len(self._pcm), size):
            end = start + size if start + size < len(self._pcm) else len(self._pcm)
            upto = told
            while upto < len(phones) and phones[upto].start < end:
                upto += 1
            yield Speech(start, self._pcm[start:end], tuple(phones[told:upto]))
            told = upto

    async def aclose(self) -> None:
        """See the port."""

    def _phones(self) -> list[TimedPhone]:
        """Without gaps from the first sample to the last, which a pause ends."""
        found: list[TimedPhone] = []
        end = 0
        for heard in self._heard.words:
            word = self._words.get(heard.char_start) if heard.text else None
            for phone in heard.phones:
                start, end = end, min(max(end, round(phone.end_s * self.sample_rate)), len(self._pcm))
                name, stress = (SILENCE, 0) if phone.name == "SIL" else from_cmu(phone.name)
                found.append(TimedPhone(Phone(name, self._ms(start, end), stress=stress), start, end, word))
        if end < len(self._pcm) or not found or found[-1].phone.name != SILENCE:
            last = len(self._pcm)
            found.append(TimedPhone(Phone(SILENCE, self._ms(end, last)), end, last))
        return found

    def _ms(self, start: int, end: int) -> float:
        return 1000.0 * (end - start) / self.sample_rate
