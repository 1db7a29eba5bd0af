"""The tables of MPEG-4 facial animation: the 68 FAPs, and what the high-level ones stand for."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fapstream.data import read_lines, read_text
from fapstream.errors import DataError
from fapstream.records import N_FAPS, ExpressionName

N_VISEMES = 15
"""Viseme 0 is none, 1-14 as in ISO/IEC 14496-2."""

FULL = 63
"""viseme_blend and the intensities of expressions are 6 bits."""

ANGLE_UNIT_RAD = 1e-5
"""One AU, the FAPU of angles."""

EXPRESSIONS: tuple[ExpressionName, ...] = ("joy", "sadness", "anger", "fear", "disgust", "surprise")
"""In the order of FAP 2: joy is 1."""


@dataclass(frozen=True, slots=True)
class Fap:
    """One row of the FAP table. `unit` is a FAPU's name, `AU` for 1e-5 rad, or `na`."""

    fap: int
    name: str
    unit: str
    group: int
    directions: int
    positive: str
    fdp: tuple[str, ...]
    quant: int


@cache
def faps() -> tuple[Fap, ...]:
    """The 68 FAPs, FAP n at n-1."""
    rows = json.loads(read_text("fap", "faps.json"))
    return tuple(Fap(**{**row, "fdp": tuple(row["fdp"])}) for row in rows)


@cache
def visemes() -> NDArray[np.float64]:
    """Low-level FAP values of visemes 0-14, shape (15, 68), FAP units."""
    table = np.zeros((N_VISEMES, N_FAPS))
    for line, name, values in _rows("visemes.tsv"):
        if not name.isdigit() or not 1 <= int(name) < N_VISEMES:
            raise DataError("visemes.tsv", line, f"{name!r} is no viseme")
        table[int(name)] = values
    absent = [v for v in range(1, N_VISEMES) if not table[v].any()]
    if absent:
        raise DataError("visemes.tsv", None, f"no row for viseme {', '.join(map(str, absent))}")
    return table


@cache
def expressions() -> dict[str, NDArray[np.float64]]:
    """Low-level FAP values of each expression at full intensity, shape (68,), FAP units."""
    table = {name: values for _, name, values in _rows("expressions.tsv")}
    if set(table) != set(EXPRESSIONS):
        raise DataError("expressions.tsv", None, f"expected exactly {', '.join(EXPRESSIONS)}")
    return table


@cache
def coding_ranges() -> NDArray[np.int32]:
    """Default ranges of FBA predictive coding, int32 (68, 2): magnitude in I frames, in P frames.

    In quantised units: times the FAP's `quant` they are FAP units. 0 for FAPs 1 and 2.
    """
    table = np.zeros((N_FAPS, 2), np.int32)
    for number, line in read_lines("fap", "coding.tsv"):
        try:
            fap, i_reach, p_reach = map(int, line.split("\t"))
        except ValueError:
            fap = 0
        if not 3 <= fap <= N_FAPS:
            raise DataError("coding.tsv", number, f"{line!r} is not a low-level FAP, I and P range")
        table[fap - 1] = i_reach, p_reach
    return table


@cache
def limits() -> NDArray[np.float64]:
    """How far a living face goes: lowest and highest value of each FAP, shape (68, 2), FAP units.

    Anatomy, not coding ranges. Rows of FAPs 1 and 2, which are selections, are 0. Raises DataError.
    """
    name = "limits.tsv"
    table = np.full((N_FAPS, 2), np.nan)
    table[:2] = 0.0
    for number, line in read_lines("fap", name):
        try:
            fap, low, high, _ = line.split("\t")
            index, pair = int(fap), (float(low), float(high))
        except ValueError as e:
            raise DataError(name, number, str(e)) from None
        if not 3 <= index <= N_FAPS or not pair[0] <= 0 <= pair[1] or pair[0] == pair[1]:
            raise DataError(name, number, "expected a FAP of 3 to 68 and limits on both sides of 0")
        table[index - 1] = pair
    absent = np.flatnonzero(np.isnan(table[:, 0])) + 1
    if absent.size:
        raise DataError(name, None, f"no row for FAP {', '.join(map(str, absent))}")
    return table


def _rows(name: str) -> Iterator[tuple[int, str, NDArray[np.float64]]]:
    """Lines `name<TAB>fap=value fap=value ...` as (line number, name, values of shape (68,))."""
    for number, line in read_lines("fap", name):
        key, _, pairs = line.partition("\t")
        values = np.zeros(N_FAPS)
        for pair in pairs.split():
            fap, equals, value = pair.partition("=")
            try:
                index = int(fap)
                values[index - 1] = float(value)
            except (ValueError, IndexError):
                raise DataError(name, number, f"{pair!r} is not fap=value") from None
            if not equals or not 3 <= index <= N_FAPS:
                raise DataError(name, number, f"{pair!r} is not fap=value with a FAP of 3 to 68")
        yield number, key.strip(), values
