"""Six parameters of the lower face: even, linear, and to the side that their names tell."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from fapstream.errors import ClipError
from fapstream.learn.articulatory import NAMES, ArticulatoryParameters, even
from fapstream.learn.landmarks import table
from fapstream.learn.measured import LOWER, faps_of
from fapstream.motion.articulation import COLUMNS, SPOKEN
from tests.unit.learn.faces import FAPU, IDS, NEUTRAL, moved

Floats = NDArray[np.float64]
HERE = [IDS.index(point) for point in LOWER]


def speech(seed: int, n: int = 300, noise_mm: float = 0.3) -> Floats:
    """A jaw that takes lower lip and corners along, lips that part, round and rise, (n, m, 2) mm."""
    rng = np.random.default_rng(seed)
    jaw, part, spread, rise = rng.normal(size=(4, n)) * np.array([300, 80, 60, 90])[:, None]
    values = {3: jaw, 4: -part, 5: -0.8 * jaw - part, 6: spread, 7: spread, 8: -part, 9: -part,
              10: -0.7 * jaw - part, 11: -0.7 * jaw - part, 12: rise - 0.3 * jaw, 13: rise - 0.3 * jaw,
              51: -part, 52: -0.8 * jaw - 0.5 * part, 53: spread, 54: spread, 55: -part, 56: -part,
              57: -0.7 * jaw, 58: -0.7 * jaw, 59: rise, 60: rise}  # fmt: skip
    points = moved(values)[:, HERE, :2] - NEUTRAL[HERE, :2]
    return np.asarray(points + noise_mm * rng.normal(size=points.shape))


def mirrored(points: Floats) -> Floats:
    """The face in a mirror."""
    twin = {row.point: row.mirror for row in table()}
    return np.asarray(points[:, [LOWER.index(twin[point]) for point in LOWER]] * np.array([-1.0, 1.0]))


def fitted(seed: int = 0) -> ArticulatoryParameters:
    return ArticulatoryParameters().fit([speech(seed), speech(seed + 100, 50)], FAPU)


def test_an_even_face_is_its_own_mirror_image_and_stays_as_it_is() -> None:
    crooked = speech(1)
    straight = even(crooked)
    np.testing.assert_allclose(mirrored(straight), straight, atol=1e-12)
    np.testing.assert_allclose(even(straight), straight, atol=1e-12)
    np.testing.assert_allclose(even(mirrored(crooked)), straight, atol=1e-12)
    np.testing.assert_allclose(straight, (crooked + mirrored(crooked)) / 2, atol=1e-12)


def test_a_face_and_its_mirror_image_have_the_same_parameters() -> None:
    parameters, new = fitted(), speech(2)
    np.testing.assert_allclose(parameters.transform(mirrored(new)), parameters.transform(new), atol=1e-9)


def test_faps_of_parameters_are_those_of_the_points_made_of_them() -> None:
    """To reconstruct even points and to measure these, or to go straight to FAPs: the same."""
    parameters, new = fitted(), speech(3)
    values = parameters.transform(new)
    points = parameters.pca_.inverse_transform(values).reshape(-1, len(LOWER), 2)
    expected = faps_of(points, LOWER, FAPU, SPOKEN)[:, COLUMNS]
    np.testing.assert_allclose(parameters.articulation_.faps(values), expected, atol=1e-8)


def test_left_and_right_do_the_same() -> None:
    articulation = fitted().articulation_
    pairs = [(6, 7), (8, 9), (10, 11), (12, 13), (53, 54), (55, 56), (57, 58), (59, 60)]
    for left, right in pairs:
        a, b = SPOKEN.index(left), SPOKEN.index(right)
        np.testing.assert_allclose(articulation.basis[:, a], articulation.basis[:, b], atol=1e-9)
        assert articulation.mean[a] == pytest.approx(articulation.mean[b])


def test_parameters_are_of_unit_variance_over_all_speech_and_mean_nothing_there() -> None:
    parts = [speech(0), speech(100, 50) + 1.0]
    parameters = ArticulatoryParameters().fit(parts, FAPU)
    found = parameters.transform(np.concatenate(parts))
    assert found.shape == (350, len(NAMES))
    np.testing.assert_allclose(found.mean(axis=0), 0, atol=1e-9)
    np.testing.assert_allclose(np.cov(found, rowvar=False, bias=True), np.eye(6), atol=1e-8)
    mean = faps_of(even(np.concatenate(parts)).mean(axis=0)[None], LOWER, FAPU, SPOKEN)[0, COLUMNS]
    np.testing.assert_allclose(parameters.articulation_.mean, mean, atol=1e-9)


def test_the_first_opens_the_jaw_and_almost_all_faps_come_back() -> None:
    parameters, new = fitted(), speech(4, noise_mm=0.0)
    articulation = parameters.articulation_
    assert articulation.names == NAMES
    assert articulation.basis[0, SPOKEN.index(3)] == pytest.approx(300, rel=0.15)
    assert articulation.basis[0, SPOKEN.index(5)] < -100
    measured = faps_of(new, LOWER, FAPU, SPOKEN)[:, COLUMNS]
    wrong = articulation.faps(parameters.transform(new)) - measured
    assert (wrong**2).mean() < 0.02 * measured.var(axis=0).mean()


def test_plain_components_are_told_for_comparison() -> None:
    parameters = fitted()
    found = parameters.components(9)
    assert found.shape == (9,)
    assert (np.diff(found) <= 0).all()
    assert found[:6].sum() >= parameters.pca_.explained_.sum()
    rows = even(np.concatenate([speech(0), speech(100, 50)])).reshape(350, -1)
    power = np.linalg.svd(rows - rows.mean(axis=0), compute_uv=False) ** 2
    np.testing.assert_allclose(found, (power / power.sum())[:9])


def test_a_photo_is_no_speech() -> None:
    with pytest.raises(ClipError, match="nothing moves"):
        ArticulatoryParameters().fit([np.zeros((100, len(LOWER), 2))], FAPU)
