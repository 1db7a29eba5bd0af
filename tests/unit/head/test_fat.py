"""The face animation tables of the packaged heads, and of adapted ones: each FAP does what ISO/IEC 14496-2
says it does.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from fapstream.fap.fdp import FDP_NAMES
from fapstream.fap.tables import faps, limits
from fapstream.head.deform import deform
from fapstream.head.mesh import Head
from tests.unit.adapt.persons import NAMES as PERSONS
from tests.unit.adapt.persons import adapted
from tests.unit.head.packaged import NAMES
from tests.unit.head.packaged import packaged as of_package

HEADS = (*NAMES, *PERSONS)
"""Those of the package, and some that were adapted to photos."""

TOLERANCE = 0.01
AXES = {
    "up": (0, 1, 0), "down": (0, -1, 0), "left": (1, 0, 0), "right": (-1, 0, 0), "forward": (0, 0, 1),
}  # fmt: skip
ON_PART = {
    "6": "tongue", "9.8": "teeth_upper", "9.10": "teeth_upper", "9.9": "teeth_lower", "9.11": "teeth_lower",
}  # fmt: skip
LIP_POINTS = tuple(f"2.{k}" for k in range(2, 10)) + tuple(f"8.{k}" for k in range(1, 11))
ALL_POINTS = set(FDP_NAMES)

Vector = NDArray[np.float64]


def head_of(name: str) -> Head:
    """The head of that name."""
    return adapted(name) if name in PERSONS else of_package(name)


@cache
def vertex_of(name: str, point: str) -> tuple[str, int]:
    """The part and the vertex that a feature point lies on."""
    head = head_of(name)
    part = ON_PART.get(point) or ON_PART.get(point.split(".")[0], "skin")
    if point in ("3.5", "3.6"):
        part = "eye_l" if point == "3.5" else "eye_r"
    gap = np.linalg.norm(head.part(part).positions - np.array(head.fdp[point]), axis=1)
    return part, int(np.argmin(gap))


def frame(**values: int) -> NDArray[np.int32]:
    """`fap5=-300` and so on."""
    row = np.zeros(68, np.int32)
    for key, value in values.items():
        row[int(key[3:]) - 1] = value
    return row


def pointed(name: str, values: dict[int, int], point: str) -> tuple[Vector, Vector]:
    """Where a feature point is at rest and under some FAPs, metres."""
    head = head_of(name)
    part, vertex = vertex_of(name, point)
    moved = deform(head, frame(**{f"fap{fap}": value for fap, value in values.items()}))
    return head.part(part).positions[vertex].astype(float), moved[part][vertex]


def tried(fap: int) -> list[int]:
    """A small and a large value, and the other way where there is one, within the anatomical limits."""
    low, high = limits()[fap - 1]
    return [round(v) for v in (0.07 * high, 0.55 * high, high, 0.5 * low, low) if abs(v) >= 1]


def turned(before: Vector, after: Vector, axis: Vector) -> float:
    """Radians from one vector to the other about an axis, right-handed."""
    flat = [v - axis * (v @ axis) for v in (before, after)]
    return float(np.arctan2(np.cross(*flat) @ axis, flat[0] @ flat[1]))


def eye_angle(name: str, fap: int, value: int) -> float:
    side, point = ("l", "3.5") if fap in (23, 25) else ("r", "3.6")
    (turn,) = (t for t in head_of(name).turns if fap in t.faps)
    assert f"eye_{side}" in (turn.parts or ())
    before, after = pointed(name, {fap: value}, point)
    axis = np.array((0.0, 1.0, 0.0) if fap in (23, 24) else (1.0, 0.0, 0.0))
    return turned(before - turn.pivot, after - turn.pivot, axis)


def head_angle(name: str, fap: int, value: int) -> float:
    atlas = np.array(head_of(name).fdp["7.1"])
    before, after = pointed(name, {fap: value}, "9.1")
    return turned(before - atlas, after - atlas, np.eye(3)[fap - 48])


def roll_angle(name: str, fap: int, value: int) -> float:
    """How far the tongue's left border has turned up about the line along the middle of the tongue."""
    before, after = pointed(name, {fap: value}, "6.3")
    other = pointed(name, {fap: value}, "6.4")[0]
    middle = (before + other) / 2
    return turned(before - middle, after - middle, np.array([0.0, 0.0, 1.0]))


def pupil_growth(name: str, fap: int, value: int) -> float:
    """Change of the pupil's diameter: twice that of the radius of the ring that moves most."""
    head, part = head_of(name), "eye_l" if fap == 29 else "eye_r"
    (entry,) = (e for e in head.fat if e.faps == (fap,) and e.part == part)
    size = np.linalg.norm(entry.deltas[0].astype(float), axis=1)
    ring = entry.indices[size > 0.99 * size.max()]
    centre = np.array(head.fdp["3.5" if fap == 29 else "3.6"])[:2]
    after = deform(head, frame(**{f"fap{fap}": value}))[part][ring, :2] - centre
    before = head.part(part).positions[ring, :2] - centre
    return float(2 * (np.linalg.norm(after, axis=1) - np.linalg.norm(before, axis=1)).mean())


