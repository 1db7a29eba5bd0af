"""FAPs measured on a film of a face that moves by known FAPs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from fapstream.errors import ClipError
from fapstream.fap import faps
from fapstream.learn.landmarks import Landmarks, points_of
from fapstream.learn.measured import (
    LONGEST_GAP_S,
    LOWER,
    MEASURED,
    RATE,
    faps_of,
    feature_points,
    measure_clip,
    neutral_face,
)
from tests.unit.learn.faces import FAPU, IDS, NEUTRAL, filmed, moved

Floats = NDArray[np.float64]
COLUMNS = np.array(MEASURED) - 1
OPENING = {3: 1, 5: -1, 10: -1, 11: -1, 52: -1, 57: -1, 58: -1}
"""FAPs that a mouth opens with, and their signs."""


def waves(seed: int, t: Floats) -> dict[int, Floats]:
    """Every measured FAP goes up and down slowly, from rest to rest; the mouth is closed only at rest."""
    rng, length = np.random.default_rng(seed), t[-1]
    rise = np.sin(np.pi * np.clip((t - 0.3) / (length - 0.6), 0, 1)) ** 4
    size = {number: rng.uniform(-120, 120) for number in MEASURED}
    size |= {number: sign * rng.uniform(150, 300) for number, sign in OPENING.items()}
    return {number: size[number] * rise for number in MEASURED}


def at_rate(values: dict[int, Floats]) -> Floats:
    found = np.zeros((len(next(iter(values.values()))), 68))
    for number, track in values.items():
        found[:, number - 1] = track
    return found


def times(seconds: float, rate: float) -> Floats:
    return np.arange(round(seconds * rate) + 1) / rate


@pytest.mark.parametrize("fps", [25.0, 30.0, 50.0])
@pytest.mark.parametrize("seed", range(4))
def test_what_the_face_was_moved_by_is_measured(seed: int, fps: float) -> None:
    """Head turned and moved anew in every frame; nothing but what interpolation costs is lost."""
    film = filmed(moved(waves(seed, times(3, fps))), np.random.default_rng(seed), fps)
    found = measure_clip(film)
    expected = at_rate(waves(seed, times(3, RATE)))
    assert found.faps.shape == expected.shape == (301, 68)
    assert found.seen.all()
    assert found.fapu.as_dict() == pytest.approx(FAPU.as_dict(), rel=1e-3)
    assert np.abs(found.faps - expected).max() < 3


def test_noise_of_a_tracker_stays_noise() -> None:
    """0.5 px, a third of a millimetre: hardly more in any FAP, and no more of it stays where it was."""
    film = filmed(moved(waves(1, times(4, 25))), np.random.default_rng(1), noise_px=0.5)
    found = measure_clip(film)
    wrong = (found.faps - at_rate(waves(1, times(4, RATE))))[:, COLUMNS]
    units = np.array([1000 * FAPU.per_unit(faps()[number - 1].unit) for number in MEASURED])
    assert np.sqrt((wrong**2).mean(axis=0) * units**2).max() < 0.45
    assert np.abs(wrong.mean(axis=0) * units).max() < 0.35


@pytest.mark.parametrize("number", MEASURED)
def test_a_fap_has_the_sign_and_unit_of_the_standard_and_is_no_other(number: int) -> None:
    """One feature point is moved as Annex C says: 100 units of its distance to the positive side."""
    found = faps_of(moved({number: np.array([100.0])}) - NEUTRAL, IDS, FAPU, MEASURED)[0]
    assert found[number - 1] == pytest.approx(100)
    assert np.flatnonzero(np.abs(found) > 1e-9).tolist() == [number - 1]


def test_only_what_was_asked_for_is_measured() -> None:
    everything = moved({number: np.array([50.0]) for number in MEASURED}) - NEUTRAL
    found = faps_of(everything, IDS, FAPU, (3, 4))
    assert np.flatnonzero(found[0]).tolist() == [2, 3]
    assert not faps_of(everything, IDS, FAPU, MEASURED)[0, np.delete(np.arange(68), COLUMNS)].any()


def test_what_lies_in_depth_is_not_measured() -> None:
    """Thrust of the jaw and lips that are pushed forward move nothing in the plane of the face."""
    film = filmed(moved({number: 200 * waves(0, times(2, 25))[3] / 300 for number in (14, 16, 17)}))
    assert np.abs(measure_clip(film).faps).max() < 1e-6


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.floats(-3, 3), st.floats(-3, 3))
def test_faps_are_linear_in_how_far_points_are(seed: int, a: float, b: float) -> None:
    rng = np.random.default_rng(seed)
    one, other = rng.normal(size=(2, 4, len(IDS), 3))
    both = faps_of(a * one + b * other, IDS, FAPU, MEASURED)
    each = a * faps_of(one, IDS, FAPU, MEASURED) + b * faps_of(other, IDS, FAPU, MEASURED)
    np.testing.assert_allclose(both, each, atol=1e-9 * np.abs(each).max() + 1e-9)


def test_a_feature_point_of_several_is_their_mean() -> None:
    points = np.random.default_rng(0).normal(size=(3, len(IDS), 3))
    found = feature_points(points, IDS, ("3.5", "2.1"))
    iris = [IDS.index(i) for i in (474, 475, 476, 477)]
    np.testing.assert_allclose(found["3.5"], points[:, iris].mean(axis=1))
    np.testing.assert_allclose(found["2.1"], points[:, IDS.index(152)])


def test_the_neutral_face_is_the_closed_mouth_however_long_it_is_open() -> None:
    """An open mouth for nine tenths of the clip is not taken for rest, nor what brows do meanwhile."""
    rng = np.random.default_rng(2)
    shut = np.zeros(100)
    shut[:45] = rng.uniform(200, 400, 45)
    shut[55:] = rng.uniform(200, 400, 45)
    points = moved({3: shut, 5: -shut, 31: rng.uniform(-90, 90, 100) * (shut > 0)})
    np.testing.assert_allclose(neutral_face(points, IDS), NEUTRAL, atol=1e-9)


def test_points_are_those_of_the_lower_face_in_the_tables_order() -> None:
    assert points_of("jaw", "lips", "face") == LOWER
    found = measure_clip(filmed(moved(waves(3, times(2, 25))), np.random.default_rng(3)))
    expected = (moved(waves(3, times(2, RATE))) - NEUTRAL)[:, [IDS.index(p) for p in LOWER], :2]
    assert np.abs(found.points - expected).max() < 0.1


def test_a_short_gap_is_bridged() -> None:
    film = filmed(moved(waves(5, times(3, 25))), np.random.default_rng(5))
    film.points[30:35] = np.nan
    film.points[50] = np.nan
    found = measure_clip(film)
    assert found.seen.all()
    assert np.abs(found.faps - at_rate(waves(5, times(3, RATE)))).max() < 10


@pytest.mark.parametrize("fps", [25.0, 30.0, 50.0])
def test_a_long_gap_is_not_measured_but_all_around_it(fps: float) -> None:
    film = filmed(moved(waves(6, times(3, fps))), np.random.default_rng(6), fps)
    lost = np.arange(round(fps), round(1.5 * fps))
    film.points[lost] = np.nan
    found = measure_clip(film)
    t = np.arange(301) / RATE
    inside = (t > (lost[0] - 1) / fps + 1e-9) & (t < (lost[-1] + 1) / fps - 1e-9)
    assert found.seen.tolist() == (~inside).tolist()
    wrong = np.abs(found.faps - at_rate(waves(6, times(3, RATE))))
    assert wrong[found.seen].max() < 10


@pytest.mark.parametrize("frames", [5, 6])
def test_the_longest_gap_that_is_bridged(frames: int) -> None:
    film = filmed(moved(waves(7, times(2, 25))))
    film.points[20 : 20 + frames] = np.nan
    assert measure_clip(film).seen.all() == (frames <= LONGEST_GAP_S * 25)


def test_before_the_face_comes_and_after_it_goes_nothing_is_measured() -> None:
    film = filmed(moved(waves(8, times(3, 25))), np.random.default_rng(8))
    film.points[:8], film.points[70:] = np.nan, np.nan
    seen = np.flatnonzero(measure_clip(film).seen)
    assert (seen[0], seen[-1], len(seen)) == (32, 276, 245)


@pytest.mark.parametrize("fps", [24.0, 25.0, 29.97, 30.0, 50.0, 60.0])
@pytest.mark.parametrize("frames", [25, 29, 57, 76, 113])
def test_a_face_that_was_always_there_was_seen_all_the_time(frames: int, fps: float) -> None:
    """Up to the last frame, wherever rounding puts it."""
    found = measure_clip(filmed(moved(waves(9, np.arange(frames) / fps)), fps=fps))
    last = int((frames - 1) / fps * RATE + 1e-6)
    assert len(found.seen) == len(found.faps) == len(found.points) == last + 1
    assert found.seen.all()


def test_too_few_frames_with_a_face_are_refused() -> None:
    film = filmed(moved(waves(0, times(2, 25))))
    film.points[9:] = np.nan
    with pytest.raises(ClipError, match="only 9 frames"):
        measure_clip(film)
    film = filmed(moved(waves(0, times(0.56, 25))), fps=10.0)
    film.points[4:] = np.nan
    with pytest.raises(ClipError, match="only 4 frames"):
        measure_clip(film)


@pytest.mark.parametrize("frames", [0, 30])
def test_no_face_at_all_is_refused(frames: int) -> None:
    with pytest.raises(ClipError, match="no face"):
        measure_clip(Landmarks(np.full((frames, len(IDS), 3), np.nan), IDS))


@pytest.mark.parametrize("absent", [13, 152, 475, 70, 164, 33])
def test_a_missing_point_is_named(absent: int) -> None:
    film = filmed(moved(waves(0, times(1, 25))))
    kept = [i for i, point in enumerate(IDS) if point != absent]
    with pytest.raises(ClipError, match=rf"not in the file: {absent}$"):
        measure_clip(Landmarks(film.points[:, kept], tuple(IDS[i] for i in kept)))


def test_a_mouth_above_the_nose_is_refused() -> None:
    """It is said which distance of the FAPU is not positive."""
    points = moved(waves(0, times(1, 25)))
    points[:, [IDS.index(p) for p in points_of("lips")], 1] += 200
    with pytest.raises(ClipError, match="no face: MNS0"):
        measure_clip(filmed(points))


def test_points_that_are_all_in_one_place_are_no_face() -> None:
    with pytest.raises(ClipError, match="no face"):
        measure_clip(Landmarks(np.full((30, len(IDS), 3), 100.0), IDS))
