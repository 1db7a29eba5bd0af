"""The lips' FAPs 4-13, 16, 17 and 51-60, and what goes with them in the cheeks. Decimetres."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from head_parts.fields import Contour, Motion, Skin, Unit, X, Y, Z, cardinal
from head_parts.surface import Array

Shape = Callable[[Contour], Array]
"""The values of a field on one contour, by its vertices' places."""
Bone = Callable[[Array, float], Array]
"""Displacement of points (n, 3) fixed to the jaw's bone, opened by an angle."""

LIP_NODES = (-1.0, -0.5, 0.0, 0.5, 1.0)
LIP_FAPS = {
    # (contour, upper) -> {node: FAP}; node 0 is the right corner, 4 the left
    ("inner", True): {1: 9, 2: 4, 3: 8},
    ("inner", False): {1: 11, 2: 5, 3: 10},
    ("outer", True): {1: 56, 2: 51, 3: 55},
    ("outer", False): {1: 58, 2: 52, 3: 57},
}
CORNER_FAPS = {"inner": {4: 12, 0: 13}, "outer": {4: 59, 0: 60}}
STRETCH_FAPS = {"inner": {4: 6, 0: 7}, "outer": {4: 53, 0: 54}}
DOWN = {4, 8, 9, 51, 55, 56}
LOWER = {5, 10, 11, 52, 57, 58}
NEAR, WIDE = 0.24, 0.42
"""Reach of a lip's own FAPs and of the corners', from the outer contour."""
DROP_KNOTS, KNOT = (-1600, -800, 400), 400
LEAD = 1.5
ROUND_TEETH = 0.55
"""How far a corner goes back for what it goes aside: along the arch of the teeth."""
CORNER_BACK = 0.25


@dataclass(frozen=True)
class Lips:
    """Scalar fields (n,) by FAP: 1 at the FAP's own feature point, 0 at the others of its kind."""

    skin: Skin
    still: np.ndarray
    raises: dict[int, Array]
    stretches: dict[int, Array]
    pushes: dict[int, Array]

    @classmethod
    def of(cls, skin: Skin, still: np.ndarray) -> Lips:
        """`still`: bool (n,), what no lip FAP moves (nose, deep mouth, eyes)."""
        near = skin.near(skin.outer.vertices, NEAR) & ~still
        wide = skin.near(skin.outer.vertices, WIDE) & ~still
        raises = _solved(skin, near, _raising()) | _solved(skin, wide, _corners(CORNER_FAPS, LIP_NODES))
        return cls(
            skin, still, raises, _solved(skin, wide, _corners(STRETCH_FAPS, (-1.0, 0.0, 1.0))),
            _solved(skin, near, {16: ("both", _pushing(False)), 17: ("both", _pushing(True))}),
        )  # fmt: skip

    def held(self, moves: Array) -> Array:
        """Displacements (n, k) as they are, but with both contours of the lips left where they are."""
        skin = self.skin
        lips = np.concatenate([skin.inner.vertices, skin.outer.vertices])
        free = skin.near(skin.outer.vertices, NEAR) & ~self.still
        return moves + skin.solve(free, [(lips, -moves[lips])], harmonic=15.0)

    def motions(self, unit: Unit, bone: Bone) -> list[Motion]:
        """`bone`: the jaw's motion; the lower lip goes down on its path, and so back with the jaw."""
        out = []
        for fap, field in self.raises.items():
            if fap in LOWER:
                point = self.skin.points[self.feature(fap)]
                ways = [_down(point, knot * unit["MNS"], bone) for knot in DROP_KNOTS]
                out.append(Motion(fap, "skin", DROP_KNOTS, tuple(field[:, None] * way for way in ways)))
                continue
            direction = -Y if fap in DOWN else Y
            if fap in (12, 13, 59, 60):
                direction = Y - CORNER_BACK * Z
            out.append(_linear(fap, field, direction * unit["MNS"]))
        for fap, field in self.stretches.items():
            side = 1.0 if fap in (6, 53) else -1.0
            out.append(_linear(fap, field, (side * X - ROUND_TEETH * Z) * unit["MW"]))
        out += [_linear(fap, field, Z * unit["MNS"]) for fap, field in self.pushes.items()]
        return out

    def feature(self, fap: int) -> int:
        """The fine vertex of a lip FAP's feature point."""
        for (name, upper), row in LIP_FAPS.items():
            for node, number in row.items():
                if number == fap:
                    return self._contour(name).point(LIP_NODES[node], upper)
        for name, row in (*CORNER_FAPS.items(), *STRETCH_FAPS.items()):
            for node, number in row.items():
                if number == fap:
                    return self._contour(name).point(LIP_NODES[node], True)
        raise KeyError(fap)

    def _contour(self, name: str) -> Contour:
        return self.skin.inner if name == "inner" else self.skin.outer


def _down(point: Array, rise: float, bone: Bone) -> Array:
    """Displacement (3,) of a lower lip's point by `rise`, forward or back as the jaw would take it.

    In an opening mouth the lip is LEAD times lower than the bone beneath it, and goes back as far as that.
    """
    found: float = brentq(lambda angle: bone(point[None], angle)[0, 1] - rise / LEAD, -0.6, 0.8)
    return np.array([0.0, rise, bone(point[None], found)[0, 2]])


def _raising() -> dict[int, tuple[str, Shape]]:
    table: dict[int, tuple[str, Shape]] = {}
    for (name, upper), row in LIP_FAPS.items():
        for node, fap in row.items():
            table[fap] = (name, _half(LIP_NODES, node, upper))
    return table


def _half(nodes: Sequence[float], node: int, upper: bool) -> Shape:
    return lambda contour: cardinal(nodes, node, contour.places) * (contour.upper == upper)


def _corners(faps: dict[str, dict[int, int]], nodes: Sequence[float]) -> dict[int, tuple[str, Shape]]:
    table: dict[int, tuple[str, Shape]] = {}
    for name, row in faps.items():
        for node, fap in row.items():
            which = node if len(nodes) > 3 else node // 2
            table[fap] = (name, lambda contour, k=which: cardinal(nodes, k, contour.places))
    return table


def _pushing(upper: bool) -> Shape:
    return lambda contour: np.cos(contour.places * np.pi / 2) ** 0.7 * (contour.upper == upper)


def _solved(skin: Skin, free: np.ndarray, table: dict[int, tuple[str, Shape]]) -> dict[int, Array]:
    """Fields by FAP from their values on the contours, smooth between and around them."""
    handles = []
    for name, contour in (("inner", skin.inner), ("outer", skin.outer)):
        values = [
            shape(contour) if where in (name, "both") else np.zeros(len(contour.places))
            for where, shape in table.values()
        ]
        handles.append((contour.vertices, np.stack(values, 1)))
    return dict(zip(table, skin.solve(free, handles, harmonic=15.0).T, strict=True))


def _linear(fap: int, field: Array, per_unit: Array) -> Motion:
    return Motion(fap, "skin", (KNOT,), (field[:, None] * per_unit * KNOT,))
