"""Writes protocol/vectors/deform: a tiny head and, for some FAP frames, where its vertices go.

`talk.glb` is the same as a glTF animation, one case a second, for readers that know nothing of FAPs.

The expected places are worked out here by hand (tables and closed forms), not by fapstream.head.deform.
"""

from __future__ import annotations

import json
from math import cos, sin
from pathlib import Path

import numpy as np

from fapstream.head.export import export_talk
from fapstream.head.fapu import Fapu
from fapstream.head.gltf_write import write_head
from fapstream.head.mesh import Camera, FatEntry, Head, Material, Mouth, Part, Turn

OUT = Path(__file__).parents[1] / "protocol/vectors/deform"
PARTS = ("skin", "eye_l", "eye_r", "teeth_upper", "teeth_lower", "tongue")
SKIN = [(0.0, 0.0, 0.125), (0.125, 0.0, 0.125), (0.0, 0.25, 0.0), (-0.125, 0.0, 0.0)]
EYE = [(0.25, 0.0, 0.125), (0.375, 0.0, 0.0), (0.25, 0.125, 0.0)]
PIVOT = (0.25, 0.0, 0.0)
WEIGHTS = (1.0, 0.6, 0.2, 0.0)
Points = list[tuple[float, float, float]]


def head() -> Head:
    parts = [_part(name, EYE if name == "eye_l" else SKIN) for name in PARTS]
    fat = (
        _fat(3, (100, 200), [0, 1], [[(0, -100, 0), (0, -50, 0)], [(0, -300, 0), (0, -100, -40)]], 1e-5),
        _fat(5, (-200, 200), [1, 2], [[(0, -1000, 0), (-500, 0, 0)], [(0, 1000, 0), (0, 0, 500)]], 2e-6),
        _fat(6, (-100,), [3], [[(-100, 0, 0)]], 1e-5),
        _fat(19, (-512, 400, 1024), [2], [[(0, 512, 0)], [(0, -300, 100)], [(0, -1024, 0)]], 1e-5),
        FatEntry(
            ((51, 0.002), (52, -0.001)), "skin", (-1, 0.5, 1), np.array([0, 3], np.uint32),
            np.array([[(0, 0, 0)] * 2, [(0, 0, 200), (0, 100, 0)], [(0, 0, 300), (0, 300, 0)]], np.int16),
            1e-5,
        ),
    )  # fmt: skip
    weights = np.array(WEIGHTS, np.float32)
    levels = (np.rint(weights * 255) / np.float32(255)).astype(np.float32)
    turns = (
        Turn((23, 25), ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0)), ("eye_l",), PIVOT),
        Turn((48, 49, 50), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), None, (0.0, 0.0, 0.0),
             {"skin": levels}),
    )  # fmt: skip
    return Head(
        "vectors", tuple(parts), Fapu(0.01, 0.06, 0.04, 0.02, 0.05), {"3.5": (0.25, 0.0, 0.125)},
        Mouth((0.0, 0.0, 0.0), (0.05, 0.02)), Camera((0.0, 0.0, 0.0), 0.4), fat, turns,
    )  # fmt: skip


def cases() -> list[dict[str, object]]:
    s = SKIN
    return [
        _case("rest", {}, {}),
        _case("below the first knot", {3: 50}, {0: (0, -0.0005, 0), 1: (0, -0.00025, 0)}),
        _case("between knots", {3: 150}, {0: (0, -0.002, 0), 1: (0, -0.00075, -0.0002)}),
        _case("beyond the last knot", {3: 300}, {0: (0, -0.005, 0), 1: (0, -0.0015, -0.0008)}),
        _case("beyond 0 of a one-sided table", {3: -100}, {0: (0, 0.001, 0), 1: (0, 0.0005, 0)}),
        _case("between a negative knot and 0", {5: -100}, {1: (0, -0.001, 0), 2: (-0.0005, 0, 0)}),
        _case("beyond a negative knot", {5: -400}, {1: (0, -0.004, 0), 2: (-0.002, 0, 0)}),
        _case("two FAPs on one vertex", {3: 100, 5: 200},
              {0: (0, -0.001, 0), 1: (0, 0.0015, 0), 2: (0, 0, 0.001)}),
        _case("a single negative knot, other side", {6: 50}, {3: (0.0005, 0, 0)}),
        _case("three knots, below", {19: -1024}, {2: (0, 0.01024, 0)}),
        _case("three knots, above", {19: 712}, {2: (0, -0.00662, 0.0005)}),
        _case("a drive of two FAPs", {51: 250, 52: -250}, {0: (0, 0, 0.0025), 3: (0, 0.002, 0)}),
        _case("a drive that stays below 0", {51: -900, 52: 900}, {}),
        _case("a drive beyond its last knot", {51: 900, 52: 300}, {0: (0, 0, 0.004), 3: (0, 0.005, 0)}),
        _case("a drive whose FAPs cancel", {51: 300, 52: 600}, {}),
        _eyes("eye to the left", 20000, 0),
        _eyes("eye left and down", 20000, -15000),
        _head("head down", {48: 10000}, s),
        _head("head left and rolled", {49: -20000, 50: 15000}, s),
        _head("head about three axes", {48: 30000, 49: -20000, 50: 15000}, s),
        _head("jaw, then head", {3: 100, 48: 10000}, _moved(s, {0: (0, -0.001, 0), 1: (0, -0.0005, 0)})),
    ]  # fmt: skip


