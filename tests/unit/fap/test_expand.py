"""ISO/IEC 14496-2, semantics of FAP 1 (viseme) and FAP 2 (expression)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from fapstream.fap.expand import Expander, uses
from fapstream.fap.rows import FapRow
from fapstream.fap.tables import EXPRESSIONS, expressions, faps, visemes
from fapstream.records import N_FAPS, ExpressionFap, VisemeFap

JAW, LIP, BROW, LID, HEAD = 3, 5, 31, 19, 48


def row(
    viseme: VisemeFap | None = None,
    expression: ExpressionFap | None = None,
    sent: dict[int, int] | None = None,
) -> FapRow:
    """`sent` is FAP: value."""
    mask, values = np.zeros(N_FAPS, np.bool_), np.zeros(N_FAPS, np.int32)
    for fap, value in (sent or {}).items():
        mask[fap - 1], values[fap - 1] = True, value
    mask[0], mask[1] = viseme is not None, expression is not None
    return FapRow(0, mask, values, viseme, expression)


def vector(sent: dict[int, int]) -> NDArray[np.float64]:
    return row(sent=sent).values.astype(float)


def expression(select: int) -> NDArray[np.float64]:
    return expressions()[EXPRESSIONS[select - 1]]


def same(face: NDArray[np.int32], expected: NDArray[np.float64]) -> bool:
    return float(np.abs(face - expected).max()) < 0.5 + 1e-9


@pytest.mark.parametrize("select", range(15))
def test_a_viseme_alone(select: int) -> None:
    assert np.array_equal(Expander().step(row(VisemeFap(select, 0, 63))), visemes()[select])
    assert np.array_equal(Expander().step(row(VisemeFap(0, select, 0))), visemes()[select])


@pytest.mark.parametrize("select", range(1, 7))
def test_an_expression_alone(select: int) -> None:
    assert same(Expander().step(row(expression=ExpressionFap(select, 63))), expression(select))
    assert same(Expander().step(row(expression=ExpressionFap(0, 63, select, 63))), expression(select))


@settings(deadline=None)
@given(st.integers(0, 14), st.integers(0, 14), st.integers(0, 63))
def test_visemes_blend(one: int, two: int, blend: int) -> None:
    """viseme = v1 * blend/63 + v2 * (1 - blend/63)."""
    expected = visemes()[one] * (blend / 63) + visemes()[two] * (1 - blend / 63)
    assert same(Expander().step(row(VisemeFap(one, two, blend))), expected)


@settings(deadline=None)
@given(st.integers(1, 6), st.integers(0, 63), st.integers(1, 6), st.integers(0, 63))
def test_expressions_add_up(one: int, level1: int, two: int, level2: int) -> None:
    """expression = e1 * i1/63 + e2 * i2/63."""
    expected = expression(one) * level1 / 63 + expression(two) * level2 / 63
    assert same(Expander().step(row(expression=ExpressionFap(one, level1, two, level2))), expected)


def test_both_blend_with_low_level_faps() -> None:
    sent = {JAW: 20, HEAD: -500}
    face = Expander().step(row(VisemeFap(10, 0, 63), ExpressionFap(1, 63), sent))
    assert same(face, visemes()[10] + expression(1) + vector(sent))


def test_what_is_not_sent_stays() -> None:
    decoder = Expander()
    first = decoder.step(row(VisemeFap(4, 0, 63), ExpressionFap(2, 63), {HEAD: 9}))
    assert np.array_equal(decoder.step(row()), first)
    assert same(decoder.step(row(VisemeFap())), expression(2) + vector({HEAD: 9}))
    assert same(decoder.step(row(expression=ExpressionFap())), vector({HEAD: 9}))
    assert not decoder.step(row(sent={HEAD: 0})).any()


def test_high_level_faps_are_0_themselves() -> None:
    decoder = Expander()
    face = decoder.step(FapRow(0, np.ones(N_FAPS, np.bool_), np.full(N_FAPS, 7, np.int32), VisemeFap()))
    assert not face[:2].any()
    assert (face[2:] == 7).all()


def test_viseme_def() -> None:
    """The mouth's FAPs sent along are the viseme from now on; the others move the face as ever."""
    decoder = Expander()
    face = decoder.step(row(VisemeFap(1, 0, 63, define=True), sent={JAW: 300, LIP: -90, HEAD: 5}))
    assert same(face, vector({JAW: 300, LIP: -90, HEAD: 5})), "not counted twice"
    assert same(decoder.step(row(VisemeFap(2, 0, 63))), visemes()[2] + vector({HEAD: 5}))
    half = decoder.step(row(VisemeFap(1, 0, 21)))
    assert same(half, vector({JAW: 100, LIP: -30, HEAD: 5}))
    assert np.array_equal(Expander().step(row(VisemeFap(1, 0, 63))), visemes()[1]), "of one decoder only"


