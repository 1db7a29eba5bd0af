"""Ohman's formula by hand, and that a unit's mouth needs the four units after it and no more."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fapstream.errors import DataError
from fapstream.motion.ohman import (
    READY,
    Ohman,
    OhmanMouth,
    emerged,
    emergence,
    interpolation,
    keys,
    soft,
    stand_in,
)
from fapstream.motion.speaker import speaker
from fapstream.motion.units import SIL, TimedUnit, features
from tests.unit.motion.test_hmm import RATE, TALKS, instants, timed

MOUTH = OhmanMouth(speaker().ohman)


def small(weight: float, curve: tuple[float, float, float, float] = (0.5, 0.08, 0.08, 0.2)) -> Ohman:
    """One parameter: AA opens (1), IY half (0.4), silence is 0; P is at -1."""
    targets = ("AA1", "IY1", SIL, READY)
    return Ohman(
        targets, np.array([[1.0], [0.4], [0.0], [0.0]]), ("P", "T"),
        np.array([[weight], [0.1]]), np.array([[-1.0], [0.5]]), np.tile(curve, (2, 1, 1)),
    )  # fmt: skip


@pytest.fixture
def english(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only these phones exist."""
    few = {u: f for u, f in features().items() if u in ("AA1", "AA0", "IY1", "IY0", "P", "T", SIL)}
    monkeypatch.setattr("fapstream.motion.ohman.features", lambda: few)


@pytest.mark.usefixtures("english")
def test_a_closure_that_does_not_depend_on_vowels_is_reached_and_one_that_does_half() -> None:
    """p = v + k w (c - v): with k = 1 and w = 1 it is c, with w = 0.5 half way from the carrier."""
    units = timed([("AA1", 200), ("P", 100), ("AA1", 200), (SIL, 300)])
    middle = round(0.25 / 0.02)
    for weight, expected in ((1.0, -1.0), (0.5, 0.0), (0.0, 1.0)):
        made = OhmanMouth(small(weight)).parameters(units, instants(units), 0, RATE)[:, 0]
        assert made[middle] == pytest.approx(expected, abs=1e-6)


@pytest.mark.usefixtures("english")
def test_the_carrier_goes_from_vowel_to_vowel_as_if_nothing_were_between() -> None:
    made = OhmanMouth(small(0.0)).parameters(
        units := timed([("AA1", 200), ("P", 100), ("IY1", 200), (SIL, 300)]), instants(units), 0, RATE
    )[:, 0]
    between = made[round(0.13 / 0.02) : round(0.37 / 0.02)]
    assert (np.diff(between) <= 1e-9).all()
    assert made[round(0.1 / 0.02)] == pytest.approx(1.0)
    assert made[round(0.4 / 0.02)] == pytest.approx(0.4)


def test_consonants_build_on_each_other_in_their_order() -> None:
    carrier, shown = np.ones((1, 1)), np.array([[[0.5], [1.0]]])
    target = np.array([[0.0], [-1.0]])
    assert emerged(carrier, shown, target) == pytest.approx(-1.0)
    assert emerged(carrier, shown[:, ::-1], target[::-1]) == pytest.approx(-0.5)


def test_the_stronger_consonant_has_the_last_word() -> None:
    """w orders them, not time: P after T and P before T both close wholly."""
    for names in (("T", "P"), ("P", "T")):
        units = timed([("AA1", 150), (names[0], 60), (names[1], 60), ("AA1", 150), (SIL, 200)])
        of = instants(units)
        made = MOUTH.parameters(units, of, 0, RATE)
        assert np.isfinite(made).all()


def test_a_curve_is_nothing_whole_and_nothing_again_without_a_step() -> None:
    t = np.linspace(0, 1, 1001)
    curve = np.array([[[0.5, 0.1, 0.2, 0.25]]])
    k = emergence(t, np.array([[0.4, 0.6]]), curve)[:, 0, 0]
    assert k[t < 0.34].max() == k[t > 0.76].max() == 0
    assert k[(t >= 0.45) & (t <= 0.55)].min() == pytest.approx(1)
    assert np.abs(np.diff(k)).max() < 0.02
    assert soft(np.array([-1.0, 0.5, 2.0])).tolist() == [0.0, 0.5, 1.0]


def test_an_instant_looks_no_further_than_it_may() -> None:
    places = np.array([0.0, 1.0, 2.0])
    weights = interpolation(places, np.array([0.5, 0.5, 1.5, 9.0]), np.array([2, 0, 1, 2]))
    assert weights.sum(axis=1) == pytest.approx(1.0)
    assert weights[0].tolist() == [0.5, 0.5, 0.0]
    assert weights[1].tolist() == [1.0, 0.0, 0.0]
    assert weights[2].tolist() == [0.0, 1.0, 0.0]
    assert weights[3].tolist() == [0.0, 0.0, 1.0]


@settings(max_examples=40, deadline=None)
@given(TALKS, st.integers(0, 100))
@example([("B", 20)] * 5 + [("AA0", 20)], 0)
def test_what_comes_after_the_next_four_units_changes_nothing(talk: list[tuple[str, int]], at: int) -> None:
    """A vowel far behind many consonants is not in sight, either."""
    units = timed(talk)
    at %= max(1, len(units) - 4)
    of = instants(units)
    wanted = np.flatnonzero(of <= at)
    if not len(wanted):
        return
    far = MOUTH.parameters(units, of, 0, RATE)[wanted]
    near = MOUTH.parameters(units[: at + 1 + MOUTH.look_ahead], of[wanted], 0, RATE)
    assert near == pytest.approx(far, abs=1e-9)


def test_a_pause_has_its_places_and_a_long_one_makes_ready() -> None:
    long, short = TimedUnit(SIL, 0, RATE), TimedUnit(SIL, 0, RATE // 10)
    assert [name for _, name in keys(long, RATE, True)] == [SIL, SIL, READY]
    assert [name for _, name in keys(long, RATE, False)] == [SIL, SIL]
    assert [name for _, name in keys(short, RATE, True)] == [READY]
    assert keys(TimedUnit("B", 0, RATE), RATE, True) == []
    assert [name for _, name in keys(TimedUnit("AY1", 0, RATE), RATE, True)] == ["AY1:1", "AY1:2"]


def test_phones_that_nobody_was_heard_to_say_have_a_stand_in() -> None:
    known = {"AA1": 0, "N": 1, "OW1:1": 2, "OW1:2": 3}
    assert stand_in("AA0", known) == "AA1"
    assert stand_in("NG", known) == "N"
    assert stand_in("UH", {"UW0": 0}) == "UW0"
    assert stand_in("OW0:2", known) == "OW1:2"
    assert stand_in("SH", known) == "N", "at least as far in front"
    with pytest.raises(DataError, match="nothing that the model knows stands in for SH"):
        stand_in("SH", {"AA1": 0, SIL: 1})


def test_a_model_that_lacks_what_cannot_be_replaced_is_refused() -> None:
    model = speaker().ohman
    with pytest.raises(DataError, match="stands in for"):
        OhmanMouth(replace(model, consonants=tuple(f"x{c}" for c in model.consonants)))
