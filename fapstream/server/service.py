"""What all connections of a server share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal, Protocol

from fapstream import __version__
from fapstream.motion import Motion
from fapstream.ports import Clock, Meter, NoMeter, Synthesizer
from fapstream.protocol import generated as g
from fapstream.protocol.session import FAP_NUMBERS
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


def ready(service: Service, session: str, fps: Literal[25, 50]) -> g.Ready:
    """What a server can do."""
    return g.Ready(
        server=f"fapstream {__version__}",
        session=session,
        fps=fps,
        faps=bytes(FAP_NUMBERS),
        voices=tuple(
            g.Voice(
                name=v.name, lang=v.lang, engine=v.engine,
                sample_rate=v.sample_rate, description=v.description,
            )
            for v in service.voices.all()
        ),
        heads=service.heads(),
    )  # fmt: skip
