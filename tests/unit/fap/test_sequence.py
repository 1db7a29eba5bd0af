"""A whole animation: gaps, FAPs that keep their values, masks."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.fap.rows import FapRow
from fapstream.fap.sequence import FapSequence
from fapstream.fap.tables import visemes
from fapstream.records import N_FAPS, FapFrame, VisemeFap


def row(number: int, viseme: VisemeFap | None = None, **faps: int) -> FapRow:
    """`f5=9` sends FAP 5 = 9."""
    mask, values = np.zeros(N_FAPS, np.bool_), np.zeros(N_FAPS, np.int32)
    for name, value in faps.items():
        mask[int(name[1:]) - 1] = True
        values[int(name[1:]) - 1] = value
    mask[0] = viseme is not None
    return FapRow(number, mask, values, viseme)


def sequence(*rows: FapRow) -> FapSequence:
    return FapSequence("n", "2.1", 25, rows)


def test_of_frames_sends_what_ever_moves() -> None:
    values = np.zeros((2, N_FAPS), np.int32)
    values[1, 4] = 8
    values[:, 0] = 3
    made = FapSequence.of([FapFrame(640 * k, v) for k, v in enumerate(values)], "n", 50)
    assert (made.name, made.fps, made.length) == ("n", 50, 2)
    assert all(np.flatnonzero(r.mask).tolist() == [4] for r in made.frames)
    assert made.low_level()[:, 4].tolist() == [0, 8]
    assert values[0, 0] == 3, "what is given stays as it is"


def test_gaps() -> None:
    s = sequence(row(0, f5=1), row(3, f6=2), row(4, f5=3))
    assert s.length == 5
    assert s.low_level()[:, 4].tolist() == [1, 1, 1, 1, 3]
    assert s.low_level()[:, 5].tolist() == [0, 0, 0, 2, 2]
    filled = list(s.filled())
    assert [r.number for r in filled] == [0, 1, 2, 3, 4]
    assert np.array_equal(sequence(*filled).low_level(), s.low_level())


def test_nothing() -> None:
    assert sequence().low_level().shape == (0, N_FAPS)
    assert sequence().length == 0
    assert list(sequence().filled()) == []


def test_only() -> None:
    s = sequence(row(0, VisemeFap(10, 0, 63), f5=1, f48=2))
    kept = np.zeros(N_FAPS, np.bool_)
    kept[47] = True
    face = s.only(kept).low_level()[0]
    assert face[47] == 2
    assert np.count_nonzero(face) == 1
    kept[0] = True
    assert s.only(kept).low_level()[0, 2] == visemes()[10, 2]


@pytest.mark.parametrize("numbers", [(1,), (0, 0), (0, 2, 1), (0, 1_000_000)])
def test_numbers_rise_from_0(numbers: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match="must rise"):
        sequence(*(row(n, f5=1) for n in numbers)).low_level()
