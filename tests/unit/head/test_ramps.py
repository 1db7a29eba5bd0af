"""Ramps: the sum of all tables is what the tables say one by one."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.head.deform import displacement, drive_value
from fapstream.head.mesh import FatEntry
from fapstream.head.ramps import Ramps

STARTS = {"skin": 0, "tongue": 6}
COUNT = 10


def frame(**faps: float) -> np.ndarray:
    """(68,) from f5=-200."""
    values = np.zeros(68)
    for name, value in faps.items():
        values[int(name[1:]) - 1] = value
    return values


def positions(ramps: Ramps, values: np.ndarray) -> np.ndarray:
    out = np.zeros((3, COUNT), np.float32)
    ramps.add(ramps.amounts(values), out)
    return out.T


def table(drive: dict[int, float], part: str, knots: list[float], indices: list[int], seed: int) -> FatEntry:
    deltas = np.random.default_rng(seed).integers(-900, 900, (len(knots), len(indices), 3))
    rows = np.array(indices, np.uint32)
    return FatEntry(tuple(drive.items()), part, tuple(knots), rows, deltas.astype(np.int16), 1e-5)


@st.composite
def tables(draw: st.DrawFn) -> FatEntry:
    faps = st.dictionaries(st.integers(3, 6), st.sampled_from([-1.0, 0.5, 1.0]), min_size=1, max_size=2)
    knots = st.sets(st.sampled_from([-300.0, -120.5, -20.0, 15.0, 80.0, 400.0]), min_size=1)
    part = draw(st.sampled_from(sorted(STARTS)))
    indices = draw(st.permutations(range(4)))[: draw(st.integers(1, 4))]
    return table(draw(faps), part, sorted(draw(knots)), list(indices), draw(st.integers(0, 99)))


@settings(max_examples=200, deadline=None)
@given(st.lists(tables(), max_size=5), st.lists(st.floats(-700, 700), min_size=4, max_size=4))
def test_they_add_up_what_the_tables_say(fat: list[FatEntry], faps: list[float]) -> None:
    """Against `displacement`, knot by knot, between knots and beyond the last."""
    values = frame(**{f"f{3 + k}": value for k, value in enumerate(faps)})
    expected = np.zeros((COUNT, 3))
    for entry in fat:
        if value := drive_value(entry, values):
            expected[STARTS[entry.part] + entry.indices] += displacement(entry, value)
    np.testing.assert_allclose(positions(Ramps(fat, STARTS), values), expected, rtol=0, atol=2e-7)


def test_at_rest_nothing_moves_at_all() -> None:
    ramps = Ramps([table({5: 1.0}, "skin", [-100, -20, 30], [0, 3], 1)], STARTS)
    assert not ramps.amounts(frame()).any()
    assert not positions(ramps, frame(f6=500)).any()


def test_they_tell_which_parts_move_and_which_vertices_can() -> None:
    still = FatEntry.of(9, "skin", (1,), np.uint32([5]), np.zeros((1, 1, 3), np.int16), 1.0)
    fat = [table({5: 1.0}, "skin", [-100, 100], [4, 1], 1), table({7: 1.0}, "tongue", [100], [2], 2), still]
    ramps = Ramps(fat, STARTS)
    assert ramps.vertices.tolist() == [1, 4, 8], "what stays where it is does not count"
    assert ramps.moved(ramps.amounts(frame(f5=-3))) == {"skin"}
    assert ramps.moved(ramps.amounts(frame(f5=3, f7=1))) == {"skin", "tongue"}
    assert ramps.moved(ramps.amounts(frame())) == set()


@pytest.mark.parametrize("value", [-150.0, -40.0, 60.0, 900.0])
def test_opposite_faps_of_one_drive_cancel(value: float) -> None:
    ramps = Ramps([table({5: 1.0, 6: -1.0}, "skin", [-100, 100], [0], 3)], STARTS)
    assert not positions(ramps, frame(f5=value, f6=value)).any()


def test_a_head_without_tables_stays() -> None:
    assert not positions(Ramps([], STARTS), frame(f5=100)).any()
