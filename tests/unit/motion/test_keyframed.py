"""The mouth of keyframes (its curves are in test_track)."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.motion.articulation import COLUMNS
from fapstream.motion.keyframed import KeyframedMouth
from fapstream.motion.mixer import Mouth
from fapstream.motion.speech import Speaking
from fapstream.records import N_FAPS, SILENCE, Phone
from tests.unit.fakes import timed

PHONES = timed([Phone("A", 120.0, stress=1), Phone("u", 120.0, stress=1), Phone(SILENCE, 300.0)], 16000)


def made(gain: float) -> Mouth:
    mouth = KeyframedMouth(Speaking("en", 16000, gain=gain), 50)
    for phone in PHONES:
        mouth.add(phone)
    return mouth.at(np.arange(0, PHONES[-1].end, 320))


def test_a_gain_multiplies_jaw_and_lips_alone() -> None:
    usual, much = made(1.0), made(1.5)
    others = np.setdiff1d(np.arange(N_FAPS), COLUMNS)
    assert much.values[:, COLUMNS] == pytest.approx(1.5 * usual.values[:, COLUMNS])
    assert np.array_equal(much.values[:, others], usual.values[:, others])
    assert np.array_equal(much.speaks, usual.speaks)


def test_it_rests_before_it_begins() -> None:
    mouth = KeyframedMouth(Speaking("en", 16000, start=8000), 50)
    for phone in timed([Phone("A", 120.0), Phone(SILENCE, 300.0)], 16000, 8000):
        mouth.add(phone)
    assert not mouth.at(np.arange(0, 8000, 320)).values.any()
