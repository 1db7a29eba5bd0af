"""What head, brows and lids do with what is said: nods and raised brows on accents, blinks at phrase ends.

Nothing looks ahead: a gesture begins where the vowel or pause that calls for it begins; its apex follows.
"""

from __future__ import annotations

import tomllib
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fapstream.data import read_text
from fapstream.fap import ANGLE_UNIT_RAD
from fapstream.motion.chance import BACK_S, Real, minimum_jerk, uniform
from fapstream.motion.idle import blink
from fapstream.records import N_FAPS, SILENCE, Phone, TimedPhone

HEAD_PITCH = 47
NOD, BROWS, END_NOD, END_BLINK, SIZE = range(40, 45)
"""Channels of chance."""
LONGEST_S = 1.2
"""Every gesture is over by then."""


@cache
def table() -> Any:
    """data/gestures.toml."""
    return tomllib.loads(read_text("motion", "gestures.toml"))


@dataclass(frozen=True, slots=True)
class _Gesture:
    """FAPs (68,) that come within `up` seconds of `start` and go within `down`."""

    start: float
    up: float
    down: float
    values: NDArray[np.float64]

    def level(self, t: Real) -> Any:
        into = t - self.start
        return minimum_jerk(into / self.up) - minimum_jerk((into - self.up) / self.down)


class Gestures:
    """The prosody stream of one turn. `add` phones in order, then ask for times that they have reached."""

    def __init__(self, seed: int, sample_rate: int) -> None:
        self._seed, self._rate = seed, sample_rate
        self._gestures: deque[_Gesture] = deque()
        self._blinks: deque[tuple[int, float]] = deque()
        self._count = 0
        self._busy_until = 0.0
        self._spoke = False

    def add(self, timed: TimedPhone) -> None:
        """The next phone."""
        phone, start = timed.phone, timed.start / self._rate
        if phone.name != SILENCE:
            self._spoke = True
            if start >= self._busy_until and (strength := accent(phone)):
                self._accent(start, strength)
        elif self._spoke and timed.end - timed.start >= table()["phrase_end"]["pause_s"] * self._rate:
            self._spoke = False
            self._phrase_end(start)

    def cut(self, t: float) -> None:
        """What begins from `t` seconds on is void; what has begun goes on."""
        while self._gestures and self._gestures[-1].start >= t:
            self._gestures.pop()
        while self._blinks and self._blinks[-1][1] >= t:
            self._blinks.pop()
        self._busy_until = min(self._busy_until, t)
        self._spoke = False

    def at(self, t: Real) -> tuple[NDArray[np.float64], Any]:
        """FAPs (..., 68), FAP units, and how far a blink shuts the lids (0 to 1), at one instant or at many,
        ascending. Times go back by BACK_S at most."""
        first, last = np.ravel(t)[[0, -1]]
        while self._gestures and self._gestures[0].start < first - LONGEST_S - BACK_S:
            self._gestures.popleft()
        while self._blinks and self._blinks[0][1] < first - LONGEST_S - BACK_S:
            self._blinks.popleft()
        values = np.zeros((*np.shape(t), N_FAPS))
        for gesture in self._gestures:
            if first - LONGEST_S < gesture.start <= last:
                values += np.multiply.outer(gesture.level(t), gesture.values)
        shut: Any = 0.0
        for k, start in self._blinks:
            if first - LONGEST_S < start <= last:
                shut = np.maximum(shut, blink(self._seed, k, t - start))
        return values, shut

    def _accent(self, start: float, strength: float) -> None:
        self._busy_until = start + table()["accent"]["apart_s"]
        self._count += 1
        if self._chance(NOD) < table()["nod"]["share"]:
            self._nod(start, table()["nod"], strength)
        if self._chance(BROWS) < table()["brows"]["share"]:
            brows, values = table()["brows"], np.zeros(N_FAPS)
            for fap, share in brows["faps"].items():
                values[int(fap) - 1] = share * _between(brows["raise"], strength)
            self._gestures.append(_Gesture(start, brows["up_s"], brows["down_s"], values))

    def _phrase_end(self, start: float) -> None:
        end = table()["phrase_end"]
        self._count += 1
        if self._chance(END_NOD) < end["nod_share"]:
            self._nod(start, end, self._chance(SIZE))
        if self._chance(END_BLINK) < end["blink_share"]:
            self._blinks.append((-self._count, start))

    def _nod(self, start: float, law: Any, strength: float) -> None:
        values = np.zeros(N_FAPS)
        values[HEAD_PITCH] = _between(law["pitch_rad"], strength) / ANGLE_UNIT_RAD
        self._gestures.append(_Gesture(start, law["up_s"], law["down_s"], values))

    def _chance(self, channel: int) -> float:
        return float(uniform(self._seed, channel, self._count))


def accent(phone: Phone) -> float:
    """How strongly a phone is accented, 0 (not) to 1: a stressed vowel, by the rise of its melody."""
    if phone.stress != 1:
        return 0.0
    if not phone.pitch:
        return 0.5
    law = table()["accent"]
    f0 = [hz for _, hz in phone.pitch]
    rise = max(f0) / f0[0] - 1.0
    if rise < law["rise"]:
        return 0.0
    return min(1.0, rise / float(law["full_rise"]))


def _between(ends: Sequence[float], share: float) -> float:
    return ends[0] + (ends[1] - ends[0]) * share
