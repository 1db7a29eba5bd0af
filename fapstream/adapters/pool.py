"""All voices of this machine behind one door."""

from __future__ import annotations

from fapstream.adapters.espeak import EspeakPool
from fapstream.adapters.espeak import installed as espeak_installed
from fapstream.adapters.mbrola import MbrolaPool
from fapstream.adapters.mbrola_process import database
from fapstream.adapters.spares import Budget, Limits, OnEvent, ignore
from fapstream.errors import UnknownLanguage, VoiceUnavailable
from fapstream.ports import Synthesizer
from fapstream.tts import LANGUAGES
from fapstream.tts.voices import Voice, default_voice, voice, voices

MOST_PROGRAMS = 256
"""Of all voices together, in one pool."""


def installed(candidate: Voice) -> bool:
    """Whether this machine can speak with a voice."""
    return espeak_installed() if candidate.engine == "espeak" else database(candidate) is not None


class VoicePool:
    """Finds voices by wish and hands them out warm; eSpeak NG serves where MBROLA is missing."""

    def __init__(
        self, limits: Limits | None = None, most: int = MOST_PROGRAMS, on_event: OnEvent = ignore
    ) -> None:
        """`limits`: of the programs of one voice; `most`: programs of all voices together. `on_event` is told
        `start`, `refused`, `wait` (see spares), `hang` and `restart`."""
        budget = Budget(most, on_event=on_event)
        self._mbrola = MbrolaPool(limits, budget, on_event)
        self._espeak = EspeakPool(limits, budget, on_event)
        here = (v for v in voices() if installed(v))
        self._installed = tuple(sorted(here, key=lambda v: v != default_voice(v.lang)))

    def all(self) -> tuple[Voice, ...]:
        """Every voice that can speak here, the preferred one of each language first."""
        return self._installed

    def find(self, name: str | None, lang: str | None) -> Voice:
        """The voice called `name`, or the preferred one of `lang`.

        Raises UnknownVoice, UnknownLanguage, VoiceUnavailable.
        """
        if name is not None:
            found = voice(name)
            if found not in self._installed:
                raise VoiceUnavailable(f"the voice {name} is not installed on this machine")
            return found
        code = (lang or LANGUAGES[0]).partition("-")[0].lower()
        if code not in LANGUAGES:
            raise UnknownLanguage(code, LANGUAGES)
        for candidate in self.all():
            if candidate.lang == code:
                return candidate
        raise VoiceUnavailable(
            f"no voice for {code!r} is installed: install MBROLA, or the extra fapstream[espeak]"
        )

    async def warm(self, candidate: Voice) -> None:
        """Start the voice's program, so that its first turn need not wait."""
        if candidate.engine == "mbrola":
            await self._mbrola.warm(candidate)
        else:
            await self._espeak.warm()

    async def acquire(self, candidate: Voice) -> Synthesizer:
        """Ready for one turn. Raises SynthesisError."""
        if candidate.engine == "mbrola":
            return await self._mbrola.acquire(candidate)
        return await self._espeak.acquire(candidate)

    async def aclose(self) -> None:
        """End every program."""
        await self._mbrola.aclose()
        await self._espeak.aclose()
