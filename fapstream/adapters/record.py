"""A Synthesizer that passes everything on and writes down what the voice was asked to say."""

from __future__ import annotations

from collections.abc import AsyncIterator

from fapstream.ports import Synthesizer
from fapstream.records import SILENCE, Speech, Utterance
from fapstream.tts import Voice, VoicePhone, pho, realise


class PhoRecorder:
    """`lines` holds the turn in MBROLA's .pho notation, in the voice's own phones.

    For voices that are not MBROLA's the phones are the language's.
    """

    def __init__(self, inner: Synthesizer, voice: Voice) -> None:
        self.sample_rate = inner.sample_rate
        self.lines: list[str] = []
        self._inner = inner
        self._voice = voice
        self._last_name = SILENCE

    async def write(self, utterance: Utterance) -> None:
        """See the port."""
        if self._voice.engine == "mbrola":
            phones = realise(utterance.phones, self._voice, self._last_name)
            self._last_name = phones[-1].name if phones else self._last_name
        else:
            phones = [
                VoicePhone(p.name, max(1, round(p.duration_ms * self.sample_rate / 1000)),
                           p.pitch or ((0.0, self._voice.f0_hz),), ())
                for p in utterance.phones
            ]  # fmt: skip
        self.lines.append(pho.lines(phones, self.sample_rate))
        await self._inner.write(utterance)

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
