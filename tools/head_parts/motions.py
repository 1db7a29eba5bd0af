"""The low-level FAPs of lids, brows, cheeks, eyes, nose and ears. Decimetres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from head_parts.bust import Bust, Eye
from head_parts.features import IRIS_RAD, PUPIL_RAD
from head_parts.fields import Motion, Skin, Unit, X, Y, Z, cardinal
from head_parts.jaw import Jaw
from head_parts.lips import Lips
from head_parts.surface import Array
from head_parts.teeth import Bite
from head_parts.tongue import Tongue


@dataclass
class Model:
    """What the motions are made from. `points` are fine skin vertices by FDP name."""

    bust: Bust
    lips: Lips
    jaw: Jaw
    bite: Bite
    tongue: Tongue
    points: dict[str, int]
    unit: Unit

    @property
    def skin(self) -> Skin:
        return self.bust.skin


LID_KNOTS, LAP_RAD = (-512, 400, 750, 1024), 0.035


class Lids:
    """Lids turn about the line through the eye's centre, so they keep to the ball."""

    def __init__(self, model: Model, side: str) -> None:
        self.model, self.side = model, side
        self.eye: Eye = model.bust.eyes[side]
        names = ("3.1", "3.3") if side == "l" else ("3.2", "3.4")
        self.middle = [model.points[name] for name in names]
        self.faps = (19, 21) if side == "l" else (20, 22)
        self.fields = self._fields()

    def elevation(self, points: Array) -> Array:
        """Angle of points above the eye's equator, about the x axis through its centre."""
        return np.arctan2(points[:, 1] - self.eye.centre[1], points[:, 2] - self.eye.centre[2])

    def _fields(self) -> Array:
        """Closing angles (n, 2) of the skin: upper lid down to the lower margin, lower up to the upper."""
        skin, eye = self.model.skin, self.eye
        upper, lower = skin.points[eye.upper], skin.points[eye.lower]
        up, low = self.elevation(upper), self.elevation(lower)
        # beside its middle, where the feature point is exact, a lid closes a little further than it need
        lap = [LAP_RAD * np.minimum(np.abs(row[:, 0] - eye.centre[0]) / 0.015, 1) for row in (upper, lower)]
        close = np.maximum(up - _along(upper[:, 0], lower[:, 0], low) + lap[0], 0)
        open_ = np.maximum(_along(lower[:, 0], upper[:, 0], up) - low + lap[1], 0)
        offset = skin.points - eye.centre
        near = np.linalg.norm(offset * (0.72, 1.0, 1.0), axis=1)
        free = (near < 0.255) & (offset[:, 2] > -0.05)
        handles = [
            (eye.upper, np.stack([close, np.zeros_like(close)], 1)),
            (eye.lower, np.stack([np.zeros_like(open_), open_], 1)),
        ]
        return np.clip(skin.solve(free, handles, harmonic=60.0), 0, None)

    def turned(self, points: Array, angles: Array) -> Array:
        """Displacement (n, 3) of points turned down by `angles` (n,) about the eye's axis."""
        y, z = points[:, 1] - self.eye.centre[1], points[:, 2] - self.eye.centre[2]
        c, s = np.cos(angles), np.sin(angles)
        return np.stack([np.zeros(len(points)), c * y - s * z - y, s * y + c * z - z], 1)

    def motions(self, lashes: Array) -> list[Motion]:
        """FAP 19/20 and 21/22 on the skin and on the lashes (n, 3), which hang on the nearest margin."""
        skin = self.model.skin
        margin = np.concatenate([self.eye.upper, self.eye.lower])
        gap = np.linalg.norm(lashes[:, None] - skin.points[margin][None], axis=2)
        roots = margin[np.argmin(gap, 1)]
        out = []
        for k, (fap, sign) in enumerate(zip(self.faps, (1.0, -1.0), strict=True)):
            shares = self._shares(k, sign)
            angles = self.fields[:, k] * sign
            out.append(
                Motion(fap, "skin", LID_KNOTS, tuple(self.turned(skin.points, angles * a) for a in shares))
            )
            lash = tuple(self.turned(lashes, angles[roots] * a) for a in shares)
            out.append(Motion(fap, f"lashes_{self.side}", LID_KNOTS, lash))
        return out

    def _shares(self, which: int, sign: float) -> list[float]:
        """How much of full closure each knot is, so that the feature point moves as the standard says."""
        point = self.model.skin.points[self.middle[which]][None]
        angle = self.fields[self.middle[which], which] * sign

        def off(share: float, knot: int) -> float:
            moved = self.turned(point, np.array([angle * share]))[0, 1]
            return float(moved + sign * knot * self.model.unit["IRISD"])

        return [brentq(off, -1.6, 1.6, args=(knot,)) for knot in LID_KNOTS]


def _along(where: Array, x: Array, values: Array) -> Array:
    order = np.argsort(x)
    return np.interp(where, x[order], values[order])


BROW_NODES = ("4.1", "4.3", "4.5")


def brow_motions(model: Model) -> list[Motion]:
    """FAPs 31-38: each brow a curve through its three points."""
    out = []
    for side in "lr":
        sign = 1.0 if side == "l" else -1.0
        names = BROW_NODES if side == "l" else tuple(f"4.{2 * i}" for i in (1, 2, 3))
        fields = _brow_fields(model, [model.points[name] for name in names], sign)
        faps = (31, 33, 35) if side == "l" else (32, 34, 36)
        for k, fap in enumerate(faps):
            out.append(_surface(model, fap, fields[:, k], Y, 600 * model.unit["ENS"]))
        out.append(
            _surface(model, 37 if side == "l" else 38, fields[:, 3], -X * sign, 600 * model.unit["ES"])
        )
    return out


