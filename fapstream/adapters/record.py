"""A Synthesizer that passes everything on and writes down what the voice was asked to say."""

from __future__ import annotations

from collections.abc import AsyncIterator

from fapstream.ports import Synthesizer
from fapstream.records import Phone, Speech, Utterance
from fapstream.tts import pho
from fapstream.tts.pho import Realiser
from fapstream.tts.realise import VoicePhone
from fapstream.tts.voices import Voice


class PhoRecorder:
    """`lines` holds the turn in MBROLA's .pho notation, in the voice's own phones.

    For voices that are not MBROLA's the phones are the language's.
    """

    def __init__(self, inner: Synthesizer, voice: Voice) -> None:
        self.sample_rate = inner.sample_rate
        self.lines: list[str] = []
        self._inner = inner
        self._voice = voice
        self._realiser = Realiser(voice)

    async def write(self, utterance: Utterance) -> None:
        """See the port."""
        if self._voice.engine == "mbrola":
            self.lines.append(self._realiser.write(utterance).lines)
        else:
            plain = [self._plain(phone) for phone in utterance.phones]
            self.lines.append(pho.lines(plain, self.sample_rate))
        await self._inner.write(utterance)

    def _plain(self, phone: Phone) -> VoicePhone:
        samples = max(1, round(phone.duration_ms * self.sample_rate / 1000))
        return VoicePhone(phone.name, samples, phone.pitch or ((0.0, self._voice.f0_hz),), ())

    async def flush(self) -> None:
        """See the port."""
        await self._inner.flush()

    async def finish(self) -> None:
        """See the port."""
        await self._inner.finish()

    def speech(self) -> AsyncIterator[Speech]:
        """See the port."""
        return self._inner.speech()

    async def aclose(self) -> None:
        """See the port."""
        await self._inner.aclose()
