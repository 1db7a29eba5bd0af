"""Rows of FAPs and notes about files."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.fap.rows import FapRow, Note, Notes
from fapstream.records import N_FAPS, ExpressionFap, VisemeFap


def row(viseme: VisemeFap | None = None, expression: ExpressionFap | None = None) -> FapRow:
    mask = np.zeros(N_FAPS, np.bool_)
    mask[[4, 0, 1]] = True, viseme is not None, expression is not None
    values = np.zeros(N_FAPS, np.int32)
    values[4] = 9
    return FapRow(7, mask, values, viseme, expression)


def test_a_row_lasts() -> None:
    first = row(VisemeFap(1), ExpressionFap(2))
    again = first.lasting(8)
    assert again.number == 8
    assert again.mask is first.mask
    assert again.values is first.values
    assert (again.viseme, again.expression) == (first.viseme, first.expression)


@pytest.mark.parametrize(
    "defining",
    [
        row(VisemeFap(1, define=True)),
        row(expression=ExpressionFap(1, define=True)),
        row(VisemeFap(1), ExpressionFap(init_face=True)),
    ],
)
def test_what_was_defined_is_not_defined_again(defining: FapRow) -> None:
    again = defining.lasting(8)
    assert not again.mask.any()
    assert not again.values.any()
    assert again.viseme is None
    assert again.expression is None


def test_notes_keep_one_of_a_kind() -> None:
    notes = Notes()
    for line, text in [(3, "odd"), (4, "odder"), (5, "odd")]:
        notes.add(line, text)
    assert notes.all() == (Note(3, "odd", 2), Note(4, "odder"))
    assert [str(n) for n in notes.all()] == ["line 3: odd (2 times)", "line 4: odder"]
    assert str(Note(0, "of the whole file")) == "of the whole file"
