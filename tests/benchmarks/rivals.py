"""What others make of the same sentences: weights of mouth shapes, a hundred times a second.

TalkingHead (npm: @met4citizen/talkinghead 1.7.0, MIT) gets the true times of the words: its class runs
headless under Node.js, see rivals.mjs. OpenFaceFX (PyPI: openfacefx 0.24.0, MIT) gets the true times of the
phones. Their settings are their own. Neither is part of the project; `tools/bench motion` fetches them.
"""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

RATE = 100
"""Instants a second, the first at 0 s."""

SCRIPT = Path(__file__).with_suffix(".mjs")
SILENCE = "SIL"
VARIANT = re.compile(r"\(\d+\)$")
"""How an aligner marks the second pronunciation of a word; nobody says it."""

LETTERS = {
    "a": "ay", "b": "bee", "c": "cee", "d": "dee", "e": "ee", "f": "eff", "g": "jee", "h": "aitch",
    "i": "eye", "j": "jay", "k": "kay", "l": "el", "m": "em", "n": "en", "o": "oh", "p": "pee", "q": "cue",
    "r": "are", "s": "ess", "t": "tee", "u": "you", "v": "vee", "w": "double-you", "x": "ex", "y": "why",
    "z": "zed",
}  # fmt: skip
"""How their names are written."""

Weights = NDArray[np.float64]


class RivalMissing(Exception):
    """A rival cannot take part; `rival` is its name."""

    def __init__(self, rival: str, reason: str) -> None:
        super().__init__(f"{rival} is left out: {reason}")
        self.rival = rival


@dataclass(frozen=True, slots=True)
class Spoken:
    """A sentence as it was said: words and their phones, each with its start and duration in seconds."""

    words: tuple[tuple[str, float, float, tuple[tuple[str, float, float], ...]], ...]
    n: int
    """Instants wanted."""


def spelled(spoken: Spoken) -> Spoken:
    """The same with the names of letters in their places: to TalkingHead, a lone letter is its sound."""
    return replace(spoken, words=tuple((LETTERS.get(word[0], word[0]), *word[1:]) for word in spoken.words))


def talkinghead(spoken: Sequence[Spoken], package: Path) -> list[Weights]:
    """(n, visemes) of each sentence, in 0..1; `package` is where the npm package was unpacked."""
    if not (package / "modules" / "talkinghead.mjs").is_file():
        raise RivalMissing("TalkingHead", f"no @met4citizen/talkinghead in {package}")
    asked = {"step_ms": 1000 / RATE, "sentences": [_timed_words(s) for s in spoken]}
    command = ["node", str(SCRIPT), str(package)]
    try:
        done = subprocess.run(command, input=json.dumps(asked), text=True, capture_output=True, check=True)
    except OSError as error:
        raise RivalMissing("TalkingHead", f"Node.js does not start: {error}") from error
    except subprocess.CalledProcessError as error:
        raise RivalMissing("TalkingHead", f"its class does not run: {error.stderr[-500:]}") from error
    return [np.array(weights) for weights in json.loads(done.stdout)]


def _timed_words(spoken: Spoken) -> dict[str, object]:
    """The arguments of its `speakAudio`, in ms; silence is no word."""
    words = [w for w in spoken.words if any(phone != SILENCE for phone, *_ in w[3])]
    return {
        "n": spoken.n,
        "words": [VARIANT.sub("", name) for name, *_ in words],
        "wtimes": [1000 * start for _, start, *_ in words],
        "wdurations": [1000 * duration for _, _, duration, _ in words],
    }


def openfacefx(spoken: Sequence[Spoken], jali: bool = False) -> list[Weights]:
    """(n, visemes) of each sentence, in 0..1: its curves before they are thinned out to keyframes.

    `jali` switches its rules of that name on, which are off unless asked for.
    """
    try:
        from openfacefx import CoartParams, build_viseme_curves
    except ImportError as error:
        raise RivalMissing("OpenFaceFX", f"the package openfacefx cannot be imported: {error}") from error
    found = []
    for sentence in spoken:
        times, curves = build_viseme_curves(_segments(sentence), fps=RATE, params=CoartParams(jali=jali))
        instants = np.arange(sentence.n) / RATE
        found.append(np.stack([np.interp(instants, times, curve) for curve in curves.T], axis=1))
    return found


def _segments(spoken: Spoken) -> list[Any]:
    """The phones as it takes them: its names are ours, but for silence."""
    from openfacefx import PhonemeSegment
    from openfacefx.phonemes import SILENCE as NO_PHONE

    phones = [phone for word in spoken.words for phone in word[3]]
    return [
        PhonemeSegment(NO_PHONE if name == SILENCE else name, start, start + duration)
        for name, start, duration in phones
    ]
