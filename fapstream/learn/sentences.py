"""Sentences to learn from: how a face moved, and which phones were heard when."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fapstream.learn.clips import Clip, WordHeard
from fapstream.learn.measured import RATE, Measured
from fapstream.motion.units import SIL, unit
from fapstream.tts import FrontEnd, phone_set

Floats = NDArray[np.float64]

MARGIN_S = 0.3
"""So much of the silence on either side belongs to a sentence."""
CUT_FRAMES = 4
"""The last picture of a film stands for as long, at 25 a second."""


@dataclass(frozen=True, slots=True)
class Sentence:
    """`parameters`: shape (t, n), RATE times a second. `units`: in order, with `times`, shape (units, 2):
    where the sound has their beginning and end, in frames, not whole ones. `optional`: silences that lie
    between two words and may not be there. `start`: the frame of the clip at which the sentence begins."""

    name: str
    parameters: Floats
    units: tuple[str, ...]
    times: Floats
    optional: tuple[bool, ...]
    start: int = 0

    def without(self, silences: Sequence[int]) -> Sentence:
        """Those units are not there."""
        gone = set(silences)
        keep = [i for i in range(len(self.units)) if i not in gone]
        return replace(
            self,
            units=tuple(self.units[i] for i in keep),
            times=self.times[keep],
            optional=(False,) * len(keep),
        )

    def seconds(self) -> Floats:
        """When each unit begins and ends, s from the first frame, shape (units, 2)."""
        found: Floats = self.times / RATE
        return found


def sentence(clip: Clip, parameters: Floats, silences: bool) -> Sentence:
    """Of a clip whose parameters are known, shape (t, n).

    `silences`: one that is optional is put between any two words, and where the sound is silent is not looked
    at; else silences are where the sound has them.
    """
    first, last = clip.speech()
    start = max(0, round((first - MARGIN_S) * RATE))
    end = min(len(parameters), round((last + MARGIN_S) * RATE))
    units: list[str] = []
    times: list[tuple[float, float]] = []
    optional: list[bool] = []

    def put(name: str, begin: float, stop: float, may: bool) -> None:
        units.append(name)
        times.append((begin * RATE - start, stop * RATE - start))
        optional.append(may)

    for i, (word, stresses) in enumerate(zip(clip.words, stresses_of(clip.words), strict=True)):
        inside = 0 < i < len(clip.words) - 1
        if word.silent and inside and silences:
            continue
        if silences and not word.silent and units and units[-1] != SIL:
            before = times[-1][1] + start
            put(SIL, before / RATE, word.start, True)
        for phone, stressed in zip(word.phones, stresses, strict=True):
            put(SIL if word.silent else unit(phone.name, stressed), phone.start, phone.end, False)
    return Sentence(clip.name, parameters[start:end], tuple(units), np.array(times), tuple(optional), start)


def stresses_of(words: Sequence[WordHeard]) -> list[list[bool]]:
    """Which phones of each word are stressed vowels, as the front-end that will speak has it.

    A letter that is spelled is always stressed.
    """
    text = " ".join(word.text for word in words if not word.silent)
    front_end = FrontEnd("en")
    spoken: dict[int, list[int]] = {}
    for utterance in (*front_end.feed(f"{text}."), *front_end.end()):
        for phone in utterance.phones:
            if phone.word >= 0 and phone_set("en")[phone.name].kind == "vowel":
                spoken.setdefault(utterance.words[phone.word].start, []).append(phone.stress)
    found, at = [], 0
    for word in words:
        vowels = [phone.name[0] in "AEIOU" for phone in word.phones]
        stresses = [] if word.silent else spoken.get(at, [])
        if len(word.text) == 1 or len(stresses) != sum(vowels):
            stresses = [1] * sum(vowels)
        given = iter(stresses)
        found.append([vowel and next(given) > 0 for vowel in vowels])
        at += 0 if word.silent else len(word.text) + 1
    return found


def usable(measured: Measured, sentence: Sentence) -> bool:
    """Whether the face was seen all through a sentence, and the film goes on to the end of what is said."""
    end = sentence.start + len(sentence.parameters)
    said = [time for unit, (_, time) in zip(sentence.units, sentence.times, strict=True) if unit != SIL]
    filmed = len(sentence.parameters) > 0 and max(said) <= len(sentence.parameters) + CUT_FRAMES
    return filmed and bool(measured.seen[sentence.start : end].all())
