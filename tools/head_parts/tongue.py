"""The tongue: a body on a midline curve, and FAPs 43-47 as its bending, stretching and rolling. Decimetres.

The midline lies in the sagittal plane from the root (t = 0) to the tip (t = 1); each ring of vertices is a
section across it. Bending turns the sections one after another and so keeps the tongue's length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from head_parts.features import Mesh, facing, grid
from head_parts.fields import Motion, Unit
from head_parts.surface import Array, Ints

RINGS, AROUND = 18, 16
WIDTH = ((0.0, 0.55), (0.3, 0.95), (0.55, 1.0), (0.8, 0.92), (1.0, 0.80))
"""Half width along the tongue, shares of the widest."""
TOP = ((0.0, 0.05), (0.4, 0.075), (0.7, 0.055), (1.0, 0.028))
BOTTOM = ((0.0, 0.10), (0.4, 0.12), (0.7, 0.075), (1.0, 0.030))
ROUND_FROM = 0.72
"""Where the blade begins to narrow towards the tip."""
BODY_AT, BORDER_AT = 0.62, 0.80
"""Where along the tongue the feature points 6.2 and 6.3, 6.4 are."""


@dataclass(frozen=True)
class Tongue:
    """`midline` (rings + 1, 2) are (z, y), the last the tip itself; vertex i is on `ring[i]`.

    `local` (n, 2): across (x) and along the section's upward normal.
    """

    mesh: Mesh
    midline: Array
    along: Array
    ring: Ints
    local: Array

    @classmethod
    def grown(cls, joints: Array, tip: Array, half_width: float) -> Tongue:
        """On the source's joints (4, 3) from the root to near the tip; ends at `tip` (3,)."""
        knots = np.concatenate([joints[:3, [2, 1]], tip[None, [2, 1]]])
        path = CubicSpline(np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(knots, axis=0), axis=1))], knots)
        along = 1 - (1 - np.linspace(0, 1, RINGS + 1)) ** 1.35
        midline = path(along * path.x[-1])
        end = np.clip((along[:-1] - ROUND_FROM) / (1 - ROUND_FROM), 0, 1)
        blunt = (1 - end**2.6) ** (1 / 2.6)
        turn = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
        x = half_width * (_table(WIDTH, along[:-1]) * blunt)[:, None] * _power(np.cos(turn), 0.8)
        top, bottom = (_table(rows, along[:-1])[:, None] for rows in (TOP, BOTTOM))
        high = np.where(np.sin(turn) > 0, top, bottom) * np.sqrt(blunt)[:, None] * _power(np.sin(turn), 0.9)
        groove = 0.016 * np.exp(-((x / 0.035) ** 2)) * np.clip(2 - 2 * end, 0, 1)[:, None]
        high -= np.where(np.sin(turn) > 0.5, groove, 0)
        ring = np.r_[np.repeat(np.arange(RINGS), AROUND), RINGS]
        local = np.concatenate([np.stack([x, high], -1).reshape(-1, 2), np.zeros((1, 2))])
        points = _placed(midline, np.zeros(RINGS + 1), ring, local)
        return cls(_skinned(points), midline, along, ring, local)

    @property
    def t(self) -> Array:
        """How far along the tongue each vertex is (n,)."""
        found: Array = self.along[self.ring]
        return found

    @property
    def tip(self) -> int:
        return len(self.ring) - 1

    @property
    def body(self) -> int:
        """The vertex of feature point 6.2, on the back of the tongue."""
        return self._on_ring(BODY_AT, AROUND // 4)

    @property
    def borders(self) -> tuple[int, int]:
        """The vertices of 6.3 and 6.4."""
        return self._on_ring(BORDER_AT, 0), self._on_ring(BORDER_AT, AROUND // 2)

    def _on_ring(self, place: float, column: int) -> int:
        return int(np.argmin(np.abs(self.along[:-1] - place))) * AROUND + column

    def bent(self, angles: Array) -> Array:
        """Displacement (n, 3) when each section (rings + 1,) is turned up by an angle, radians."""
        return _placed(self.midline, angles, self.ring, self.local) - self.mesh.points

    def motions(self, unit: Unit) -> list[Motion]:
        """FAPs 43-47."""
        makers = (self._shift, self._raise_tip, self._thrust, self._raise, self._roll)
        return [make(unit) for make in makers]

    def _raise_tip(self, unit: Unit) -> Motion:
        knots = (-600, -300, 300, 600, 900)
        bend = _smooth(0.30, 1.0, self.along)
        moves = []
        for knot in knots:
            off = lambda a, knot=knot: self.bent(a * bend)[self.tip, 1] - knot * unit["MNS"]  # noqa: E731
            moves.append(self.bent(brentq(off, -1.6, 1.6) * bend))
        return Motion(44, "tongue", knots, tuple(moves))

    def _shift(self, unit: Unit) -> Motion:
        bend = _smooth(0.25, 1.0, self.along) ** 1.3
        length = np.r_[0, np.cumsum(np.linalg.norm(np.diff(self.midline, axis=0), axis=1))]
        moves = []
        for knot in (-400, 400):
            aside = -knot * unit["MW"] * bend
            slope = np.arctan(np.gradient(aside, length))
            x = self.local[:, 0]
            move = np.zeros_like(self.mesh.points)
            move[:, 0] = aside[self.ring] + x * (np.cos(slope)[self.ring] - 1)
            move[:, 2] = -x * np.sin(slope)[self.ring]
            moves.append(move)
        return Motion(43, "tongue", (-400, 400), tuple(moves))

    def _thrust(self, unit: Unit) -> Motion:
        """Forward, first up over the lower teeth, then drooping; longer is narrower."""
        knots, lift, narrow = (-300, 250, 800), (0.0, 0.05, -0.02), (0.06, -0.04, -0.16)
        t = self.t
        reach = 0.15 * t + 0.85 * t**2
        moves = []
        for knot, up, wide in zip(knots, lift, narrow, strict=True):
            move = np.zeros_like(self.mesh.points)
            move[:, 2] = reach * knot * unit["MW"]
            move[:, 1] = up * _smooth(0.45, 0.9, t)
            move[:, 0] = self.local[:, 0] * wide * _smooth(0.2, 0.6, t)
            moves.append(move)
        return Motion(45, "tongue", knots, tuple(moves))

    def _raise(self, unit: Unit) -> Motion:
        t = self.t
        hump = np.exp(-(((t - t[self.body]) / 0.26) ** 2)) * _smooth(0, 0.25, t) * (1 - 0.7 * t**6)
        move = np.zeros_like(self.mesh.points)
        move[:, 1] = hump / hump[self.body] * 400 * unit["MNS"]
        move[:, 0] = -0.10 * self.local[:, 0] * hump
        return Motion(46, "tongue", (400,), (move,))

    def _roll(self, unit: Unit) -> Motion:
        """The borders turn up about the middle of the tongue; each knot an arc, for a rotation is no line."""
        knots = (25000, 50000, 75000, 100000, 125000, 150000)
        x, y = self.mesh.points[:, 0], self.mesh.points[:, 1]
        left = self.borders[0]
        part = np.clip(np.abs(x) / x[left], 0, 1.15) * _smooth(0.30, BORDER_AT - 0.02, self.t)
        moves = []
        for knot in knots:
            angle = knot * unit["AU"] * part * np.sign(x)
            height = y - (y[left] + self.midline[self.ring, 1] - self.midline[self.ring[left], 1])
            c, s = np.cos(angle), np.sin(angle)
            moves.append(np.stack([c * x - s * height - x, s * x + c * height - height, 0 * x], 1))
        return Motion(47, "tongue", knots, tuple(moves))


def _placed(midline: Array, angles: Array, ring: Ints, local: Array) -> Array:
    """Vertices (n, 3) of sections turned by `angles` on the midline turned with them."""
    steps = np.diff(midline, axis=0)
    middle = (angles[:-1] + angles[1:]) / 2
    turned = np.stack(
        [np.cos(middle) * steps[:, 0] - np.sin(middle) * steps[:, 1],
         np.sin(middle) * steps[:, 0] + np.cos(middle) * steps[:, 1]], 1,
    )  # fmt: skip
    line = np.concatenate([midline[:1], midline[0] + np.cumsum(turned, 0)])
    ahead = np.gradient(midline, axis=0)
    slope = (np.arctan2(ahead[:, 1], ahead[:, 0]) + angles)[ring]
    z = line[ring, 0] - np.sin(slope) * local[:, 1]
    y = line[ring, 1] + np.cos(slope) * local[:, 1]
    return np.stack([local[:, 0], y, z], 1)


def _skinned(points: Array) -> Mesh:
    body = grid(points[:-1].reshape(RINGS, AROUND, 3), np.zeros((RINGS, AROUND, 2)), closed=True)
    last = np.arange(AROUND) + (RINGS - 1) * AROUND
    cap = np.stack([last, np.roll(last, -1), np.full(AROUND, len(points) - 1)], 1)
    # the cap runs on in the winding of the grid's own triangles
    first = body.triangles[0]
    cap = cap if first[1] == first[0] + 1 else cap[:, ::-1]
    mesh = Mesh(points, np.zeros((len(points), 2)), np.concatenate([body.triangles, cap]))
    return facing(mesh, points - points.mean(0))


def _smooth(low: float, high: float, value: Array) -> Array:
    t = np.clip((value - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def _table(rows: tuple[tuple[float, float], ...], at: Array) -> Array:
    """A smooth curve through (place, value) rows."""
    x, y = np.array(rows).T
    found: Array = CubicSpline(x, y, bc_type="natural")(at)
    return found


def _power(value: Array, exponent: float) -> Array:
    return np.sign(value) * np.abs(value) ** exponent
