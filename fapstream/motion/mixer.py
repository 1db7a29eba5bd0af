"""One face out of many streams: speech, expression, prosody, gaze and idle life, by rules.

Speech owns jaw, lips and tongue. An expression lies under it: whole in pauses, on the mouth in part while it
speaks (data/mixing.tsv), and never between lips that must meet (`closure`). Head turns add up; the eyes hold
their aim while the head turns, the lids follow the eyes, a blink shuts lids wherever they stand. Limits come
last.

One instant or many: then every face below has shape (n, 68) and every number shape (n,).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fapstream.data import read_lines
from fapstream.errors import DataError
from fapstream.fap import ANGLE_UNIT_RAD as AU
from fapstream.fap import limits
from fapstream.motion import closure
from fapstream.motion.chance import Real
from fapstream.motion.idle import Idle, Look, life
from fapstream.records import N_FAPS

Values = NDArray[np.float64]

PITCH, YAW, ROLL = 47, 48, 49
LEFT_YAW, RIGHT_YAW, PITCHES = 22, 23, slice(24, 26)
UPPER_LIDS, LOWER_LIDS = slice(18, 20), slice(20, 22)
"""Columns of FAPs."""

KNEE = 0.9
"""From this part of a limit on, values approach it softly."""


@dataclass(frozen=True, slots=True)
class Mouth:
    """What speech wants: FAPs (68,), and how much (0 to 1) it speaks, lips meet, lip meets teeth.

    `jaw`: contacts move it as well, for where it is says nothing about them.
    """

    values: Values
    speaks: Real = 0.0
    seal: Real = 0.0
    bite: Real = 0.0
    jaw: bool = True


@dataclass(frozen=True, slots=True)
class Streams:
    """Everything that moves the face at one instant. `expression` and `gesture` are FAPs (68,), FAP units."""

    mouth: Mouth
    expression: Values
    gesture: Values
    idle: Idle
    shut: Real = 0.0
    """How far a blink that goes with what is said shuts the lids."""


def mix(streams: Streams) -> Values:
    """The face, FAPs (68,) in FAP units, within the anatomical limits."""
    values = spoken(streams.mouth, streams.expression)
    values += streams.gesture
    values[..., PITCH : ROLL + 1] += np.stack(streams.idle.head, axis=-1) / AU
    look(values, streams.idle.look)
    shut(values, np.maximum(streams.shut, streams.idle.shut))
    return limited(values)


def spoken(mouth: Mouth, expression: Values) -> Values:
    """What mouth and expression make of the face together; lips and teeth that have to meet do."""
    silenced = np.expand_dims(mouth.speaks, -1) * (1.0 - shares_while_speaking())
    values = mouth.values + expression * (1.0 - silenced)
    closure.part(values)
    closure.seal(values, mouth.seal, mouth.jaw)
    closure.bite(values, mouth.bite, mouth.jaw)
    return values


def idle_face(idle: Idle) -> Values:
    """The face that does nothing but live, FAPs (68,): what is shown between turns."""
    nothing = np.zeros(N_FAPS)
    return mix(Streams(Mouth(nothing), nothing, nothing, idle))


def look(values: Values, aim: Look) -> None:
    """Turn the eyes to their aim from wherever the head is, and let the lids follow. In place."""
    table = life()["gaze"]
    yaw = aim.yaw - values[..., YAW] * AU
    pitch = aim.pitch - values[..., PITCH] * AU
    inward = table["half_eyes_m"] * aim.nearness
    values[..., LEFT_YAW] += (yaw - inward) / AU
    values[..., RIGHT_YAW] += (yaw + inward) / AU
    lids = table["lids"]
    for columns, follow in ((PITCHES, 1 / AU), (UPPER_LIDS, lids["upper"]), (LOWER_LIDS, lids["lower"])):
        values[..., columns] += np.expand_dims(follow * pitch, -1)


def shut(values: Values, share: Real) -> None:
    """Bring the lids, from wherever they stand, towards where they meet. In place."""
    for fap, closed in life()["blink"]["shut"].items():
        lid = int(fap) - 1
        values[..., lid] += share * (closed - values[..., lid])


def limited(values: Values) -> Values:
    """Values within the anatomical limits: as they are up to KNEE of a limit, from there on softly nearer."""
    low, high = limits().T
    limit = np.where(values < 0, -low, high)
    size = np.abs(values)
    beyond = np.maximum(0.0, size - KNEE * limit)
    if not beyond.any():
        return values
    room = np.maximum((1.0 - KNEE) * limit, 1e-9)
    soft = np.minimum(size, KNEE * limit) + room * np.tanh(beyond / room)
    signed: Values = np.copysign(np.minimum(soft, limit), values)
    return signed


@cache
def shares_while_speaking() -> Values:
    """How much of an expression is left of each FAP while the mouth speaks, shape (68,), 0 to 1."""
    name = "mixing.tsv"
    shares = np.ones(N_FAPS)
    for number, line in read_lines("motion", name):
        try:
            faps, percent, _ = line.split("\t")
            shares[[int(fap) - 1 for fap in faps.split()]] = float(percent) / 100
        except (ValueError, IndexError) as e:
            raise DataError(name, number, str(e)) from None
    return shares
