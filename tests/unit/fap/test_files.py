"""The `.fap` text file, read back by a parser of a few lines."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from fapstream.fap.files import format_fap
from fapstream.records import FapFrame

VALUES = arrays(
    np.int32,
    st.tuples(st.integers(0, 12), st.just(68)),
    elements=st.integers(-200_000, 200_000),
    fill=st.just(0),
)


def frames(values: NDArray[np.int32]) -> list[FapFrame]:
    return [FapFrame(640 * k, row) for k, row in enumerate(values)]


def parse(text: str) -> tuple[list[str], NDArray[np.int32]]:
    """(header fields, values of shape (n, 68)) of a `.fap` file; strict."""
    assert text.endswith("\n")
    assert "  " not in text
    assert " \n" not in text
    first, *lines = text[:-1].split("\n")
    assert len(lines) % 2 == 0
    values = np.zeros((len(lines) // 2, 68), np.int32)
    for k in range(len(values)):
        mask = np.array([{"0": False, "1": True}[m] for m in lines[2 * k].split(" ")])
        assert mask.shape == (68,)
        number, *row = map(int, lines[2 * k + 1].split(" "))
        assert number == k
        values[k, mask] = row
    return first.split(" "), values


@given(VALUES, st.sampled_from([25, 50]))
def test_round_trip_of_the_low_level_faps(values: NDArray[np.int32], fps: int) -> None:
    header, back = parse(format_fap(frames(values), "hello", fps))
    assert header == ["2.1", "hello", str(fps), str(len(values))]
    assert np.array_equal(back[:, 2:], values[:, 2:])
    assert not back[:, :2].any(), "1 and 2 are composite: what they would stand for is in the others"


def test_faps_that_never_move_are_masked_off() -> None:
    values = np.zeros((3, 68), np.int32)
    values[1, 4] = -7
    values[:, 2] = 12
    values[:, 0] = 99
    text = format_fap(frames(values), "n", 25)
    masks, rows = text.splitlines()[1::2], text.splitlines()[2::2]
    expected = " ".join("1" if i in (2, 4) else "0" for i in range(68))
    assert masks == [expected] * 3
    assert rows == ["0 12 0", "1 12 -7", "2 12 0"]


def test_nothing_moves_and_nothing_at_all() -> None:
    assert parse(format_fap(frames(np.zeros((2, 68), np.int32)), "n", 25))[1].shape == (2, 68)
    assert format_fap([], "n", 50) == "2.1 n 50 0\n"


@pytest.mark.parametrize(
    ("name", "written"), [("a b\tc", "a_b_c"), (" x ", "x"), ("", "untitled"), ("\n", "untitled")]
)
def test_the_name_is_one_word(name: str, written: str) -> None:
    assert format_fap([], name, 25) == f"2.1 {written} 25 0\n"
