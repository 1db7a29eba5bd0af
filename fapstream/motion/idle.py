"""What a living face does unasked: blinks, glances, and a head that is never quite still.

Seeded, a function of time: asking for other instants, or in another order, changes nothing. All numbers
and their sources are in data/life.json; clients/web/src/motion/idle.ts reads the same file and computes the
same face.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import pi, radians
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from fapstream.data import read_text
from fapstream.motion.chance import (
    Events,
    Real,
    Whole,
    log_normal,
    minimum_jerk,
    noise,
    normal,
    uniform,
)

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

    yaw: Real
    pitch: Real
    nearness: Real


@dataclass(frozen=True, slots=True)
class Idle:
    """How far the lids are shut (0 to 1), the gaze, and the head's pitch, yaw and roll (rad), at one instant,
    or at each of many: then all are arrays of shape (n,)."""

    shut: Real
    look: Look
    head: tuple[Real, Real, Real]


class IdleLife:
    """One face's idle life. `mode`: people who talk blink and look away more than people who listen."""

    def __init__(self, seed: int, mode: Mode = "talk") -> None:
        self._blinks = Blinks(seed, mode)
        self._gaze = Gaze(seed, mode)
        self._seed = seed

    def at(self, t: Real) -> Idle:
        """The face at `t` seconds, t >= 0; many instants in ascending order cost little more than one."""
        look, turn = self._gaze.at(t)
        pitch, yaw, roll = sway(self._seed, t)
        return Idle(self._blinks.shut(t), look, (pitch + turn[1], yaw + turn[0], roll))


class Blinks:
    """When the lids close, and how far."""

    def __init__(self, seed: int, mode: Mode) -> None:
        self._seed = seed
        law = life()["blink"]["interval_s"][mode]
        self._events = Events(lambda k: log_normal(seed, BLINK, k, law))

    def shut(self, t: Real) -> Any:
        """0 open, 1 shut."""
        k, into = self._events.at(t)
        spread = uniform(self._seed, PARTIAL, k)
        partial = life()["blink"]["partial"]
        depth = np.where(spread < partial["share"], partial["depth"], 1.0)
        return depth * blink(self._seed, k, into)


def blink(seed: int, k: Whole, into: Real) -> Any:
    """Blink k, `into` seconds after it began, 0 to 1: down fast, up at first fast and then slowly."""
    table = life()["blink"]
    close, shut, opening = (
        low + (high - low) * uniform(seed, channel, k)
        for channel, (low, high) in zip(
            (CLOSE, SHUT, OPEN), (table["close_s"], table["shut_s"], table["open_s"]), strict=True
        )
    )
    up = np.maximum(0.0, (into - close - shut) / opening) ** 0.75
    return np.where(into < close, minimum_jerk(into / close), 1.0 - minimum_jerk(up))


