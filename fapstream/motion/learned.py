"""The mouth as a learned model moves it, unit by unit as they come.

The model moves what can be measured on people: jaw and lips (articulation.SPOKEN). What a camera in front
does not see, lips that come forward and the tongue, and the contacts of lips and teeth that have to be seen,
are the keyframes', by phonetic rule.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from math import ceil
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from fapstream.motion.articulation import COLUMNS, Articulation
from fapstream.motion.chance import Real, minimum_jerk
from fapstream.motion.keyframed import KeyframedMouth
from fapstream.motion.mixer import Mouth
from fapstream.motion.speech import Speaking
from fapstream.motion.spline import STEP_S
from fapstream.motion.units import SIL, TimedUnit, units
from fapstream.records import TimedPhone

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

PIECE, RUN = 10, 48
"""So many instants of a silence are made at once, and with so many, or more, a run of units ends."""
KEPT_S = 0.6
"""Units that ended longer ago are forgotten."""
REST_S = 0.2
"""In a pause the mouth takes so long to come to rest, and to leave it."""
SEAM = 5
"""So many instants it takes from where it is to where new knowledge has it."""


LATE = 0.8
"""The model brings lips nearly together by itself; from this share of a keyframed contact on it is helped."""


class MouthModel(Protocol):
    """Makes articulatory parameters of timed units."""

    @property
    def look_ahead(self) -> int:
        """So many units after one have to be known before its parameters can be told."""

    def parameters(self, units: Sequence[TimedUnit], of: Ints, first: int, rate: int) -> Floats:
        """The parameters, shape (n, parameters), at n instants STEP_S apart, of which the first is number
        `first` of the talk; `of`, shape (n,), is the unit in which each lies.

        `units`: those of the last KEPT_S, and `look_ahead` after the last one in `of`, or up to the next
        silence, or, in a silence, none if none are known. Times are samples at `rate`. What comes of an
        instant does not depend on which others are asked for, if units are asked for as a whole.
        """


class LearnedMouth:
    """See `MouthTrack`."""

    def __init__(
        self, hidden: KeyframedMouth, model: MouthModel, articulation: Articulation, speaking: Speaking
    ) -> None:
        """`hidden`: the keyframes, which move what the model does not."""
        self._hidden, self._model, self._articulation = hidden, model, articulation
        self._speaking = speaking
        self._units: list[TimedUnit] = []
        self._at = 0
        """The unit whose instants are made next."""
        self._next = self._ceil(speaking.start)
        """The instant that is made next."""
        self._rows: deque[Floats] = deque([np.zeros(len(COLUMNS))])
        """FAPs of the last instants before that."""
        self._guessed = True
        """The last of them is of rest before all, or of a silence of which it was not known what follows."""
        self._seam = (self._next, np.zeros(len(COLUMNS)))
        """From which instant on, and how far then, the mouth is away from where the model has it."""
        self._opening: TimedUnit | None = None
        self._silence = (speaking.start, speaking.start)
        """Where the last one is."""

    def add(self, timed: TimedPhone) -> None:
        """See `MouthTrack`."""
        self._hidden.add(timed)
        for unit in units(timed, self._speaking.lang):
            self._units.append(unit)
            self._opening = self._opening or unit
            if unit.name == SIL:
                self._silence = unit.start, unit.end

    def ready_until(self) -> int:
        """See `MouthTrack`."""
        silent = self._silence[1] if self._units and self._units[-1].name == SIL else self._silence[0]
        return min(self._hidden.ready_until(), max(self._known_until(), silent))

    def settled_until(self) -> int:
        """See `MouthTrack`."""
        return min(self._hidden.settled_until(), max(self._known_until(), self._silence[0]))

    def _known_until(self) -> int:
        """The units before this sample have all those after them that the model looks at."""
        ahead = self._model.look_ahead
        return self._units[-ahead].start if len(self._units) >= ahead else self._speaking.start

    def at(self, samples: NDArray[np.int64]) -> Mouth:
        """See `MouthTrack`."""
        hidden = self._hidden.at(samples)
        numbers = np.rint(np.atleast_1d(samples) / self._step).astype(np.int64)
        while self._next <= numbers[-1]:
            self._make()
        first = self._next - len(self._rows)
        rows = np.array(self._rows)[np.maximum(numbers - first, 0)]
        hidden.values[..., COLUMNS] = rows if np.ndim(samples) else rows[0]
        for _ in range(numbers[-1] - first):
            self._rows.popleft()
        return replace(hidden, seal=nearly(hidden.seal), bite=nearly(hidden.bite), jaw=False)

    def rest_until(self, sample: int) -> None:
        """See `MouthTrack`."""
        self._hidden.rest_until(sample)

    @property
    def _step(self) -> float:
        """Samples from one instant to the next."""
        return STEP_S * self._speaking.rate

    def _ceil(self, sample: int) -> int:
        """The first instant at a sample or after it."""
        return ceil(sample / self._step - 1e-9)

    def _make(self) -> None:
        """The next instants: of a silence, or of units up to the next one, as far as they are known."""
        while self._ceil(self._units[self._at].end) <= self._next:
            self._at += 1
        self._forget()
        of = self._of_silence() if self._units[self._at].name == SIL else self._of_speech()
        window = self._window(int(of[-1]))
        known = self._units[self._at].name != SIL or len(window) > self._at + 1
        if self._guessed and known:
            self._seam = self._next - 1, self._rows[-1] - self._faps(window, of[:1], self._next - 1)[0]
        rows = self._faps(window, of, self._next)
        since = np.arange(self._next, self._next + len(of)) - self._seam[0]
        if since[0] < SEAM:
            rows = rows + np.outer(1 - minimum_jerk(since / SEAM), self._seam[1])
        self._rows.extend(rows)
        self._next += len(of)
        self._guessed = not known

    def _of_silence(self) -> Ints:
        """The unit of each instant that is made next, in a silence."""
        return np.full(min(PIECE, self._ceil(self._units[self._at].end) - self._next), self._at)

    def _of_speech(self) -> Ints:
        """The same of whole units, as many as are known, or fill a run."""
        known_until = max(self._known_until(), self._silence[0])
        found: list[int] = []
        for at in range(self._at, len(self._units)):
            unit, number = self._units[at], self._next + len(found)
            if found and (len(found) >= RUN or unit.name == SIL or unit.end > known_until):
                break
            found += [at] * (self._ceil(unit.end) - number)
        return np.array(found)

    def _forget(self) -> None:
        """Units that are long over."""
        over = self._next * self._step - KEPT_S * self._speaking.rate
        old = 0
        while old < self._at and self._units[old].end < over:
            old += 1
        del self._units[:old]
        self._at -= old

    def _window(self, last: int) -> Sequence[TimedUnit]:
        """The units that count for those up to the last one that is made: never beyond the next silence."""
        after = self._units[last + 1 : last + 1 + self._model.look_ahead]
        silence = next((i for i, unit in enumerate(after) if unit.name == SIL), None)
        if silence is None and len(after) < self._model.look_ahead:
            return self._units[: last + 1]
        return self._units[: last + 1] + after[: None if silence is None else silence + 1]

    def _faps(self, window: Sequence[TimedUnit], of: Ints, first: int) -> Floats:
        """The model's, as far as a silence lets them be; see `MouthModel` for what is handed in."""
        parameters = self._model.parameters(window, of, first, self._speaking.rate)
        faps = self._speaking.gain * self._articulation.faps(parameters)
        unit = window[self._at]
        if unit.name != SIL:
            return faps
        at = np.arange(first, first + len(of), dtype=np.float64) * self._step
        rest_samples = REST_S * self._speaking.rate
        rest = np.ones(len(of))
        if unit is not self._opening:
            rest *= minimum_jerk((at - unit.start) / rest_samples)
        if len(window) > self._at + 1:
            rest *= minimum_jerk((unit.end - at) / rest_samples)
        return faps * (1 - rest)[:, None]


def nearly(share: Real) -> Real:
    """How much of a contact is seen to, by how much of it the keyframes have."""
    helped: Real = minimum_jerk((share - LATE) / (1 - LATE))
    return helped
