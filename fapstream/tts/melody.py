"""The melody of a phrase, word by word: declination, accents on stressed syllables, and a tune at its end.

f0 is the voice's middle pitch + x * the width of its range, and the tables are in x. The declination falls
exponentially with the time since the phrase began and not with its length, so that a word can be spoken
before the phrase's end is known. The final fall follows the paper on the FPD-based talking head, section 4.1
(the pitch reduced by 60 Hz at the end), scaled by the voice's range: 60 Hz are those of a range of 220 Hz.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, NamedTuple

from fapstream.tts.sounds import Sound

Pitch = tuple[tuple[float, float], ...]
"""(percent of the phone's duration, Hz), ascending, the first at 0."""

PEAK_PERCENT: Final = 55.0
"""Where in its vowel an accent is highest."""


class Tune(NamedTuple):
    """How a phrase ends: height of its last accent above the declination, height reached in the middle of its
    last vowel (0: none of its own), where it ends, and a factor on all its accents."""

    accent: float
    end: float
    peak: float = 0.0
    scale: float = 1.0


@dataclass(slots=True)
class MelodyState:
    """Where the melody of a phrase stands between two words.

    `elapsed_ms` is the age of the declination; `accents` counts them; `tail` is what is left of the last
    accent for the phones that follow it; `focus`: an emphasised word has been, after which accents are small.
    """

    elapsed_ms: float = 0.0
    accents: int = 0
    tail: list[float] = field(default_factory=list)
    focus: bool = False

    def restart(self, reset: float) -> None:
        """A phrase has ended; the declination starts again as far as `reset` (0..1) says."""
        self.elapsed_ms *= 1.0 - reset
        self.accents = 0
        self.tail = []
        self.focus = False


class MelodyModel:
    """f0 of the phones of a phrase, word by word."""

    def __init__(self, settings: Mapping[str, float], tunes: Mapping[str, Tune]) -> None:
        """`settings`: the table [melody] of prosody.toml; `tunes`: by the name that a phrase end has."""
        self.tunes = tunes
        self._top: float = settings["top"]
        self._floor: float = settings["floor"]
        self._decay_ms: float = settings["decay_ms"]
        self._first: float = settings["first_accent"]
        self._other: float = settings["accent"]
        self._focus: float = settings["focus"]
        self._after_focus: float = settings["after_focus"]
        self._before: float = settings["before_vowel"]
        self._rise: float = settings["vowel_start"]
        self._after: float = settings["after_vowel"]
        self._later: float = settings["later"]

    def height(self, state: MelodyState, tune: Tune | None, last: bool, emphasis: float) -> float:
        """The next accent's height; counts it. `tune`: the phrase's if its end is in sight, and then `last`
        says whether it is its last accent."""
        if tune is not None and last:
            height = tune.accent
        else:
            height = self._other if state.accents else self._first
            if tune is not None:
                height *= tune.scale
        state.accents += 1
        if emphasis > 0.0:
            state.focus = True
            return abs(height) * (1.0 + emphasis) + self._focus * emphasis
        return height * self._after_focus if state.focus else height

    def word(
        self, ms: list[float], accent: int, height: float, state: MelodyState, register: tuple[float, float]
    ) -> list[Pitch]:
        """The pitch of each phone. `accent`: index of the vowel with the accent of that height, or -1;
        `register`: the voice's middle pitch and the width of its range, Hz."""
        f0, width = register
        above = (self._top - self._floor) * math.exp(-state.elapsed_ms / self._decay_ms)
        line, fall = f0 + width * (self._floor + above), width * above / self._decay_ms
        starts: list[float] = []
        length = 0.0
        for d in ms:
            starts.append(line)
            line -= fall * d
            length += d
        state.elapsed_ms += length
        if state.tail:
            state.tail = _raised(starts, 0, state.tail, width)
        if accent < 0:
            return [((0.0, hz),) for hz in starts]
        rise = width * height
        peak = starts[accent] - fall * ms[accent] * (PEAK_PERCENT / 100.0) + rise
        starts[accent] += rise * self._rise
        if accent:
            starts[accent - 1] += rise * self._before
        state.tail = _raised(starts, accent + 1, [self._after * height, self._later * height], width)
        out: list[Pitch] = [((0.0, hz),) for hz in starts]
        out[accent] = ((0.0, starts[accent]), (PEAK_PERCENT, peak))
        return out

    def ending(
        self, sounds: list[Sound], ms: list[float], pitch: list[Pitch], tune: Tune,
        register: tuple[float, float],
    ) -> None:  # fmt: skip
        """Bends the pitch of a phrase's last word, in place, from its last vowel on, to end as the tune
        says."""
        f0, width = register
        last = next((i for i in range(len(pitch) - 1, -1, -1) if sounds[i].vowel), 0)
        start = pitch[last]
        if tune.peak:
            start = pitch[last] = (start[0], (45.0, f0 + width * tune.peak))
        at, hz = start[-1]
        goal = f0 + width * tune.end
        passed = ms[last] * (1.0 - at / 100.0)
        slope = (goal - hz) / (passed + sum(ms[last + 1 :]))
        for i in range(last + 1, len(pitch)):
            pitch[i] = ((0.0, hz + slope * passed),)
            passed += ms[i]
        pitch[-1] = (*pitch[-1], (100.0, goal))


def _raised(starts: list[float], at: int, tail: list[float], width: float) -> list[float]:
    """Adds what is left of an accent to the phones from `at` on, in place; returns what is left then."""
    here = len(starts) - at
    for i, x in enumerate(tail[:here]):
        starts[at + i] += width * x
    return tail[here:]
