"""Which face to show: the turn's at the heard sample, idle life when nothing is said.

Where one takes over from the other, what was shown lasts as an offset that dies away: nothing jumps, and lips
are on time. Twin of clients/web/src/motion/face.ts.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fapstream.motion.chance import minimum_jerk
from fapstream.motion.idle import IdleLife, life
from fapstream.motion.mixer import Mouth, Streams, mix
from fapstream.records import N_FAPS
from fapstream.stream import Heard, TurnBuffer

HEAD, EYES = [47, 48, 49], [22, 23, 24, 25]
MOOD = [30, 31, 32, 33, 34, 35, 36, 37, 40, 41, 60, 61, 62, 63]
"""Columns of FAPs; of brows, cheeks and nose."""
MOOD_S, HEAD_S, EYES_S, LIDS_S = 0.6, 0.7, 0.06, 0.16
"""How long what was shown before lasts: moods and heads take their time, eyes leap."""
TURN_S, BACK_S, REST_S = 0.15, 0.06, 0.35
"""The same for the mouth: at a new turn's disposal, soon back where one goes on, slow to come to rest."""
LEAP_S = 0.1
"""The heard sample has leapt if it is further on, or back, than time and this much account for."""
LONGEST_STEP_S = 0.25
"""Idle life takes no longer steps: after a halt it does not catch up on its blinks."""

Face = NDArray[np.float64]
Source = tuple[int | None, bool, int]
"""The turn that has the face, whether idle life is round it, and how often what is heard has leapt."""


class FaceMixer:
    """`seed`: of idle life; None for none. Faces are float64 (68,), FAP n at n-1."""

    def __init__(self, seed: int | None) -> None:
        self._life = None if seed is None else IdleLife(seed, "listen")
        shut = life()["blink"]["shut"]
        self._lids, self._shut = [int(fap) - 1 for fap in shut], list(shut.values())
        self._alive = [*HEAD, *EYES, *self._lids]
        self._fades = np.zeros(N_FAPS)
        for columns, fade in ((MOOD, MOOD_S), (HEAD, HEAD_S), (EYES, EYES_S), (self._lids, LIDS_S)):
            self._fades[columns] = fade
        self._shown, self._offset = np.zeros(N_FAPS), np.zeros(N_FAPS)
        self._source: Source | None = None
        self._heard: Heard | None = None
        self._stood: Heard | None = None
        self._leaps = 0
        self._mouth_s = REST_S
        self._spoke: int | None = None
        self._since = self._lived = 0.0
        self._time: float | None = None

    def show(self, buffer: TurnBuffer | None, heard: Heard | None, now: float) -> Face:
        """The face at `now` (s), which never goes back. `buffer` is the heard turn's, None if none has it."""
        step = 0.0 if self._time is None else max(0.0, now - self._time)
        self._time = now
        self._since += step
        self._lived += min(step, LONGEST_STEP_S)
        if buffer is None or heard is None or not _tells(buffer, heard):
            target, lives, turn, stood = np.zeros(N_FAPS), True, None, None
            self._stood = heard if heard is not None and heard.state in ("starved", "paused") else None
        else:
            stood = self._watch(buffer, heard, step)
            target, lives, turn = buffer.face(heard.sample), heard.state == "waiting", heard.turn
        if lives and self._life is not None:
            still = np.zeros(N_FAPS)
            idle = mix(Streams(Mouth(still), still, still, self._life.at(self._lived)))
            target[self._alive] = idle[self._alive]
        source = (turn, lives, self._leaps)
        if source != self._source:
            self._turn_to(source, target, target if stood is None else stood)
        left = [1 - minimum_jerk(self._since / (fade or self._mouth_s)) for fade in self._fades]
        self._shown = target + self._offset * left
        self._shown[self._lids] = np.minimum(self._shown[self._lids], self._shut)
        return self._shown

    def _watch(self, buffer: TurnBuffer, heard: Heard, step: float) -> Face | None:
        """The turn's face where its sound had stopped until now, None if it had not.

        A leap of what is heard is caught up with as if the turn had been silent.
        """
        last, self._heard = self._heard, heard
        if last is not None and last.turn == heard.turn:
            on = (heard.sample - last.sample) / buffer.sample_rate
            self._leaps += not -LEAP_S <= on <= step + LEAP_S
        stood, self._stood = self._stood, None
        return buffer.face(stood.sample) if stood is not None and stood.turn == heard.turn else None

    def _turn_to(self, source: Source, target: Face, stood: Face) -> None:
        """What is shown becomes an offset: the mouth's against `stood`, where the sound had stopped."""
        if self._source is not None:
            self._offset = self._shown - np.where(self._fades > 0, target, stood)
        self._source, self._since = source, 0.0
        turn = source[0]
        self._mouth_s = REST_S if turn is None else BACK_S if turn == self._spoke else TURN_S
        self._spoke = self._spoke if turn is None else turn


def _tells(buffer: TurnBuffer, heard: Heard) -> bool:
    """Does the turn have the face? Where sound or frames are missing it comes to rest, and lives."""
    return heard.state in ("playing", "waiting") and buffer.holds(heard.sample)
