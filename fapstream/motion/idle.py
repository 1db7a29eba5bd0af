"""What a living face does unasked: blinks, glances, and a head that is never quite still.

Seeded, a function of time: asking for other instants, or in another order, changes nothing. All numbers
and their sources are in data/life.json; clients/web/src/motion/idle.ts reads the same file and computes the
same face.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from math import hypot, log, pi, radians, sin
from typing import Any, Literal

from fapstream.data import read_text
from fapstream.motion.chance import Events, log_normal, minimum_jerk, noise, normal, uniform

Mode = Literal["talk", "listen"]

BLINK, CLOSE, SHUT, OPEN, PARTIAL = range(5)
FIXATION, POINT, MICRO_YAW, MICRO_PITCH = range(10, 14)
ON, AWAY, SIZE, DIRECTION = range(20, 24)
HEAD = 30
"""Channels of chance: one for each thing that is drawn; the head takes a row of them."""


@cache
def life() -> Any:
    """data/life.json."""
    return json.loads(read_text("motion", "life.json"))


@dataclass(frozen=True, slots=True)
class Look:
    """Where the eyes aim, in the frame of the trunk: radians to the subject's left and down, and 1/m."""

    yaw: float
    pitch: float
    nearness: float


@dataclass(frozen=True, slots=True)
class Idle:
    """One instant: how far the lids are shut (0 to 1), the gaze, and the head's pitch, yaw and roll (rad)."""

    shut: float
    look: Look
    head: tuple[float, float, float]


class IdleLife:
    """One face's idle life. `mode`: people who talk blink and look away more than people who listen."""

    def __init__(self, seed: int, mode: Mode = "talk") -> None:
        self._blinks = Blinks(seed, mode)
        self._gaze = Gaze(seed, mode)
        self._seed = seed

    def at(self, t: float) -> Idle:
        """The face at `t` seconds, t >= 0."""
        look, turn = self._gaze.at(t)
        pitch, yaw, roll = sway(self._seed, t)
        return Idle(self._blinks.shut(t), look, (pitch + turn[1], yaw + turn[0], roll))


class Blinks:
    """When the lids close, and how far."""

    def __init__(self, seed: int, mode: Mode) -> None:
        self._seed = seed
        law = life()["blink"]["interval_s"][mode]
        self._events = Events(lambda k: log_normal(seed, BLINK, k, law))

    def shut(self, t: float) -> float:
        """0 open, 1 shut."""
        k, into = self._events.at(t)
        spread = uniform(self._seed, PARTIAL, k)
        partial = life()["blink"]["partial"]
        depth = partial["depth"] if spread < partial["share"] else 1.0
        return depth * blink(self._seed, k, into)


def blink(seed: int, k: int, into: float) -> float:
    """Blink k, `into` seconds after it began, 0 to 1: down fast, up at first fast and then slowly."""
    table = life()["blink"]
    close, shut, opening = (
        low + (high - low) * uniform(seed, channel, k)
        for channel, (low, high) in zip(
            (CLOSE, SHUT, OPEN), (table["close_s"], table["shut_s"], table["open_s"]), strict=True
        )
    )
    if into < close:
        return minimum_jerk(into / close)
    return 1.0 - minimum_jerk(max(0.0, (into - close - shut) / opening) ** 0.75)


