"""deform: the properties; its numbers are in protocol/vectors/deform."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.fap.tables import Fap, faps
from fapstream.head.deform import about_axis, deform, knot_shares
from tests.unit.head.packaged import packaged

GENERIC = packaged()
AXES = {"up": (0, 1, 0), "down": (0, -1, 0), "left": (1, 0, 0), "right": (-1, 0, 0), "forward": (0, 0, 1)}
POINTED = [fap for fap in faps() if fap.fap > 2 and fap.fdp and fap.positive in AXES]
KNOTS = st.lists(st.integers(-2000, 2000).filter(bool), min_size=1, max_size=5, unique=True).map(sorted)


def frame(**values: int) -> np.ndarray:
    out = np.zeros(68, np.int16)
    for name, value in values.items():
        out[int(name[1:]) - 1] = value
    return out


@given(KNOTS, st.integers(-3000, 3000))
def test_knots_interpolate_a_straight_line_exactly(knots: list[int], value: int) -> None:
    shares = knot_shares(tuple(knots), value)
    assert sum(share * knots[k] for k, share in shares.items()) == pytest.approx(value)


@given(KNOTS)
def test_at_a_knot_only_that_knot_counts(knots: list[int]) -> None:
    for k, knot in enumerate(knots):
        assert knot_shares(tuple(knots), knot) == {k: 1.0}
    assert knot_shares(tuple(knots), 0) == {}


@given(st.floats(-3, 3))
def test_turning_is_rigid_and_right_handed(angle: float) -> None:
    matrix = about_axis(np.array([0.0, 0.0, 2.0]), angle)
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(matrix @ [1, 0, 0], [np.cos(angle), np.sin(angle), 0], atol=1e-12)


def test_rest_is_the_file() -> None:
    for name, points in deform(GENERIC, frame()).items():
        np.testing.assert_array_equal(points, GENERIC.part(name).positions)


@pytest.mark.parametrize("fap", POINTED, ids=lambda fap: f"{fap.fap}-{fap.name}")
@pytest.mark.parametrize("value", [60, 240, 600])
def test_a_feature_point_moves_by_the_fap_times_its_unit(fap: Fap, value: int) -> None:
    """ISO/IEC 14496-2: displacement = FAP * FAPU, along the FAP's axis, within 1 %."""
    moved = deform(GENERIC, frame(**{f"f{fap.fap}": value}))
    for name in fap.fdp:
        part, vertex = nearest(GENERIC.fdp[name])
        move = moved[part][vertex] - GENERIC.part(part).positions[vertex]
        assert move @ AXES[fap.positive] == pytest.approx(value * GENERIC.fapu.per_unit(fap.unit), rel=0.01)


def nearest(point: tuple[float, float, float]) -> tuple[str, int]:
    gaps = {part.name: np.linalg.norm(part.positions - point, axis=1) for part in GENERIC.parts}
    part = min(gaps, key=lambda name: float(gaps[name].min()))
    return part, int(gaps[part].argmin())


@pytest.mark.parametrize("name", ["2.2", "2.3", "2.4", "2.5", "2.6", "2.8", "8.1", "8.2", "8.3", "8.7"])
def test_the_jaw_alone_does_not_open_the_lips(name: str) -> None:
    """FAP 3 is the bone; lips have FAPs of their own."""
    part, vertex = nearest(GENERIC.fdp[name])
    move = deform(GENERIC, frame(f3=540))[part][vertex] - GENERIC.part(part).positions[vertex]
    assert abs(move[1]) < 1e-4


def test_the_jaw_takes_the_lower_teeth_along_and_leaves_the_upper() -> None:
    moved = deform(GENERIC, frame(f3=540))
    lower = moved["teeth_lower"] - GENERIC.part("teeth_lower").positions
    assert lower[:, 1].min() < -0.008
    np.testing.assert_array_equal(moved["teeth_upper"], GENERIC.part("teeth_upper").positions)


@pytest.mark.parametrize(("lid", "upper", "lower"), [(19, "3.1", "3.3"), (20, "3.2", "3.4")])
def test_1024_closes_a_lid_on_the_ball_and_never_cuts_it(lid: int, upper: str, lower: str) -> None:
    eye = "eye_l" if lid == 19 else "eye_r"
    centre = np.array(next(turn.pivot for turn in GENERIC.turns if turn.parts == (eye,)))
    vertex = nearest(GENERIC.fdp[upper])[1]
    radius = np.linalg.norm(GENERIC.part("skin").positions[vertex] - centre)
    for value in (256, 512, 768, 1024):
        margin = deform(GENERIC, frame(**{f"f{lid}": value}))["skin"][vertex]
        assert np.linalg.norm(margin - centre) == pytest.approx(radius, abs=2e-4)
    assert abs(margin[1] - GENERIC.fdp[lower][1]) < 3e-4


@pytest.mark.parametrize(("fap", "axis", "sign"), [(48, 1, -1), (49, 0, 1)])
def test_the_head_turns_the_way_the_standard_says(fap: int, axis: int, sign: int) -> None:
    """FAP 48 positive: down; 49 positive: to the subject's left. The nose tells."""
    vertex = nearest(GENERIC.fdp["9.3"])[1]
    before = GENERIC.part("skin").positions[vertex]
    after = deform(GENERIC, frame(**{f"f{fap}": 10000}))["skin"][vertex]
    assert (after - before)[axis] * sign > 0.005


def test_a_roll_tips_the_skull_to_the_subjects_right() -> None:
    part, vertex = nearest(GENERIC.fdp["11.5"])
    moved = deform(GENERIC, frame(f50=10000))[part][vertex] - GENERIC.part(part).positions[vertex]
    assert moved[0] < -0.005


def test_the_shirt_stays_where_it_is() -> None:
    low = GENERIC.part("shirt").positions[:, 1].argmin()
    moved = deform(GENERIC, frame(f48=20000, f49=20000))["shirt"]
    np.testing.assert_allclose(moved[low], GENERIC.part("shirt").positions[low], atol=1e-4)