def achieved(name: str, fap: int, value: int) -> float:
    """What a FAP did along its axis, in the unit of its FAPU: metres or radians."""
    if 23 <= fap <= 26:
        return eye_angle(name, fap, value)
    if 48 <= fap <= 50:
        return head_angle(name, fap, value)
    if fap == 47:
        return roll_angle(name, fap, value)
    if fap in (29, 30):
        return pupil_growth(name, fap, value)
    row = faps()[fap - 1]
    point = {27: "3.5", 28: "3.6"}.get(fap) or row.fdp[0]
    before, after = pointed(name, {fap: value}, point)
    return float((after - before) @ AXES[row.positive])


@pytest.mark.parametrize("name", HEADS)
@pytest.mark.parametrize("fap", range(3, 69))
def test_feature_point_moves_by_fap_times_fapu(name: str, fap: int) -> None:
    """ISO/IEC 14496-2 Annex C: the displacement is FAP * FAPU, in the FAP's positive direction."""
    unit = head_of(name).fapu.per_unit(faps()[fap - 1].unit)
    for value in tried(fap):
        wanted = value * unit
        # positions are stored to 15 um; displacements to 4
        assert achieved(name, fap, value) == pytest.approx(wanted, rel=TOLERANCE, abs=6e-6), f"FAP {value}"


@pytest.mark.parametrize("name", HEADS)
def test_all_84_feature_points_are_there(name: str) -> None:
    assert set(head_of(name).fdp) == ALL_POINTS
    assert len(ALL_POINTS) == 84


@pytest.mark.parametrize("name", HEADS)
def test_feature_points_lie_on_their_parts(name: str) -> None:
    head = head_of(name)
    hair = {f"11.{k}" for k in range(1, 7)}  # on the scalp, which need not be drawn under hair
    for point in ALL_POINTS - hair - {"7.1"}:
        part, vertex = vertex_of(name, point)
        gap = np.linalg.norm(head.part(part).positions[vertex] - np.array(head.fdp[point]))
        # between two teeth there is no vertex
        allowed = 1.5e-3 if part.startswith("teeth") else 3e-5
        assert gap < allowed, f"{point}: {gap * 1000:.2f} mm off {part}"


@pytest.mark.parametrize("name", HEADS)
@pytest.mark.parametrize("fap", [3, 14, 15])
def test_the_jaw_leaves_the_lips_to_their_own_faps(name: str, fap: int) -> None:
    value = round(limits()[fap - 1][1])
    unit = head_of(name).fapu.per_unit(faps()[fap - 1].unit)
    for point in LIP_POINTS:
        before, after = pointed(name, {fap: value}, point)
        axis = {3: 1, 14: 2, 15: 0}[fap]
        assert abs(after - before)[axis] < TOLERANCE * value * unit, point


@pytest.mark.parametrize("name", HEADS)
def test_the_jaw_takes_teeth_and_tongue_and_turns_about_the_condyles(name: str) -> None:
    """Points further from the condyles go further; the lower teeth stay rigid."""
    head = head_of(name)
    moved = deform(head, frame(fap3=600))
    teeth = head.part("teeth_lower").positions
    span = np.linalg.norm(teeth[:1] - teeth, axis=1)
    after = np.linalg.norm(moved["teeth_lower"][:1] - moved["teeth_lower"], axis=1)
    assert np.abs(after - span).max() < 1e-4
    drop = teeth[:, 1] - moved["teeth_lower"][:, 1]
    front, back = teeth[:, 2].argmax(), teeth[:, 2].argmin()
    assert drop[front] > 1.3 * drop[back] > 0
    assert (head.part("tongue").positions - moved["tongue"])[:, 1].max() > 0.5 * drop[front]
    assert np.array_equal(head.part("teeth_upper").positions, moved["teeth_upper"].astype(np.float32))


MIRRORED = [
    ("2.4", "2.5"), ("2.6", "2.7"), ("2.8", "2.9"), ("2.11", "2.12"), ("2.13", "2.14"), ("3.1", "3.2"),
    ("3.3", "3.4"), ("3.5", "3.6"), ("3.7", "3.12"), ("3.11", "3.8"), ("3.9", "3.10"), ("3.13", "3.14"),
    ("4.1", "4.2"), ("4.3", "4.4"), ("4.5", "4.6"), ("5.1", "5.2"), ("5.3", "5.4"), ("6.3", "6.4"),
    ("8.3", "8.4"), ("8.5", "8.6"), ("8.7", "8.8"), ("8.10", "8.9"), ("9.1", "9.2"), ("9.5", "9.4"),
    ("9.7", "9.6"), ("9.14", "9.13"), ("10.1", "10.2"), ("10.3", "10.4"), ("10.5", "10.6"), ("10.7", "10.8"),
    ("10.9", "10.10"), ("11.3", "11.2"),
]  # fmt: skip
"""Left and right of one another, as ISO/IEC 14496-2 numbers them (left is the subject's: +x)."""


