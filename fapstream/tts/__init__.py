"""Text to utterances: what is said, how long each phone lasts and on what melody; and voices to say it."""

from __future__ import annotations

from fapstream.tts import espeak_map, pho
from fapstream.tts.frontend import FrontEnd
from fapstream.tts.language import language
from fapstream.tts.manner import DEFAULT_LOOK_AHEAD, PHRASE, Manner, read_lexicon, read_profile
from fapstream.tts.pho import Realiser
from fapstream.tts.realise import VoicePhone, lengths, realise
from fapstream.tts.sounds import syllables
from fapstream.tts.tables import LANGUAGES, PhoneInfo, phone_set
from fapstream.tts.voices import Voice, default_voice, voice, voices

__all__ = [
    "DEFAULT_LOOK_AHEAD",
    "LANGUAGES",
    "PHRASE",
    "FrontEnd",
    "Manner",
    "PhoneInfo",
    "Realiser",
    "Voice",
    "VoicePhone",
    "default_voice",
    "espeak_map",
    "language",
    "lengths",
    "pho",
    "phone_set",
    "read_lexicon",
    "read_profile",
    "realise",
    "syllables",
    "voice",
    "voices",
]