def test_expression_def() -> None:
    decoder = Expander()
    face = decoder.step(row(expression=ExpressionFap(3, 63, define=True), sent={BROW: 80, LID: 40}))
    assert same(face, vector({BROW: 80, LID: 40}))
    assert not decoder.step(row(expression=ExpressionFap())).any()
    assert same(decoder.step(row(expression=ExpressionFap(0, 0, 3, 63))), vector({BROW: 80, LID: 40}))


def test_both_defined_at_once_share_the_faps() -> None:
    decoder = Expander()
    decoder.step(row(VisemeFap(5, define=True), ExpressionFap(6, define=True), {JAW: 30, BROW: 60}))
    assert same(decoder.step(row(VisemeFap(5, 0, 63), ExpressionFap())), vector({JAW: 30}))
    assert same(decoder.step(row(VisemeFap(), ExpressionFap(6, 63))), vector({BROW: 60}))


def test_defining_no_viseme_changes_nothing() -> None:
    decoder = Expander()
    assert not decoder.step(row(VisemeFap(0, 0, 63, define=True), sent={JAW: 300})).any()
    assert not decoder.step(row(VisemeFap(0, 0, 63))).any()


def test_init_face() -> None:
    """The neutral face is modified within its constraints: mouth, lids, eyes and head stay."""
    decoder = Expander()
    rest = decoder.step(row(expression=ExpressionFap(2, 63, init_face=True)))
    groups = np.array([f.group for f in faps()])
    assert same(rest, np.where(np.isin(groups, (4, 5, 9, 10)), expression(2), 0))
    assert rest[BROW - 1] > 0
    assert not rest[[LIP - 1, LID - 1, 12 - 1]].any()
    assert same(decoder.step(row(VisemeFap(10, 0, 63))), rest + visemes()[10])
    assert same(
        decoder.step(row(VisemeFap(), ExpressionFap(1, 63), {BROW: 7})),
        rest + expression(1) + vector({BROW: 7}),
    )
    decoder.step(row(expression=ExpressionFap(init_face=True)))
    assert same(decoder.step(row(sent={BROW: 0})), np.zeros(N_FAPS)), "the first neutral face again"


def test_what_faps_are_used_for() -> None:
    sent = {JAW: 1, BROW: 2}
    for viseme, expression_, expected in [
        (VisemeFap(1), None, ([JAW, BROW], [], [])),
        (VisemeFap(1, define=True), None, ([BROW], [JAW], [])),
        (None, ExpressionFap(1, define=True), ([], [], [JAW, BROW])),
        (VisemeFap(1, define=True), ExpressionFap(1, define=True), ([], [JAW], [BROW])),
    ]:
        found = uses(row(viseme, expression_, sent))
        assert tuple((np.flatnonzero(mask) + 1).tolist() for mask in found) == expected


@pytest.mark.parametrize("sign", [-1, 1])
def test_values_stay_within_32_bits(sign: int) -> None:
    most = 2**31 - 1
    face = Expander().step(row(VisemeFap(10, 0, sign * 2**30), sent={JAW: sign * most, HEAD: sign * most}))
    assert face[[JAW - 1, HEAD - 1]].tolist() == [sign * most, sign * most]
    assert np.sign(face[LIP - 1]) == -sign, "viseme 10 lowers the lip"
