"""Phones to MPEG-4 visemes and on to keyframes of low-level FAPs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fapstream.data import names, read_lines
from fapstream.errors import DataError, UnknownLanguage
from fapstream.fap import FULL, N_VISEMES, visemes
from fapstream.motion.closure import BITTEN, CLOSED
from fapstream.motion.mixer import Mouth
from fapstream.records import N_FAPS, SILENCE, TimedPhone

REST_MS = 120
"""In a pause the mouth takes this long to come to rest, and as long to leave it."""

MAX_HALF_HOLD = 0.45
"""A shape is kept for no more than this part of its phone on either side."""

SPEAKS, SEAL, BITE = N_FAPS, N_FAPS + 1, N_FAPS + 2
N_CHANNELS = N_FAPS + 3
"""What keyframes hold: FAP n at n-1, then how much (0 to 1) the mouth speaks, lips meet, lip meets teeth."""


@dataclass(frozen=True, slots=True)
class Target:
    """A mouth shape and the part of the phone (0 to 1) at which it is reached."""

    at: float
    values: NDArray[np.float64]
    """Shape (N_CHANNELS,), FAP units."""


@dataclass(frozen=True, slots=True)
class PhoneShape:
    """How one phone looks."""

    targets: tuple[Target, ...]
    hold_ms: float
    unstressed: float


@dataclass(frozen=True, slots=True)
class Keyframe:
    """Channels, shape (N_CHANNELS,), that hold at a sample. `rest` keyframes have slope 0."""

    sample: int
    values: NDArray[np.float64]
    rest: bool = False

    @property
    def contact(self) -> bool:
        """Lips meet, or lip meets teeth: it has to be seen."""
        return bool(self.values[SEAL] == 1.0 or self.values[BITE] == 1.0)


def mouth(channels: NDArray[np.float64]) -> Mouth:
    """The speech stream, from its channels, shape (N_CHANNELS,), or (n, N_CHANNELS) at n instants."""
    return Mouth(channels[..., :N_FAPS], channels[..., SPEAKS], channels[..., SEAL], channels[..., BITE])


@cache
def shapes() -> NDArray[np.float64]:
    """The channels of visemes 0-14, shape (15, N_CHANNELS)."""
    table = np.zeros((N_VISEMES, N_CHANNELS))
    table[:, :N_FAPS] = visemes()
    table[1:, SPEAKS] = 1.0
    table[CLOSED, SEAL] = 1.0
    table[BITTEN, BITE] = 1.0
    return table


@cache
def phone_shapes(lang: str) -> dict[str, PhoneShape]:
    """The shape of every phone of a language, by SAMPA name. Raises UnknownLanguage."""
    name = f"visemes_{lang}.tsv"
    known = tuple(file[8:-4] for file in names("motion") if file.startswith("visemes_"))
    if lang not in known:
        raise UnknownLanguage(lang, known)
    shapes = {}
    for number, line in read_lines("motion", name):
        try:
            phone, targets, hold_ms, unstressed = line.split("\t")
            shapes[phone] = PhoneShape(_targets(targets), float(hold_ms), float(unstressed) / 100)
        except (ValueError, IndexError) as e:
            raise DataError(name, number, str(e)) from None
    return shapes


def _targets(text: str) -> tuple[Target, ...]:
    """Targets apart by spaces, at least one, in order of time."""
    parsed = tuple(_target(t) for t in text.split())
    if not parsed or any(not 0 <= t.at <= 1 for t in parsed):
        raise ValueError(f"{text!r}: expected shapes, each @ 0 to 100 percent")
    return parsed


def _target(text: str) -> Target:
    """`V@percent` or `V1/V2:blend@percent`."""
    shape, _, percent = text.partition("@")
    first, _, second = shape.partition("/")
    if not second:
        return Target(float(percent) / 100, shapes()[_viseme(first)])
    number, _, blend = second.partition(":")
    share = int(blend) / FULL
    if not 0 <= share <= 1:
        raise ValueError(f"blend {blend} is not 0 to {FULL}")
    mixed = shapes()[_viseme(first)] * share + shapes()[_viseme(number)] * (1 - share)
    return Target(float(percent) / 100, mixed)


def _viseme(text: str) -> int:
    number = int(text)
    if not 0 <= number < N_VISEMES:
        raise ValueError(f"there is no viseme {number}")
    return number


def keyframes(timed: TimedPhone, lang: str, sample_rate: int) -> Iterator[Keyframe]:
    """The keyframes of one phone, in order, within its samples.

    Each shape is reached at its part of the phone, by default the middle (paper, section 4.2), and
    kept for `hold_ms`, so that a closure is seen at any frame rate in use.
    """
    phone, length = timed.phone, timed.end - timed.start
    if phone.name == SILENCE:
        yield from _pause(timed, sample_rate)
        return
    hold_ms, targets = _stressed(lang, phone.name, phone.stress == 1)
    half_hold = min(hold_ms / 2000 * sample_rate, MAX_HALF_HOLD * length)
    for target in targets:
        middle = timed.start + target.at * length
        if half_hold < 1:
            yield Keyframe(round(middle), target.values)
            continue
        yield Keyframe(round(middle - half_hold), target.values)
        yield Keyframe(round(middle + half_hold), target.values)


@cache
def _stressed(lang: str, name: str, stressed: bool) -> tuple[float, tuple[Target, ...]]:
    """How long a phone's shapes are kept, ms, and what they are with or without stress."""
    shape = phone_shapes(lang).get(name) or phone_shapes(lang)[SILENCE]
    scale = np.ones(N_CHANNELS)
    scale[:N_FAPS] = 1.0 if stressed else shape.unstressed
    return shape.hold_ms, tuple(Target(t.at, t.values * scale) for t in shape.targets)


def _pause(timed: TimedPhone, sample_rate: int) -> Iterator[Keyframe]:
    """The mouth comes to rest."""
    edge = min(REST_MS * sample_rate // 1000, (timed.end - timed.start) // 3)
    yield Keyframe(timed.start + edge, shapes()[0], rest=True)
    yield Keyframe(timed.end - edge, shapes()[0], rest=True)
