"""Units in context, and what decision trees may ask about them: what the unit and its neighbours are."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fapstream.motion.units import features

Answers = NDArray[np.bool_]


class Context(NamedTuple):
    """A unit between two others: a triphone (speech-enabled-avatars, section 3.4)."""

    before: str
    unit: str
    after: str


@cache
def asked() -> tuple[str, ...]:
    """The features that questions are about, in order."""
    return tuple(sorted(frozenset().union(*features().values())))


@cache
def _row(unit: str) -> Answers:
    return np.array([feature in features()[unit] for feature in asked()])


@cache
def questions() -> tuple[tuple[int, str], ...]:
    """Of every question whom it is about (-1 the unit before, 0 itself, 1 the unit after), and the
    feature."""
    return tuple((place, feature) for place in (-1, 0, 1) for feature in asked())


def answers(context: Context) -> Answers:
    """To every question, shape (questions,)."""
    return np.concatenate([_row(unit) for unit in context])
