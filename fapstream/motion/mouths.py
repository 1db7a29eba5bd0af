"""Which mouth speaks: keyframes, or a model learned from people; and how much it moves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Literal, get_args

from fapstream.errors import InputError, UnknownName
from fapstream.motion.keyframed import KeyframedMouth
from fapstream.motion.learned import LearnedMouth, MouthModel
from fapstream.motion.speaker import speaker
from fapstream.motion.speech import MouthTrack, Speaking

Model = Literal["keyframes", "ohman", "hmm"]
MODELS: tuple[Model, ...] = get_args(Model)
DEFAULT_MODEL: Model = "hmm"
GAINS = (0.3, 1.7)
"""From mumbling to speaking to the deaf."""


class UnknownMotion(UnknownName):
    """`known`: the models that there are."""

    code = "unknown_motion"
    kind = "motion model"


@dataclass(frozen=True, slots=True)
class Motion:
    """How a mouth moves. `gain` multiplies what jaw and lips do: under 1 speech is hypo-articulated, over 1
    hyper-articulated; lips that have to meet do so at any. Raises UnknownMotion, InputError."""

    model: Model = DEFAULT_MODEL
    gain: float = 1.0

    def __post_init__(self) -> None:
        if self.model not in MODELS:
            raise UnknownMotion(self.model, MODELS)
        if not GAINS[0] <= self.gain <= GAINS[1]:
            raise InputError(f"articulation {self.gain:g} is not {GAINS[0]:g} to {GAINS[1]:g}")


@cache
def learned(model: Literal["ohman", "hmm"]) -> MouthModel:
    """The model, which holds nothing of any turn. Raises DataError."""
    return speaker().mouth(model)


def mouth_track(motion: Motion, lang: str, sample_rate: int, fps: int, start: int = 0) -> MouthTrack:
    """A mouth that is at rest before sample `start`. Raises UnknownLanguage."""
    speaking = Speaking(lang, sample_rate, start, motion.gain)
    keyframed = KeyframedMouth(speaking, fps)
    if motion.model == "keyframes":
        return keyframed
    return LearnedMouth(keyframed, learned(motion.model), speaker().articulation, speaking)
