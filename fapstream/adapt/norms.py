"""Each FAP brought to the letter of the standard: at its feature point it moves FAP times FAPU along its
axis.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fapstream.fap.tables import faps
from fapstream.head.mesh import FatEntry, Head

Floats = NDArray[np.float64]

AXES: Mapping[str, tuple[float, float, float]] = {
    "up": (0.0, 1.0, 0.0), "down": (0.0, -1.0, 0.0), "left": (1.0, 0.0, 0.0), "right": (-1.0, 0.0, 0.0),
    "forward": (0.0, 0.0, 1.0),
}  # fmt: skip
MOST = 3.0
"""A table is made at most so many times larger or smaller."""
EYES = {"3.5": "eye_l", "3.6": "eye_r"}
TEETH = {"9.8": "teeth_upper", "9.10": "teeth_upper", "9.9": "teeth_lower", "9.11": "teeth_lower"}
THRUSTS = {27: "3.5", 28: "3.6"}
"""Where FAPs are measured that the standard ties to no feature point."""
STEP_M, STEPS = 4e-5, 1000
"""Displacements are stored no finer than the first, or than the largest over the second: they pack better
so.
"""


def part_of(point: str) -> str:
    """The part that a feature point lies on, if the head has it; else the skin."""
    if point.startswith("6."):
        return "tongue"
    return EYES.get(point) or TEETH.get(point) or "skin"


def normed(head: Head, generic: Head) -> Head:
    """`head` with its tables scaled; `generic` is the head that it was carried over from, table by table."""
    scales = {}
    for fap in {entry.faps[0] for entry in head.fat if len(entry.drive) == 1}:
        scales[fap] = _scale_at_point(head, fap) or _scale_by_size(head, generic, fap)
    fat = []
    for entry in head.fat:
        if len(entry.drive) == 1:
            knots, factors = scales[entry.faps[0]]
            factor = np.interp(entry.knots, knots, factors)
            entry = stored(entry, entry.deltas * (entry.scale * factor)[:, None, None])
        fat.append(entry)
    return replace(head, fat=tuple(fat))


def _scale_at_point(head: Head, fap: int) -> tuple[Floats, Floats] | None:
    """Knots of a FAP and the factors there that make its feature point obey; None where there is none to
    measure.
    """
    row = faps()[fap - 1]
    point = THRUSTS.get(fap) or (row.fdp[0] if row.fdp else "")
    if row.positive not in AXES or row.unit == "AU" or point not in head.fdp:
        return None
    part = part_of(point)
    for entry in head.fat:
        if entry.drive == ((fap, 1.0),) and entry.part == part:
            gap = np.linalg.norm(head.part(part).positions[entry.indices] - head.fdp[point], axis=1)
            along = entry.deltas[:, int(gap.argmin())] @ np.array(AXES[row.positive]) * entry.scale
            wanted = np.array(entry.knots) * head.fapu.per_unit(row.unit)
            good = np.abs(along) * MOST > np.abs(wanted)
            factors = np.where(good, wanted / np.where(good, along, 1.0), 1.0)
            return np.array(entry.knots), np.clip(factors, 1 / MOST, MOST)
    return None


def _scale_by_size(head: Head, generic: Head, fap: int) -> tuple[Floats, Floats]:
    """One factor for a FAP without a point to measure at: pupils grow as their unit does, angles stay."""
    unit = faps()[fap - 1].unit
    if unit == "AU":
        return np.zeros(1), np.ones(1)
    wanted = head.fapu.per_unit(unit) / generic.fapu.per_unit(unit)
    pairs = [(a, b) for a, b in zip(head.fat, generic.fat, strict=True) if a.drive == ((fap, 1.0),)]
    grown = sum(_size(a) for a, _ in pairs) / max(sum(_size(b) for _, b in pairs), 1e-12)
    return np.zeros(1), np.array([float(np.clip(wanted / max(grown, 1e-12), 1 / MOST, MOST))])


def _size(entry: FatEntry) -> float:
    return float(np.linalg.norm(entry.deltas.astype(np.float64)) * entry.scale)


def stored(entry: FatEntry, moves: Floats) -> FatEntry:
    """The entry with other displacements, (k, n, 3) metres."""
    most = float(np.abs(moves).max(initial=0))
    scale = float(f"{max(most / 32000, min(STEP_M, most / STEPS), 1e-9):.4g}")
    return replace(entry, deltas=np.rint(moves / scale).astype(np.int16), scale=scale)
