"""A face of which everything is known, and cameras that film it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fapstream.fap import faps
from fapstream.head import Fapu, measure
from fapstream.learn.landmarks import Landmarks, table

Floats = NDArray[np.float64]

LEFT: dict[int, tuple[float, float]] = {
    10: (0, 75), 338: (15, 74), 297: (32, 70), 332: (45, 62), 284: (55, 50), 251: (62, 32), 389: (66, 15),
    356: (68, 0), 454: (69, -15), 168: (0, 5), 6: (0, -3), 197: (0, -12), 195: (0, -21), 5: (0, -30),
    263: (45, 0), 362: (15, -1), 2: (0, -42), 386: (30, 6), 374: (30, -6), 474: (36, 0), 475: (30, 5),
    476: (24, 0), 477: (30, -5), 336: (12, 20), 285: (12, 16), 334: (32, 26), 282: (32, 22), 300: (50, 18),
    276: (50, 14), 152: (0, -105), 199: (0, -90), 13: (0, -60.5), 14: (0, -62), 308: (22, -61.5),
    311: (12, -60.7), 402: (12, -62), 0: (0, -54), 17: (0, -72), 291: (25, -61.5), 269: (14, -55),
    405: (14, -70), 267: (8, -53), 409: (22.5, -60), 270: (19, -57), 375: (22.5, -64.5), 321: (19, -67.5),
    314: (8, -71.5), 415: (20, -61), 310: (17, -60.8), 312: (7, -60.5), 324: (20, -61.9), 318: (17, -62),
    317: (7, -62), 175: (0, -99), 200: (0, -83), 18: (0, -76), 164: (0, -49), 313: (8, -77), 406: (13, -76),
    335: (17, -80), 418: (10, -84), 424: (25, -85), 422: (30, -78), 432: (38, -70), 436: (33, -58),
    427: (45, -58),
}  # fmt: skip
"""Points of the left half and the middle, mm to the subject's left of the middle and above the eyes."""

NOSE = {6: 4.0, 197: 9.0, 195: 14.0, 5: 18.0, 2: 9.0}
"""How far the nose stands out, mm."""

IDS = tuple(row.point for row in table())


def _neutral() -> Floats:
    mirror = {row.point: row.mirror for row in table()}
    points = []
    for point in IDS:
        x, y = LEFT[point] if point in LEFT else LEFT[mirror[point]]
        z = 70 * np.sqrt(max(0.05, 1 - (x / 80) ** 2 - (y / 130) ** 2)) + NOSE.get(point, 0.0)
        points.append((x if point in LEFT else -x, y, z))
    found = np.array(points, dtype=np.float64)
    # upright is: the hairline's middle over the base of the nose
    found[IDS.index(10), 2] = found[IDS.index(2), 2]
    found[:, 2] -= found[IDS.index(33), 2]
    return found


NEUTRAL = _neutral()
"""The face at rest, in the table's order, shape (97, 3), mm; the outer corners of the eyes are 90 apart."""

_DIRECTIONS = {"left": (0, 1), "right": (0, -1), "up": (1, 1), "down": (1, -1), "forward": (2, 1)}


def members(fdp: str) -> list[int]:
    """The rows of the points whose mean a feature point is."""
    return [i for i, row in enumerate(table()) if row.fdp == fdp]


def _fapu() -> Fapu:
    names = {row.fdp for row in table() if row.fdp}
    return measure({name: tuple(NEUTRAL[members(name)].mean(axis=0) / 1000) for name in names})


FAPU = _fapu()


def moved(values: dict[int, Floats]) -> Floats:
    """The face with those FAPs, each of shape (n,), points (n, 97, 3), mm. As the standard defines them:
    feature points go as far in the FAP's direction as it says, times the unit of its distance."""
    n = len(next(iter(values.values())))
    points = np.tile(NEUTRAL, (n, 1, 1))
    for number, track in values.items():
        fap = faps()[number - 1]
        axis, sign = _DIRECTIONS[fap.positive]
        step = sign * 1000 * FAPU.per_unit(fap.unit) * track
        points[:, members(fap.fdp[0]), axis] += step[:, None]
    return points


def turns(rng: np.random.Generator, n: int, most: float = 0.35) -> Floats:
    """Rotations (n, 3, 3) by yaw, pitch and roll of at most so many radians."""
    found = np.empty((n, 3, 3))
    for i, (a, b, c) in enumerate(rng.uniform(-most, most, (n, 3))):
        yaw = np.array([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]])
        pitch = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
        roll = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
        found[i] = yaw @ pitch @ roll
    return found


def filmed(
    points: Floats, rng: np.random.Generator | None = None, fps: float = 25.0, noise_px: float = 0.0
) -> Landmarks:
    """A camera in front of the points (n, 97, 3), pixels; with a generator, the head turns, comes nearer and
    goes about at random in every frame."""
    n = len(points)
    if rng is None:
        seen = 1.5 * points + np.array([200.0, -150.0, 0.0])
    else:
        scale = rng.uniform(1.2, 1.8, (n, 1, 1))
        at = rng.uniform(-30, 30, (n, 1, 3)) + np.array([200.0, -150.0, 0.0])
        seen = scale * np.einsum("nij,npj->npi", turns(rng, n), points) + at
        seen = seen + noise_px * rng.normal(size=seen.shape)
    return Landmarks(seen * np.array([1.0, -1.0, -1.0]), IDS, fps)
