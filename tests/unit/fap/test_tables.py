"""ISO/IEC 14496-2, FBA: the FAP table, 14 visemes, 6 expressions."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from fapstream import data
from fapstream.errors import DataError
from fapstream.fap.tables import EXPRESSIONS, N_VISEMES, coding_ranges, expressions, faps, limits, visemes

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
    monkeypatch.setattr(data, "read_text", lambda *_: text)


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


def test_limits_are_anatomy_within_the_coding_ranges() -> None:
    """Right and left alike, either way only where the FAP goes both ways, the neutral face within."""
    table = limits()
    assert table.shape == (68, 2)
    assert not table[:2].any()
    assert (table[2:, 0] <= 0).all()
    assert (table[2:, 1] > 0).all()
    one_way = [f.fap - 1 for f in faps() if f.directions == 1 and f.fap > 2]
    assert not table[one_way, 0].any()
    assert np.abs(table[18:22]).max() >= 500, "lids close"
    for left, right in ((6, 7), (8, 9), (10, 11), (12, 13), (19, 20), (31, 32), (41, 42), (53, 54), (65, 66)):
        assert table[left - 1].tolist() == table[right - 1].tolist()


def test_visemes_and_expressions_are_within_the_limits() -> None:
    low, high = limits().T
    for row in (*visemes(), *expressions().values()):
        assert (row >= low).all()
        assert (row <= high).all()


@pytest.mark.parametrize(
    "row", ["3\t0\t1600", "2\t0\t1\twhy", "69\t0\t1\twhy", "3\t10\t20\twhy", "3\t0\t0\twhy", "3\tx\t1\twhy"]
)
def test_a_bad_limit_names_its_line(row: str, monkeypatch: pytest.MonkeyPatch) -> None:
    from_text(monkeypatch, f"# c\n\n{row}\n")
    with pytest.raises(DataError, match=r"limits\.tsv:3: "):
        limits.__wrapped__()


def test_a_missing_limit_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    from_text(monkeypatch, "3\t0\t1600\twhy\n")
    with pytest.raises(DataError, match="no row for FAP 4, 5"):
        limits.__wrapped__()


def test_coding_ranges() -> None:
    """Some rows of the standard's table, in quantised units; FAPs 1 and 2 are coded otherwise."""
    ranges = coding_ranges()
    assert ranges.shape == (68, 2)
    assert not ranges[:2].any()
    rows = {3: (1080, 360), 5: (1860, 600), 18: (420, 180), 23: (1200, 420), 48: (1860, 600), 63: (680, 180)}
    assert {fap: tuple(ranges[fap - 1].tolist()) for fap in rows} == rows
    assert (ranges[2:, 0] > ranges[2:, 1]).all()
    assert (ranges[2:, 1] >= 60).all()


@pytest.mark.parametrize("row", ["3", "3\t1", "3\tx\t1", "69\t1\t1", "0\t1\t1", "3 1 1"])
def test_a_bad_coding_range_names_its_line(row: str, monkeypatch: pytest.MonkeyPatch) -> None:
    from_text(monkeypatch, f"# comment\n{row}\n")
    with pytest.raises(DataError, match=r"^coding\.tsv:2: "):
        coding_ranges.__wrapped__()