def _case(name: str, faps: dict[int, int], moves: dict[int, tuple[float, float, float]]) -> dict[str, object]:
    return _row(name, faps, {"skin": _moved(SKIN, moves), "eye_l": EYE})


def _eyes(name: str, yaw: int, pitch: int) -> dict[str, object]:
    eye = [_plus(PIVOT, _about_y(_about_x(_minus(p, PIVOT), pitch * 1e-5), yaw * 1e-5)) for p in EYE]
    return _row(name, {23: yaw, 25: pitch}, {"skin": SKIN, "eye_l": eye})


def _head(name: str, faps: dict[int, int], skin: Points) -> dict[str, object]:
    pitch, yaw, roll = (faps.get(fap, 0) * 1e-5 for fap in (48, 49, 50))

    def turned(p: tuple[float, float, float]) -> tuple[float, float, float]:
        return _about_x(_about_y(_about_z(p, roll), yaw), pitch)

    new = [_plus(p, _times(_minus(turned(p), p), w)) for p, w in zip(skin, WEIGHTS, strict=True)]
    return _row(name, faps, {"skin": new, "eye_l": [turned(p) for p in EYE]})


def _about_x(p: tuple[float, float, float], a: float) -> tuple[float, float, float]:
    return p[0], cos(a) * p[1] - sin(a) * p[2], sin(a) * p[1] + cos(a) * p[2]


def _about_y(p: tuple[float, float, float], a: float) -> tuple[float, float, float]:
    return cos(a) * p[0] + sin(a) * p[2], p[1], -sin(a) * p[0] + cos(a) * p[2]


def _about_z(p: tuple[float, float, float], a: float) -> tuple[float, float, float]:
    return cos(a) * p[0] - sin(a) * p[1], sin(a) * p[0] + cos(a) * p[1], p[2]


def _plus(p: tuple[float, float, float], q: tuple[float, float, float]) -> tuple[float, float, float]:
    return p[0] + q[0], p[1] + q[1], p[2] + q[2]


def _times(p: tuple[float, float, float], w: float) -> tuple[float, float, float]:
    return p[0] * w, p[1] * w, p[2] * w


def _minus(p: tuple[float, float, float], q: tuple[float, float, float]) -> tuple[float, float, float]:
    return _plus(p, _times(q, -1.0))


def _moved(points: Points, moves: dict[int, tuple[float, float, float]]) -> Points:
    return [_plus(p, moves.get(i, (0.0, 0.0, 0.0))) for i, p in enumerate(points)]


def _row(name: str, faps: dict[int, int], positions: dict[str, Points]) -> dict[str, object]:
    rounded = {part: [[round(c, 9) + 0.0 for c in p] for p in points] for part, points in positions.items()}
    return {"name": name, "faps": {str(fap): value for fap, value in faps.items()}, "positions": rounded}


def _part(name: str, points: Points) -> Part:
    n = len(points)
    normals = np.tile(np.array([0, 0, 1], np.float32), (n, 1))
    triangles = np.array([[0, 1, 2]] if n == 3 else [[0, 1, 2], [0, 2, 3]], np.uint32)
    return Part(
        name,
        np.array(points, np.float32),
        normals,
        np.zeros((n, 2), np.float32),
        triangles,
        Material("plain"),
    )


def _fat(fap: int, knots: tuple[float, ...], indices: list[int], deltas: list, scale: float) -> FatEntry:
    return FatEntry.of(fap, "skin", knots, np.array(indices, np.uint32), np.array(deltas, np.int16), scale)


def frames() -> np.ndarray:
    """The cases' FAPs, int32 (n, 68)."""
    rows = np.zeros((len(cases()), 68), np.int32)
    for row, case in zip(rows, cases(), strict=True):
        for fap, value in case["faps"].items():
            row[int(fap) - 1] = value
    return rows


def main() -> None:
    OUT.mkdir(parents=True, exist_ok=True)
    (OUT / "talk.glb").write_bytes(export_talk(head(), frames(), 1.0))
    (OUT / "small.glb").write_bytes(write_head(head()))
    rows = ",\n".join("  " + json.dumps(case) for case in cases())
    text = f'{{"head": "small.glb", "tolerance_m": 1e-7, "cases": [\n{rows}\n]}}\n'
    (OUT / "small.json").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
