"""Six parameters of a face: even on both sides, and FAPs by definition."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.head import Fapu
from fapstream.learn.articulatory import NAMES, ArticulatoryParameters, even
from fapstream.learn.measured import LOWER, faps_of
from fapstream.motion.articulation import COLUMNS, SPOKEN
from tests.unit.learn.talker import IDS, TARGETS, moved, neutral, performed, said

FAPU = Fapu(0.0095, 0.06, 0.047, 0.02, 0.05)
AT = [IDS.index(point) for point in LOWER]


def speech(seed: int) -> np.ndarray:
    """How far the points of LOWER are from neutral, (n, m, 2), with noise: nobody is only his targets."""
    rng = np.random.default_rng(seed)
    faps = performed(*said(["soft", "blue", "may", "we", "lay"], rng))
    points = (moved(faps) - neutral())[:, AT, :2]
    return points + rng.normal(0, 0.1, points.shape)


TALK = [speech(k) for k in range(6)]
MODEL = ArticulatoryParameters().fit(TALK, FAPU)


def test_there_are_six_with_names_and_unit_variance() -> None:
    found = np.concatenate([MODEL.transform(points) for points in TALK])
    assert found.shape[1] == len(NAMES) == MODEL.articulation_.n == 6
    assert np.cov(found.T, bias=True) == pytest.approx(np.eye(6), abs=1e-6)
    assert MODEL.pca_.explained_.sum() > 0.8


def test_faps_of_parameters_are_those_of_the_even_points_that_they_stand_for() -> None:
    parameters = MODEL.transform(TALK[0])
    rows = MODEL.pca_.inverse_transform(parameters).reshape(-1, len(LOWER), 2)
    wanted = faps_of(rows, LOWER, FAPU, SPOKEN)[:, COLUMNS]
    assert MODEL.articulation_.faps(parameters) == pytest.approx(wanted)


def test_the_first_opens_the_jaw() -> None:
    assert MODEL.articulation_.basis[0, SPOKEN.index(3)] > 0
    open_wide = np.tile([TARGETS["AA"][0]], 1)[0]
    faps = np.zeros((1, 68))
    faps[0, 2] = open_wide
    assert MODEL.transform((moved(faps) - neutral())[:, AT, :2])[0, 0] > 1


def test_a_crooked_mouth_is_made_even() -> None:
    crooked = speech(9)
    crooked[:, LOWER.index(291), 1] += 5.0
    left, right = LOWER.index(291), LOWER.index(61)
    straight = even(crooked)
    assert straight[:, left, 1] == pytest.approx(straight[:, right, 1])
    assert straight[:, left, 0] == pytest.approx(-straight[:, right, 0])
    assert even(straight) == pytest.approx(straight)


def test_plain_components_are_told_beside_them() -> None:
    parts = MODEL.components(9)
    assert len(parts) == 9
    assert (np.diff(parts) <= 1e-12).all()
    assert MODEL.pca_.explained_.sum() <= parts[:6].sum() + 1e-9
