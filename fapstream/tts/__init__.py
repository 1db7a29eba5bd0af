"""Text to utterances: what is said, how long each phone lasts and on what melody.

Its neighbours `voices`, `realise`, `pho` and `espeak_map` turn utterances into what a voice speaks. Whoever
needs them imports them by name: text becomes phones without them, and the start is shorter.
"""

from __future__ import annotations

from fapstream.tts.frontend import FrontEnd
from fapstream.tts.language import language
from fapstream.tts.manner import DEFAULT_LOOK_AHEAD, PHRASE, Manner, read_lexicon, read_profile
from fapstream.tts.sounds import syllables
from fapstream.tts.tables import LANGUAGES, PhoneInfo, phone_set

__all__ = [
    "DEFAULT_LOOK_AHEAD",
    "LANGUAGES",
    "PHRASE",
    "FrontEnd",
    "Manner",
    "PhoneInfo",
    "language",
    "phone_set",
    "read_lexicon",
    "read_profile",
    "syllables",
]
