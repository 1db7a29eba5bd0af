"""What MBROLA says of a text, and when it says each phone: fast, and without a server."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fapstream.records import Pcm
from fapstream.tts import FrontEnd, Manner
from fapstream.tts.pho import Realiser
from fapstream.tts.voices import voice

DATABASES = Path("/usr/share/mbrola")


class Said(NamedTuple):
    """`phones`: SAMPA names and the seconds at which they begin, pauses (`_`) included."""

    pcm: Pcm
    sample_rate: int
    phones: list[tuple[str, float]]


def say(name: str, text: str) -> Said:
    """A text in a voice."""
    chosen = voice(name)
    front, realiser = FrontEnd(chosen.lang, Manner().of(chosen)), Realiser(chosen)
    lines, phones, at = "", [], 0
    for utterance in front.feed(text) + front.end():
        written = realiser.write(utterance)
        lines += written.lines
        starts = [0, *written.ends]
        phones += [
            (phone.name, (at + start) / chosen.sample_rate)
            for (phone, _), start in zip(written.phones, starts, strict=False)
        ]
        at += starts[-1]
    command = ["mbrola", "-v", str(chosen.drive), str(DATABASES / name / name), "-", "-.raw"]
    sound = subprocess.run(command, input=lines.encode(), capture_output=True, check=True).stdout
    return Said(np.frombuffer(sound, "<i2").astype(np.int16), chosen.sample_rate, phones)
