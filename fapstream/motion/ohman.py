"""Ohman's coarticulation: consonants emerge from a carrier that goes from vowel to vowel.

mother-articulatory-head, section 5: p(x, t) = v(x, t) + k_c(t) w_c(x) (c(x) - v(x, t)), where v is the
carrier, c a consonant's target, w how much of it shows whatever the vowels (1: all), and k when it shows (1:
wholly). Consonants are taken in the order of increasing w, each upon what those before it have made. Pauses
have a place of their own in the carrier, and one in which speech is about to begin.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fapstream.data import read_lines
from fapstream.errors import DataError
from fapstream.motion.spline import STEP_S
from fapstream.motion.units import SIL, TimedUnit, features

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Key = tuple[float, str]
"""When the carrier is where, s and the name of a target."""

STEADY, GLIDING = (0.35, 0.65), (0.3, 0.75)
"""At which parts of a vowel the carrier is at its target; of a diphthong, at its two targets."""
SHORT_PAUSE_S = 0.3
RESTED_S, LEAVING_S, READY_S = 0.15, 0.45, 0.1
"""In a pause the carrier is at rest so long after its beginning and until so long before its end, and ready
to speak so long before its end."""
READY = "ready"
MARGIN_S = 0.5
"""No consonant shows so long before it begins or after it ends."""

PLACE, RISE, FALL, HOLD = range(4)
"""Columns of a curve: where in the consonant its middle is (a part), how long it comes and goes (s), and how
long it stays whole on either side of the middle (a part)."""


@dataclass(frozen=True, slots=True)
class Ohman:
    """`targets`: the carrier's, by name, `values`, shape (targets, n). Of `consonants`, by name: `weight` (w)
    and `target` (c), shape (consonants, n), and `curve` (k), shape (consonants, n, 4)."""

    targets: tuple[str, ...]
    values: Floats
    consonants: tuple[str, ...]
    weight: Floats
    target: Floats
    curve: Floats


class OhmanMouth:
    """See `MouthModel`. Raises DataError for units that the model has nothing to stand in for."""

    look_ahead = 4

    def __init__(self, model: Ohman) -> None:
        self._model = model
        self._target = {name: row for row, name in enumerate(model.targets)}
        known = {name: row for row, name in enumerate(model.consonants)}
        self._consonant = {u: known[stand_in(u, known)] for u in features() if is_consonant(u)}
        wanted = {
            name for u in features() if not is_consonant(u) for _, name in keys(TimedUnit(u, 0, 1), 1, True)
        }
        self._target = {name: self._target[stand_in(name, self._target)] for name in wanted | {SIL, READY}}

    def parameters(self, units: Sequence[TimedUnit], of: Ints, first: int, rate: int) -> Floats:
        """See `MouthModel`."""
        t = np.arange(first, first + len(of), dtype=np.float64) * STEP_S
        limit = of + self.look_ahead
        p = self._carrier(units, limit, t, rate)
        shown = [i for i, unit in enumerate(units) if unit.name in self._consonant and _shows(unit, t, rate)]
        if not shown:
            return p
        rows = [self._consonant[units[i].name] for i in shown]
        times = np.array([(units[i].start, units[i].end) for i in shown]) / rate
        weight = self._model.weight[rows]
        much = emergence(t, times, self._model.curve[rows]) * weight
        much *= (np.array(shown) <= limit[:, None])[..., None]
        order = np.argsort(weight, axis=0, kind="stable")
        target = np.take_along_axis(self._model.target[rows], order, axis=0)
        return emerged(p, np.take_along_axis(much, order[None], axis=1), target)

    def _carrier(self, units: Sequence[TimedUnit], limit: Ints, t: Floats, rate: int) -> Floats:
        """From vowel to vowel, as far as each instant may look; ready to speak while none is in sight."""
        places: list[Key] = []
        upto = []
        for i, unit in enumerate(units):
            places += keys(unit, rate, i + 1 < len(units))
            upto.append(len(places))
        known = np.array(upto)[np.minimum(limit, len(units) - 1)]
        found: Floats = np.tile(self._model.values[self._target[READY]], (len(t), 1))
        if (some := known > 0).any():
            values = self._model.values[[self._target[name] for _, name in places]]
            times = np.array([time for time, _ in places])
            found[some] = interpolation(times, t[some], known[some] - 1) @ values
        return found


def emerged(carrier: Floats, shown: Floats, target: Floats) -> Floats:
    """The carrier (t, n) with consonants upon it, in order: `shown` is k w, shape (t, consonants, n),
    `target` (consonants, n)."""
    p = carrier
    for i in range(shown.shape[1]):
        p = p + shown[:, i] * (target[i] - p)
    return p


def emergence(t: Floats, times: Floats, curve: Floats) -> Floats:
    """k of consonants at times (c, 2) with curves (c, n, 4), shape (t, c, n): up softly, whole, down
    softly."""
    length = (times[:, 1] - times[:, 0])[:, None]
    middle = times[:, :1] + curve[..., PLACE] * length
    since = t[:, None, None] - middle
    hold = curve[..., HOLD] * length
    rise, fall = curve[..., RISE], curve[..., FALL]
    return soft((since + hold + rise) / rise) * soft((fall + hold - since) / fall)


def soft(x: Floats) -> Floats:
    """0 up to 0, 1 from 1 on, and 3x^2 - 2x^3 between."""
    x = np.clip(x, 0.0, 1.0)
    return x * x * (3 - 2 * x)


def interpolation(places: Floats, t: Floats, last: Ints | None = None) -> Floats:
    """How much of the value at each place (s, ascending) is in that at each time, shape (t, places).

    `last`: shape (t,), the place beyond which a time does not look.
    """
    last = np.full(len(t), len(places) - 1) if last is None else last
    weights = np.zeros((len(t), len(places)))
    rows = np.arange(len(t))
    before = np.clip(np.searchsorted(places, t, side="right") - 1, 0, last)
    after = np.minimum(before + 1, last)
    width = np.maximum(places[after] - places[before], 1e-6)
    share = soft((t - places[before]) / width)
    weights[rows, after] = share
    weights[rows, before] += 1 - share
    return weights


def keys(unit: TimedUnit, rate: int, followed: bool) -> list[Key]:
    """Where the carrier is in a unit; a pause that nothing follows, as far as is known, makes ready for
    nothing."""
    start, end = unit.start / rate, unit.end / rate
    if unit.name == SIL:
        return _pause(start, end, followed)
    of = features()[unit.name]
    if "vowel" not in of:
        return []
    if "diphthong" in of:
        return [(start + part * (end - start), f"{unit.name}:{i}") for i, part in enumerate(GLIDING, 1)]
    return [(start + part * (end - start), unit.name) for part in STEADY]


def _pause(start: float, end: float, followed: bool) -> list[Key]:
    if end - start < SHORT_PAUSE_S:
        return [((start + end) / 2, READY if followed else SIL)]
    rested = start + RESTED_S
    found = [(rested, SIL), (max(rested, end - LEAVING_S), SIL)]
    return [*found, (end - READY_S, READY)] if followed else found


def is_consonant(unit: str) -> bool:
    """Neither vowel nor silence."""
    return "consonant" in features()[unit]


def _shows(unit: TimedUnit, t: Floats, rate: int) -> bool:
    return bool(unit.end / rate > t[0] - MARGIN_S and unit.start / rate < t[-1] + MARGIN_S)


def stand_in(name: str, known: dict[str, int]) -> str:
    """The name itself, or what stands in for it where people were not heard to say it: the same vowel with or
    without stress, what data/stand_ins.tsv has, or what has most in common with it. Raises DataError."""
    phone, _, part = name.partition(":")
    base = phone.rstrip("01")
    bases = [base, *_stand_ins().get(base, ())]
    for candidate in bases:
        for digit in (phone[len(base) :], "1", "0", ""):
            for suffix in (f":{part}" if part else "", ":1", ""):
                if (found := f"{candidate}{digit}{suffix}") in known:
                    return found
    like = max(known, key=lambda other: _alike(phone, other), default=None)
    if like is None or not _alike(phone, like):
        raise DataError("stand_ins.tsv", None, f"nothing that the model knows stands in for {name}")
    return like


def _alike(unit: str, other: str) -> int:
    """How much two units have in common; vowels and consonants nothing."""
    one, two = (features().get(u.partition(":")[0], frozenset()) for u in (unit, other))
    kind = {"vowel", "consonant"}
    return len(one & two) if one & two & kind else 0


def _stand_ins() -> dict[str, tuple[str, ...]]:
    """Of phones, in order of likeness."""
    table = {}
    for number, line in read_lines("motion", "stand_ins.tsv"):
        phone, tab, others = line.partition("\t")
        if not tab or not others.split():
            raise DataError("stand_ins.tsv", number, "expected a phone and those that stand in for it")
        table[phone] = tuple(others.split())
    return table
