"""The command espeak-ng as a yardstick: text to MBROLA's .pho notation."""

from __future__ import annotations

import shutil
import subprocess
import time
from dataclasses import dataclass

VOICES = {"en": "mb-us1", "el": "mb-gr2"}
"""Its voices whose phones are those of MBROLA databases."""


@dataclass(frozen=True, slots=True)
class Spoken:
    """A phone of espeak-ng's plan."""

    name: str
    ms: float
    f0_hz: float | None


def available() -> bool:
    """Whether the command is there and has its MBROLA voices."""
    return shutil.which("espeak-ng") is not None and all(plan("a", lang) for lang in VOICES)


def pho(text: str, lang: str) -> str:
    """What the command writes for a text."""
    command = ["espeak-ng", "-q", "-v", VOICES[lang], "--pho"]
    done = subprocess.run(command, input=text, text=True, capture_output=True, check=True)
    return done.stdout


def plan(text: str, lang: str) -> list[Spoken]:
    """The phones of a text, pauses included."""
    found = []
    for line in pho(text, lang).splitlines():
        fields = line.split()
        if len(fields) >= 2:
            f0 = [float(hz) for hz in fields[3::2]]
            found.append(Spoken(fields[0], float(fields[1]), sum(f0) / len(f0) if f0 else None))
    return found


def seconds(text: str, lang: str) -> float:
    """How long the command takes, from its start to its end."""
    begin = time.perf_counter()
    pho(text, lang)
    return time.perf_counter() - begin
