"""From a folder of clips to a speaker: the whole way, and what is worth knowing about it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy.typing import NDArray

from fapstream.errors import ClipError
from fapstream.head import Fapu
from fapstream.learn.articulatory import ArticulatoryParameters
from fapstream.learn.clips import Clip, Folder
from fapstream.learn.hearing import HearingFit, paired
from fapstream.learn.hmm import HmmTrainer, Recipe
from fapstream.learn.measured import RATE, Measured, measure_clip
from fapstream.learn.ohman import OhmanFit, OhmanRecipe
from fapstream.learn.sentences import Sentence, sentence, usable
from fapstream.motion.hearing import Heard
from fapstream.motion.hmm import HmmMouth
from fapstream.motion.learned import MouthModel
from fapstream.motion.speaker import Speaker
from fapstream.motion.spline import STEP_S, Smoothness
from fapstream.motion.trees import TiedStates
from fapstream.motion.units import TimedUnit
from fapstream.records import Pcm

Floats = NDArray[np.float64]

SPEECH_S = 0.15
"""What a face does so long before and after speech is learned from."""
HEARD_S = 0.3
"""The same for hearing, which has to know silence as well."""
WIDTHS_S = (0.04, 0.06, 0.08, 0.1, 0.12)
WEIGHTS = (0.03, 0.1, 0.3, 1.0, 3.0)
"""What smoothness is chosen from."""
LEAST_CLIPS = 20
TRAIN, DEVELOPMENT = "train", "dev"
TICKS = 1000
"""Times of units as whole numbers, a frame."""

Tell = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Filmed:
    """A clip and what was measured on it."""

    clip: Clip
    measured: Measured


@dataclass(frozen=True, slots=True)
class Trained:
    """`speaker`; `explained`: the part of the variance that each parameter explains; `components`: the same
    of nine plain principal components, for comparison (speech-enabled-avatars, 3.1); `left_out`: clips that
    could not be used, and why."""

    speaker: Speaker
    explained: Floats
    components: Floats
    left_out: Mapping[str, str]


def film(folder: Folder, part: str, left_out: dict[str, str], tell: Tell = lambda _: None) -> list[Filmed]:
    """The clips of a part, measured; those that cannot be are left out."""
    found = []
    for name in folder.part(part):
        tell("measuring")
        try:
            (clip,) = folder.clips((name,))
            clip.speech()
            found.append(Filmed(clip, measure_clip(clip.landmarks)))
        except ClipError as e:
            left_out[name] = str(e)
    return found


def mean_fapu(filmed: Iterable[Filmed]) -> Fapu:
    """Of several clips."""
    mean = np.mean([list(f.measured.fapu.as_dict().values()) for f in filmed], axis=0)
    return Fapu(*map(float, mean))


def speech(filmed: Filmed, margin_s: float = SPEECH_S) -> slice:
    """The frames of speech and some around it."""
    begin, end = filmed.clip.speech()
    last = len(filmed.measured.seen)
    return slice(max(0, round((begin - margin_s) * RATE)), min(last, round((end + margin_s) * RATE) + 1))


def train(
    folder: Folder,
    made: str,
    tell: Tell = lambda _: None,
    recipe: Recipe | None = None,
    sound: Callable[[str], Pcm] | None = None,
) -> Trained:
    """Learn a speaker; `made` goes into the file. `sound`: that of a clip, at 16 kHz; without it the speaker
    cannot hear. Raises ClipError."""
    left_out: dict[str, str] = {}
    folder.part(DEVELOPMENT)  # rather now than after half of the work
    filmed = film(folder, TRAIN, left_out, tell)
    if len(filmed) < LEAST_CLIPS:
        raise ClipError(f"{folder.path}: only {len(filmed)} clips can be used, of at least {LEAST_CLIPS}")
    parameters = ArticulatoryParameters()
    seen = [f.measured.points[speech(f)][f.measured.seen[speech(f)]] for f in filmed]
    parameters.fit([points for points in seen if len(points)], mean_fapu(filmed))
    quick = sentences(filmed, parameters, True, left_out)
    states = HmmTrainer(recipe, tell).fit(quick).model_
    smoothness = choose(
        states, sentences(film(folder, DEVELOPMENT, left_out, tell), parameters, False, left_out), tell
    )
    ohman = OhmanFit(OhmanRecipe(), tell).fit(sentences(filmed, parameters, False, left_out)).model_
    heard = _hearing(filmed, parameters, sound, tell) if sound else None
    speaker = Speaker(parameters.articulation_, states, smoothness, ohman, made, heard)
    return Trained(speaker, parameters.pca_.explained_, parameters.components(9), left_out)


def _hearing(
    filmed: Sequence[Filmed], parameters: ArticulatoryParameters, sound: Callable[[str], Pcm], tell: Tell
) -> Heard:
    tell("hearing")
    whole = [f for f in filmed if f.measured.seen.all()]
    sounds = [sound(f.clip.name) for f in whole]
    made = [parameters.transform(f.measured.points) for f in whole]
    return HearingFit().fit(*paired(sounds, made, [speech(f, HEARD_S) for f in whole])).heard_


def sentences(
    filmed: Sequence[Filmed], parameters: ArticulatoryParameters, silences: bool, left_out: dict[str, str]
) -> list[Sentence]:
    """To learn from; see `sentence`. Those in which the face is lost are left out."""
    found = []
    for f in filmed:
        made = sentence(f.clip, parameters.transform(f.measured.points), silences)
        if usable(f.measured, made):
            found.append(made)
        else:
            left_out[f.clip.name] = "the face is lost while something is said"
    return found


def choose(states: TiedStates, heard: Sequence[Sentence], tell: Tell = lambda _: None) -> Smoothness:
    """The smoothness whose trajectories are nearest to what was measured in sentences that were not learned
    from; if there are none, the middle one."""
    tell("smoothness")
    if not heard:
        return Smoothness(WIDTHS_S[2], WEIGHTS[2])
    ways = [Smoothness(width, weight) for width in WIDTHS_S for weight in WEIGHTS]
    errors = [np.mean([_error(HmmMouth(states, how), each) for each in heard]) for how in ways]
    return ways[int(np.argmin(errors))]


def _error(mouth: MouthModel, heard: Sentence) -> float:
    made = predicted(mouth, heard)
    wanted = heard.parameters[:: round(STEP_S * RATE)][: len(made)]
    return float(((made[: len(wanted)] - wanted) ** 2).mean())


def predicted(mouth: MouthModel, heard: Sentence) -> Floats:
    """What a mouth makes of a sentence's phones, at instants STEP_S apart, shape (n, parameters)."""
    rate = RATE * TICKS
    units = [
        TimedUnit(name, round(begin * TICKS), round(end * TICKS))
        for name, (begin, end) in zip(heard.units, heard.times, strict=True)
    ]
    ends = [max(0, ceil(unit.end / rate / STEP_S - 1e-9)) for unit in units]
    of = np.repeat(np.arange(len(units)), np.diff(ends, prepend=0))
    return mouth.parameters(units, of, 0, rate)
