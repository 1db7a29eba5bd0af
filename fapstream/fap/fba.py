"""FBA elementary streams (ISO/IEC 14496-2): what encoder and decoder share. Predictive mode, faces only.

How the syntax is read here, where it can be read in more than one way:

- A plane begins with a start code only where one stands; otherwise right behind the last bit of the one
  before it. next_start_code() is a 0 and as many 1 as it takes to the byte boundary, 01111111 on one.
- In a group's mask the least significant bit, sent last, is the group's first FAP.
- New ranges: for each group from 2 on a marker before every fourth FAP, sent or not; then 5 bits for each
  FAP with symbols. They count by 60; a least value is minus that.
- Mask type 2: a FAP left out takes the value of its mirror image on the other side if that is sent, else it
  keeps its own. Positive is outward or upward on both sides, so that values are the same; eyes turn alike.
- FAPs 1 and 2 are not quantised (a select cannot be); their symbols go by the ranges of the standard. Each is
  followed by its flags as plain bits. A run of the arithmetic coder without symbols takes no bits.
- fap_quant 0 is taken for a step of 1 ("lossless") when reading and never written.
- Skipped frames stand before the plane that tells them; the face stays meanwhile.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fapstream.fap.arithmetic import Model
from fapstream.fap.rows import Mask
from fapstream.fap.tables import EXPRESSIONS, FULL, N_VISEMES, coding_ranges, faps
from fapstream.records import N_FAPS

OBJECT_CODE = 0x000001BA
PLANE_CODE = 0x000001BB
END_CODE = 0x000001B1

FACE, BODY = 1, 2
"""Bits of fba_object_mask."""

NONE, KEEP, MIRROR, ALL = range(4)
"""fap_mask_type."""

RANGE_UNIT = 60
MAX_RANGE = 31 * RANGE_UNIT
NTSC = 1000 / 1001

VISEME_RANGES = ((0, N_VISEMES - 1), (0, N_VISEMES - 1), (0, FULL))
EXPRESSION_RANGES = ((0, len(EXPRESSIONS)), (0, FULL)) * 2

GROUPS: tuple[NDArray[np.intp], ...] = tuple(
    np.flatnonzero([f.group == group for f in faps()]) for group in range(1, 11)
)
"""Indices, FAP - 1, of each of the ten groups."""

Ranges = NDArray[np.int32]
"""Of quantised values, shape (2, 68, 2): in I and in P frames, of each FAP, least and largest."""


@cache
def mirror_pairs() -> tuple[tuple[int, int], ...]:
    """Indices of the FAPs that do the same on the left and on the right, by the names of the table."""
    names = {f.name: f.fap - 1 for f in faps()}
    pairs = []
    for name, left in names.items():
        for ours, theirs in (("_l_", "_r_"), ("_lm", "_rm")):
            right = names.get(name.replace(ours, theirs))
            if ours in name and right is not None:
                pairs.append((left, right))
    return tuple(pairs)


def default_ranges() -> Ranges:
    """The decoder's ranges of an I frame that brings none."""
    reach = coding_ranges().T
    return np.stack([-reach, reach], axis=2)


def steps(quant: int) -> NDArray[np.int64]:
    """FAP units of one quantised unit of each FAP, shape (68,)."""
    return np.maximum(np.array([f.quant * quant for f in faps()], np.int64), 1)


@dataclass(slots=True)
class Coding:
    """What an I frame settles until the next one.

    `types` are the groups' mask types; `sent` FAPs have symbols, bool (68,). The rest follows: `source`,
    indices of shape (68,), is where each FAP's value comes from, itself or the FAP that it mirrors; `known`,
    bool (68,), are the FAPs that are sent or mirrored; `coded`, indices, the low-level ones with symbols;
    `steps`, int64 (68,), the FAP units of one quantised unit.
    """

    quant: int
    types: tuple[int, ...]
    sent: Mask
    ranges: Ranges = field(default_factory=default_ranges)
    source: NDArray[np.intp] = field(init=False)
    known: Mask = field(init=False)
    coded: NDArray[np.intp] = field(init=False)
    steps: NDArray[np.int64] = field(init=False)
    _models: dict[tuple[bool, int, int], Model] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.source = _sources(self.types, self.sent)
        self.known = self.sent | (self.source != np.arange(N_FAPS))
        self.coded = np.flatnonzero(self.sent[2:]) + 2
        self.steps = steps(self.quant)

    def model(self, predicted: bool, fap: int) -> Model:
        """Of a low-level FAP, by its index."""
        least, largest = self.ranges[int(predicted), fap].tolist()
        return self._model(predicted, fap, 0, (least, largest))

    def parts(self, predicted: bool, fap: int) -> list[Model]:
        """Of FAP 1 (index 0) or FAP 2 (index 1): one for each of its numbers."""
        ranges = VISEME_RANGES if fap == 0 else EXPRESSION_RANGES
        return [
            self._model(predicted, fap, part, (-most if predicted else least, most))
            for part, (least, most) in enumerate(ranges)
        ]

    def _model(self, predicted: bool, fap: int, part: int, limits: tuple[int, int]) -> Model:
        key = (predicted, fap, part)
        if key not in self._models:
            self._models[key] = Model(*limits)
        return self._models[key]


def _sources(types: tuple[int, ...], sent: Mask) -> NDArray[np.intp]:
    source = np.arange(N_FAPS)
    for left, right in mirror_pairs():
        if types[faps()[left].group - 1] == MIRROR and sent[left] != sent[right]:
            source[[left, right]] = left if sent[left] else right
    return source