@pytest.mark.parametrize("name", NAMES)
def test_left_and_right_mirror_one_another(name: str) -> None:
    fdp = head_of(name).fdp
    for left, right in MIRRORED:
        assert fdp[left][0] > 0
        gap = np.abs(np.array(fdp[left]) * (-1, 1, 1) - np.array(fdp[right])).max()
        assert gap < 1.5e-3, f"{left} and {right}: {gap * 1000:.1f} mm"
    for middle in ALL_POINTS - {point for pair in MIRRORED for point in pair} - {"11.5"}:
        assert abs(fdp[middle][0]) < 5e-4, middle


@pytest.mark.parametrize("name", HEADS)
def test_points_stand_in_the_order_of_a_face(name: str) -> None:
    """From the chin up, and from the face back."""
    fdp = head_of(name).fdp
    up = ["2.1", "2.10", "8.2", "2.3", "8.1", "9.15", "9.3", "9.12", "3.3", "3.1", "3.13", "4.3", "11.4"]
    back = ("8.1", "9.10", "9.11", "6.1", "6.2", "7.1", "11.6")
    heights = [fdp[point][1] for point in up]
    assert heights == sorted(heights)
    depths = [-fdp[point][2] for point in back]
    assert depths == sorted(depths)
    assert fdp["10.1"][1] > fdp["10.9"][1] > fdp["10.7"][1] >= fdp["10.5"][1] - 2e-3


@pytest.mark.parametrize("name", HEADS)
@pytest.mark.parametrize("side", ["l", "r"])
def test_closed_lids_cover_the_eye(name: str, side: str) -> None:
    """From in front, skin lies before every part of the ball that was to be seen; open, it does not."""
    head = head_of(name)
    upper, lower = (19, 21) if side == "l" else (20, 22)
    ball = f"eye_{side}"
    seen = uncovered(head, deform(head, frame()), ball)
    assert seen.sum() > 50
    for values in ({upper: 1024}, {upper: 620, lower: 440}):
        moved = deform(head, frame(**{f"fap{fap}": value for fap, value in values.items()}))
        assert not (uncovered(head, moved, ball) & seen).any(), values


def uncovered(head: Head, positions: dict[str, Vector], part: str) -> NDArray[np.bool_]:
    """bool (n,): vertices on the front of an eyeball that no triangle of the skin is in front of."""
    points, skin = positions[part], positions["skin"]
    centre = np.array(head.fdp["3.5" if part == "eye_l" else "3.6"])
    corners = skin[head.part("skin").triangles]
    corners = corners[np.linalg.norm(corners.mean(1) - centre, axis=1) < 0.03]
    a, b, c = (corners[None, :, k, :2] for k in range(3))
    p = points[:, None, :2]

    def side(u: Vector, v: Vector) -> Vector:
        return (v[..., 0] - u[..., 0]) * (p[..., 1] - u[..., 1]) - (v[..., 1] - u[..., 1]) * (
            p[..., 0] - u[..., 0]
        )

    signs = np.stack([side(b, c), side(c, a), side(a, b)])
    inside = (signs >= 0).all(0) | (signs <= 0).all(0)
    total = signs.sum(0)
    shares = signs / np.where(np.abs(total) < 1e-18, 1, total)
    depth = (shares * corners[None, :, :, 2].transpose(2, 0, 1)).sum(0)
    covered = (inside & (np.abs(total) > 1e-18) & (depth > points[:, None, 2])).any(1)
    front = points[:, 2] > centre[2] - 0.008
    return front & ~covered


@pytest.mark.parametrize("name", HEADS)
def test_eyes_turn_as_balls_and_the_neck_follows_the_head_in_part(name: str) -> None:
    head = head_of(name)
    (turn,) = (t for t in head.turns if 23 in t.faps)
    rest = head.part("eye_l").positions - np.array(turn.pivot)
    moved = deform(head, frame(fap23=40000, fap25=20000))["eye_l"] - np.array(turn.pivot)
    np.testing.assert_allclose(np.linalg.norm(moved, axis=1), np.linalg.norm(rest, axis=1), atol=1e-7)
    (neck,) = (t for t in head.turns if 48 in t.faps)
    np.testing.assert_allclose(neck.pivot, head.fdp["7.1"], atol=1e-6)
    points, weights = head.part("skin").positions, neck.weights["skin"]
    below = points[:, 1] < head.fdp["2.1"][1] - 0.03
    face = (points[:, 1] > head.fdp["8.1"][1]) & (points[:, 2] > 0)
    assert weights[face].min() > 0.9
    assert 0 < np.median(weights[below]) < 0.7


@pytest.mark.parametrize("name", HEADS)
def test_the_lips_touch_at_rest(name: str) -> None:
    """No inner gap, and no more than a little over half a millimetre pressed into one another."""
    fdp = head_of(name).fdp
    for upper, lower in (("2.2", "2.3"), ("2.6", "2.8"), ("2.7", "2.9")):
        assert -6e-4 < fdp[upper][1] - fdp[lower][1] < 1e-4
