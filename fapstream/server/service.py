"""What all connections of a server share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

from fapstream.motion import Motion
from fapstream.ports import Clock, Meter, NoMeter, Synthesizer
from fapstream.tts import DEFAULT_LOOK_AHEAD, Manner
from fapstream.tts.voices import Voice


class Voices(Protocol):
    """The voices this server has."""

    def find(self, voice: str | None, lang: str | None) -> Voice:
        """The voice wished for. Raises UnknownVoice, UnknownLanguage, VoiceUnavailable."""

    def all(self) -> tuple[Voice, ...]:
        """Every voice that can speak here."""

    async def acquire(self, voice: Voice) -> Synthesizer:
        """Ready for one turn. Raises SynthesisError."""


@dataclass(frozen=True, slots=True)
class Service:
    """What all connections share."""

    voices: Voices
    clock: Clock
    heads: Callable[[], tuple[str, ...]]
    lang: str = "en"
    voice: str | None = None
    manner: Manner = field(default_factory=lambda: Manner(look_ahead=DEFAULT_LOOK_AHEAD))
    """How turns are read that do not say otherwise; its lexicon is for `lang` only."""
    motion: Motion = field(default_factory=Motion)
    """How faces move."""
    meter: Meter = field(default_factory=NoMeter)
    sent: Callable[[float, float], None] = lambda lateness_s, now: None
    """Told of every packet how long after it was due it left, and when."""