def _brow_fields(model: Model, nodes: list[int], sign: float) -> Array:
    skin = model.skin
    line = skin.points[nodes]
    x = skin.points[:, 0] * sign
    at = np.abs(line[:, 0])
    height = np.interp(x, at, line[:, 1])
    on = (np.abs(skin.points[:, 1] - height) < 0.035) & (x > at[0] - 0.02) & (x < at[2] + 0.11)
    on &= skin.normals[:, 2] > 0.1
    line_vertices = np.union1d(np.flatnonzero(on), nodes)
    places = np.abs(skin.points[line_vertices, 0])
    values = np.stack(
        [cardinal(at, k, places) for k in range(3)] + [np.interp(places, at, [1.0, 0.55, 0.1])], 1
    )
    for k, node in enumerate(nodes):
        values[line_vertices == node, :3] = np.eye(3)[k]
    values[line_vertices == nodes[0], 3] = 1.0
    eye = model.bust.eyes["l" if sign > 0 else "r"]
    lid = np.linalg.norm((skin.points - eye.centre) * (0.8, 1, 0.8), axis=1) < 0.185
    free = skin.near(np.array(nodes), 0.42) & ~lid & (x > -0.08)
    return skin.solve(free, [(line_vertices, values)], harmonic=20.0)


def _surface(model: Model, fap: int, field: Array, axis: Array, amount: float, knot: int = 600) -> Motion:
    """A motion along the skin: at each vertex in its tangent plane, `field` along `axis`."""
    normal = model.skin.normals
    flat = axis - (normal @ axis)[:, None] * normal
    along = np.clip((flat * axis).sum(1), 0.45, 1)[:, None]
    return Motion(fap, "skin", (knot,), (field[:, None] * flat / along * amount,))


def patch_motions(model: Model) -> list[Motion]:
    """FAPs 18, 61-64: a smooth patch about one feature point each."""
    skin, unit, p = model.skin, model.unit, model.points
    lips = np.concatenate([skin.outer.vertices, skin.inner.vertices])
    rows = [(18, "2.10", 0.20, Y, "MNS", "along"), (63, "9.3", 0.20, Y, "ENS", "plain"),
            (64, "9.3", 0.20, -X, "ENS", "plain")]  # fmt: skip
    for k, sign in ((0, 1.0), (1, -1.0)):
        rows.append((61 + k, f"9.{1 + k}", 0.13, X * sign, "ENS", "out"))
    out = []
    for fap, name, radius, axis, measure, way in rows:
        vertex = p[name]
        free = skin.near(np.array([vertex]), radius)
        centre = np.flatnonzero(skin.near(np.array([vertex]), radius * 0.12))
        handles = [(lips, np.zeros((len(lips), 1))), (np.union1d(centre, [vertex]), np.ones((1, 1)))]
        field = np.clip(skin.solve(free, handles)[:, 0], -0.05, 1.05)
        amount = 300 * unit[measure]
        if way == "along":
            out.append(_surface(model, fap, field, axis, amount, 300))
            continue
        direction = axis if way == "plain" else skin.outward(vertex, axis)
        out.append(Motion(fap, "skin", (300,), (field[:, None] * direction * amount,)))
    return out


def ear_motions(model: Model, ears: Array) -> list[Motion]:
    """FAPs 65-68. `ears` (n,): 1 on the ears, 0 elsewhere, soft between."""
    skin, amount = model.skin, 300 * model.unit["ENS"]
    out = []
    for k, sign in ((0, 1.0), (1, -1.0)):
        field = np.where(skin.points[:, 0] * sign > 0, ears, 0)
        top, back = model.points[f"10.{1 + k}"], model.points[f"10.{3 + k}"]
        front = skin.points[field > 0.5, 2].max()
        swing = np.clip((front - skin.points[:, 2]) / (front - skin.points[back, 2]), 0, 1.2) * field
        out.append(Motion(65 + k, "skin", (300,), (field[:, None] / field[top] * Y * amount,)))
        out.append(Motion(67 + k, "skin", (300,), (swing[:, None] / swing[back] * X * sign * amount,)))
    return out


def eye_motions(eye: Eye, side: str, part: str, points: Array, unit: Unit) -> list[Motion]:
    """FAPs 27-30 on a part of the eye: the ball forward, and the pupil's growth within the iris."""
    first = 0 if side == "l" else 1
    out = [Motion(27 + first, part, (200,), (np.tile(Z * 200 * unit["ES"], (len(points), 1)),))]
    if part.startswith("eye"):
        offset = points - eye.centre
        radial = offset * (1, 1, 0)
        length = np.linalg.norm(radial, axis=1)
        theta = np.arctan2(length, offset[:, 2])
        inside = np.minimum(theta / PUPIL_RAD, 1) * np.clip((IRIS_RAD - theta) / (IRIS_RAD - PUPIL_RAD), 0, 1)
        outward = radial / np.maximum(length, 1e-9)[:, None]
        out.append(Motion(29 + first, part, (200,), (outward * inside[:, None] * 100 * unit["IRISD"],)))
    return out