class Gaze:
    """Fixations within the viewer's face, and now and then a glance away in which the head takes part."""

    def __init__(self, seed: int, mode: Mode) -> None:
        self._seed = seed
        self._table = table = life()["gaze"]
        self._law = law = table["aversion"][mode]
        self._fixations = Events(lambda k: log_normal(seed, FIXATION, k, table["fixation_s"]))
        self._glances = Events(lambda k: self._away_s(k) + log_normal(seed, ON, k, law["on_s"]))

    def at(self, t: float) -> tuple[Look, tuple[float, float]]:
        """The aim, and the head's part of it: yaw and pitch in radians."""
        table = self._table
        k, since = self._fixations.at(t)
        yaw, pitch = self._saccade(self._point(k - 1), self._point(k), since)
        n, into = self._glances.at(t)
        away, far = self._glance(n), self._away_s(n)
        turn_s = table["aversion"]["head"]["move_s"]
        size = hypot(*away)
        out = self._step(size, into) - self._step(size, into - far)
        slow = minimum_jerk(into / turn_s) - minimum_jerk((into - far) / turn_s)
        near, distant = 1 / table["viewer"]["distance_m"], 1 / table["far_m"]
        look = Look(
            radians(yaw + out * away[0]),
            radians(pitch + out * away[1]) + table["viewer"]["pitch_rad"],
            near + (distant - near) * slow,
        )
        share = slow * table["aversion"]["head"]["share"]
        return look, (share * radians(away[0]), share * radians(away[1]))

    def _away_s(self, n: int) -> float:
        """How long glance n lasts, s."""
        return log_normal(self._seed, AWAY, n, self._law["away_s"])

    def _point(self, k: int) -> tuple[float, float]:
        """Fixation k: degrees left and down of the middle of the viewer's face."""
        k = max(k, 0)
        point = _choose(self._table["points"], uniform(self._seed, POINT, k))
        micro = self._table["micro_deg"]
        return (
            point["yaw_deg"] + micro * normal(self._seed, MICRO_YAW, k),
            point["pitch_deg"] + micro * normal(self._seed, MICRO_PITCH, k),
        )

    def _glance(self, n: int) -> tuple[float, float]:
        """How far glance n goes: degrees left and down; glance 0 was over before time began."""
        if n == 0:
            return 0.0, 0.0
        table, law = self._table["aversion"], self._table["aversion"]["size_deg"]
        size = min(law["least"] - law["mean"] * log(1 - uniform(self._seed, SIZE, n)), law["most"])
        way = _choose(table["directions"], uniform(self._seed, DIRECTION, n))
        return size * way["yaw"], size * way["pitch"]

    def _saccade(
        self, start: tuple[float, float], end: tuple[float, float], since: float
    ) -> tuple[float, float]:
        x = self._step(hypot(end[0] - start[0], end[1] - start[1]), since)
        return start[0] + x * (end[0] - start[0]), start[1] + x * (end[1] - start[1])

    def _step(self, size_deg: float, since: float) -> float:
        """How much of a saccade is done (0 to 1) by the main sequence."""
        law = self._table["saccade_s"]
        return minimum_jerk(since / (law["base"] + law["per_deg"] * size_deg))


def _choose(options: Sequence[Mapping[str, float]], share: float) -> Mapping[str, float]:
    for option in options[:-1]:
        share -= option["share"]
        if share < 0:
            return option
    return options[-1]


def sway(seed: int, t: float) -> tuple[float, float, float]:
    """Pitch, yaw and roll of the head, radians: drift with a 1/f-like spectrum, and breath."""
    table = life()["head"]
    start = minimum_jerk(t / table["ease_s"])
    drift = [
        start * table[axis]["rms_rad"] * _drift(seed, HEAD + 10 * i, t)
        for i, axis in enumerate(("pitch", "yaw", "roll"))
    ]
    breath = table["breath"]
    phase = breath["hz"] * t + breath["wander"] * noise(seed, HEAD + 9, breath["hz"] * t)
    return drift[0] + start * breath["pitch_rad"] * sin(2 * pi * phase), drift[1], drift[2]


def _drift(seed: int, channel: int, t: float) -> float:
    """Octaves of noise, each faster and smaller than the one before; rms about 1."""
    table = life()["head"]
    total = power = 0.0
    rate, size = table["slowest_hz"], 1.0
    for octave in range(table["octaves"]):
        total += size * noise(seed, channel + octave, rate * t)
        power += size * size
        rate, size = 2 * rate, table["falloff"] * size
    return float(total / (0.5 * power**0.5))
