"""ISO/IEC 14496-2, FBA: the FAP table, 14 visemes, 6 expressions."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from fapstream.errors import DataError
from fapstream.fap import tables
from fapstream.fap.tables import EXPRESSIONS, N_VISEMES, expressions, faps, visemes

SCHEMA = Path(__file__).parents[3] / "protocol" / "schema" / "faps.json"


def test_the_68_faps_are_those_of_the_protocol() -> None:
    rows = json.loads(SCHEMA.read_text(encoding="utf-8"))
    assert [f.fap for f in faps()] == list(range(1, 69))
    assert [(f.name, f.unit, f.group) for f in faps()] == [(r["name"], r["unit"], r["group"]) for r in rows]


def test_units_and_groups_are_the_standards() -> None:
    assert {f.unit for f in faps()} == {"na", "AU", "MNS", "MW", "ENS", "ES", "IRISD"}
    assert {f.fap for f in faps() if f.unit == "na"} == {1, 2}
    sizes = [sum(f.group == g for f in faps()) for g in range(1, 11)]
    assert sizes == [2, 16, 12, 8, 4, 5, 3, 10, 4, 4]


def test_visemes() -> None:
    table = visemes()
    assert table.shape == (N_VISEMES, 68)
    assert not table[0].any()
    assert all(table[v].any() for v in range(1, N_VISEMES))
    assert not table[:, :2].any()
    assert np.array_equal(table, np.rint(table))


def test_speech_moves_both_sides_alike() -> None:
    """Pairs of left and right FAPs: mid-lips and corners, inner and outer; lids and brows."""
    for row in visemes():
        for left, right in [(6, 7), (8, 9), (10, 11), (12, 13), (53, 54), (55, 56), (57, 58), (59, 60),
                            (19, 20), (21, 22), (31, 32), (33, 34), (35, 36), (37, 38)]:  # fmt: skip
            assert row[left - 1] == row[right - 1]


def gap(row: NDArray[np.float64]) -> float:
    """How far the inner lips stand apart, MNS units: the lower one's way down and the upper one's up."""
    return float(-row[5 - 1] - row[4 - 1])


def test_how_far_visemes_open_the_lips() -> None:
    opened = [gap(row) for row in visemes()]
    assert opened[1] <= 0, "p, b, m: shut"
    assert 0 < opened[2] == min(opened[2:]), "f, v: next to shut"
    assert max(range(N_VISEMES), key=opened.__getitem__) == 10, "the open vowel A"
    assert opened[11] > opened[12], "e is more open than i"
    assert opened[13] > opened[14], "o is more open than u"


def test_expressions() -> None:
    assert tuple(expressions()) == EXPRESSIONS
    assert all(v.shape == (68,) and v.any() and not v[:2].any() for v in expressions().values())
    assert expressions()["joy"][12 - 1] > 0, "FAP 12 raises the lip corner"
    assert expressions()["sadness"][12 - 1] < 0
    assert expressions()["surprise"][3 - 1] > 100, "FAP 3 opens the jaw"


def from_text(monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    monkeypatch.setattr(tables, "_read", lambda _: text)


@pytest.mark.parametrize(
    "row", ["15\t3=1", "0\t3=1", "x\t3=1", "1\t3", "1\t3=", "1\t3=x", "1\tx=3", "1\t69=1", "1\t2=1", "1\t0=1",
            "1\t-4=1", "1\t3=1 4"]
)  # fmt: skip
def test_a_bad_viseme_row_names_its_line(row: str, monkeypatch: pytest.MonkeyPatch) -> None:
    from_text(monkeypatch, f"# comment\n\n{row}\n")
    with pytest.raises(DataError, match=r"^visemes\.tsv:3: "):
        visemes.__wrapped__()


def test_a_missing_viseme_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    from_text(monkeypatch, "".join(f"{v}\t3=1\n" for v in range(1, 15) if v != 6))
    with pytest.raises(DataError, match="6"):
        visemes.__wrapped__()


@pytest.mark.parametrize("names", [EXPRESSIONS[:5], (*EXPRESSIONS, "boredom")])
def test_missing_or_more_expressions_are_told(
    names: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    from_text(monkeypatch, "".join(f"{name}\t3=1\n" for name in names))
    with pytest.raises(DataError, match=r"^expressions\.tsv: expected exactly joy"):
        expressions.__wrapped__()
