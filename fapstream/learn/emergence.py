"""When consonants show: k of Ohman's formula, as it is measured, and the curve that stands for it.

mother-articulatory-head, section 5.1. Over all instances of a consonant, with D = w (c - v) the way from the
carrier to the consonant's target, k(t) = sum D (p - v) / sum D^2 is the least-squares part of it that is gone
at a time; a parametric curve stylises it.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from fapstream.motion.ohman import emergence

Floats = NDArray[np.float64]

REACH_S, STEP_S = 0.2, 0.01
AXIS = np.linspace(-REACH_S, REACH_S, 2 * round(REACH_S / STEP_S) + 1)
"""Times from a consonant's middle, s."""
PLACES, FLANKS_S, HOLDS = (0.3, 0.4, 0.5, 0.6, 0.7), (0.04, 0.07, 0.1, 0.14, 0.19), (0.0, 0.1, 0.2, 0.3)
"""What curves are tried."""


@dataclass(frozen=True, slots=True)
class Emergence:
    """`k`: shape (times, n), 0 to 1, at AXIS; `sure`: shape (times, n), sum D^2, how well it is known;
    `length`: the consonant's mean length, s."""

    k: Floats
    sure: Floats
    length: float


def measured(
    instances: Iterable[tuple[Floats, Floats, float, float]], weight: Floats, target: Floats
) -> Emergence:
    """Of one consonant. Each instance: the carrier and what was measured, shape (t, n), 100 frames a second,
    and where in them the consonant begins and ends, in frames; `weight`, `target`: shape (n,)."""
    over, under, lengths = np.zeros((len(AXIS), len(weight))), np.zeros((len(AXIS), len(weight))), []
    for carrier, parameters, begin, end in instances:
        at = np.rint((begin + end) / 2 + AXIS / STEP_S).astype(int)
        inside = (at >= 0) & (at < len(carrier))
        v, p = carrier[at[inside]], parameters[at[inside]]
        way = weight * (target - v)
        over[inside] += way * (p - v)
        under[inside] += way**2
        lengths.append((end - begin) * STEP_S)
    k = np.clip(over / np.maximum(under, 1e-9), 0.0, 1.0)
    return Emergence(k, under, float(np.mean(lengths)) if lengths else 0.1)


def stylised(found: Emergence) -> Floats:
    """The curve, (n, 4), nearest to what was measured, of those that are tried."""
    tried = np.array([(p, r, f, h) for p, r, f, h in product(PLACES, FLANKS_S, FLANKS_S, HOLDS)])
    times = np.array([[-found.length / 2, found.length / 2]])
    shapes = emergence(AXIS, times, tried[None])[:, 0]
    error = (found.sure[..., None] * (shapes[:, None] - found.k[..., None]) ** 2).sum(axis=0)
    best: Floats = tried[error.argmin(axis=1)]
    return best