class Gaze:
    """Fixations within the viewer's face, and now and then a glance away in which the head takes part."""

    def __init__(self, seed: int, mode: Mode) -> None:
        self._seed = seed
        self._table = table = life()["gaze"]
        self._law = law = table["aversion"][mode]
        self._fixations = Events(lambda k: log_normal(seed, FIXATION, k, table["fixation_s"]))
        self._glances = Events(lambda k: self._away_s(k) + log_normal(seed, ON, k, law["on_s"]))

    def at(self, t: Real) -> tuple[Look, tuple[Any, Any]]:
        """The aim, and the head's part of it: yaw and pitch in radians."""
        table = self._table
        k, since = self._fixations.at(t)
        yaw, pitch = self._saccade(self._point(k - 1), self._point(k), since)
        n, into = self._glances.at(t)
        away, far = self._glance(n), self._away_s(n)
        turn_s = table["aversion"]["head"]["move_s"]
        size = np.hypot(*away)
        out = self._step(size, into) - self._step(size, into - far)
        slow = minimum_jerk(into / turn_s) - minimum_jerk((into - far) / turn_s)
        near, distant = 1 / table["viewer"]["distance_m"], 1 / table["far_m"]
        look = Look(
            radians(1) * (yaw + out * away[0]),
            radians(1) * (pitch + out * away[1]) + table["viewer"]["pitch_rad"],
            near + (distant - near) * slow,
        )
        share = radians(table["aversion"]["head"]["share"]) * slow
        return look, (share * away[0], share * away[1])

    def _away_s(self, n: Whole) -> Any:
        """How long glance n lasts, s."""
        return log_normal(self._seed, AWAY, n, self._law["away_s"])

    def _point(self, k: Whole) -> tuple[Any, Any]:
        """Fixation k: degrees left and down of the middle of the viewer's face."""
        k = k + (k < 0)  # what was before the first is the first
        yaw, pitch = _choose(self._table["points"], ("yaw_deg", "pitch_deg"), uniform(self._seed, POINT, k))
        micro = self._table["micro_deg"]
        return (
            yaw + micro * normal(self._seed, MICRO_YAW, k),
            pitch + micro * normal(self._seed, MICRO_PITCH, k),
        )

    def _glance(self, n: Whole) -> tuple[Any, Any]:
        """How far glance n goes: degrees left and down; glance 0 was over before time began."""
        table, law = self._table["aversion"], self._table["aversion"]["size_deg"]
        size = np.minimum(law["least"] - law["mean"] * np.log(1 - uniform(self._seed, SIZE, n)), law["most"])
        size = np.where(n == 0, 0.0, size)
        yaw, pitch = _choose(table["directions"], ("yaw", "pitch"), uniform(self._seed, DIRECTION, n))
        return size * yaw, size * pitch

    def _saccade(self, start: tuple[Any, Any], end: tuple[Any, Any], since: Real) -> tuple[Any, Any]:
        x = self._step(np.hypot(end[0] - start[0], end[1] - start[1]), since)
        return start[0] + x * (end[0] - start[0]), start[1] + x * (end[1] - start[1])

    def _step(self, size_deg: Any, since: Any) -> Any:
        """How much of a saccade is done (0 to 1) by the main sequence."""
        law = self._table["saccade_s"]
        return minimum_jerk(since / (law["base"] + law["per_deg"] * size_deg))


def _choose(options: Sequence[dict[str, float]], keys: tuple[str, ...], share: Any) -> NDArray[np.float64]:
    """Those numbers of the option that `share` (0 to 1) falls to, shape (keys, ...)."""
    ends = np.cumsum([option["share"] for option in options[:-1]])
    table = np.array([[option[key] for option in options] for key in keys])
    return table[:, np.searchsorted(ends, share, side="right")]


def sway(seed: int, t: Real) -> tuple[Any, Any, Any]:
    """Pitch, yaw and roll of the head, radians: drift with a 1/f-like spectrum, and breath."""
    table = life()["head"]
    start = minimum_jerk(t / table["ease_s"])
    pitch, yaw, roll = start * _drift(seed, t)
    breath = table["breath"]
    phase = breath["hz"] * t + breath["wander"] * noise(seed, HEAD + 9, breath["hz"] * t)
    return pitch + start * breath["pitch_rad"] * np.sin(2 * pi * phase), yaw, roll


def _drift(seed: int, t: Real) -> NDArray[np.float64]:
    """Octaves of noise, each faster and smaller than the one before, radians, shape (3, ...)."""
    channels, rates, sizes = _octaves()
    tracks = sizes * noise(seed, channels, np.asarray(t)[..., None, None] * rates)
    total = tracks[..., 0]
    for octave in range(1, len(rates)):
        total = total + tracks[..., octave]
    return np.moveaxis(total, -1, 0)


@cache
def _octaves() -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Of each axis (3) and octave: the channel (3, octaves), the rate in Hz (octaves,), and the size in
    radians (3, octaves), so that the rms of an axis is its own."""
    table = life()["head"]
    octave = np.arange(table["octaves"])
    falloff = table["falloff"] ** octave.astype(float)
    rms = np.array([table[axis]["rms_rad"] for axis in ("pitch", "yaw", "roll")])
    sizes = rms[:, None] * falloff / (0.5 * (falloff**2).sum() ** 0.5)
    return HEAD + 10 * np.arange(3)[:, None] + octave, table["slowest_hz"] * 2.0**octave, sizes
