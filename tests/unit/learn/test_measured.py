"""FAPs that a face made are measured on it, whatever the head does meanwhile."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.errors import ClipError
from fapstream.learn.landmarks import Landmarks
from fapstream.learn.measured import LONGEST_GAP_S, MEASURED, RATE, measure_clip
from tests.unit.learn.talker import IDS, MNS, MW, moved, turned

RNG = np.random.default_rng(3)


def slow(n: int, seed: int = 1) -> np.ndarray:
    """FAPs (n, 68) that begin and end at rest and change as slowly as a camera can follow."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 1, n)
    values = np.zeros((n, 68))
    for fap in MEASURED:
        size = 60 if fap < 31 or fap > 50 else 20
        course = sum(rng.normal() * np.sin(np.pi * k * t) for k in range(1, 4))
        values[:, fap - 1] = size * course * np.sin(np.pi * np.clip((t - 0.15) / 0.7, 0, 1)) ** 2
    values[:, 4] = -np.abs(values[:, 4])
    return values


def clip(values: np.ndarray, fps: float = 25.0, noise: float = 0.0) -> Landmarks:
    return Landmarks(turned(moved(values), np.random.default_rng(2), noise), IDS, fps)


@pytest.mark.parametrize("fps", [25.0, 30.0, 50.0])
def test_faps_that_were_made_are_measured(fps: float) -> None:
    values = slow(int(3 * fps))
    found = measure_clip(clip(values, fps))
    at = np.arange(len(found.faps)) / RATE * fps
    for fap in MEASURED:
        wanted = np.interp(at, np.arange(len(values)), values[:, fap - 1])
        assert found.faps[:, fap - 1] == pytest.approx(wanted, abs=3 + 0.06 * np.abs(wanted).max()), fap
    others = np.setdiff1d(np.arange(68), np.array(MEASURED) - 1)
    assert not found.faps[:, others].any()
    assert found.seen.all()


def test_units_are_the_faces_own() -> None:
    """At 90 mm between the outer corners of the eyes, as this face has them."""
    fapu = measure_clip(clip(slow(75))).fapu
    assert fapu.mns0 == pytest.approx(MNS / 1000, rel=0.02)
    assert fapu.mw0 == pytest.approx(MW / 1000, rel=0.02)


def test_the_trackers_noise_is_smoothed() -> None:
    still = measure_clip(clip(np.zeros((75, 68)), noise=0.3))
    rough = 0.3 * np.sqrt(2) / (MNS / 1024)
    assert still.faps[:, 4].std() < rough


def test_a_short_loss_is_bridged_and_a_long_one_is_not_seen() -> None:
    values = slow(75)
    whole = clip(values)
    points = whole.points.copy()
    points[30:33] = np.nan
    bridged = measure_clip(Landmarks(points, IDS))
    assert bridged.seen.all()
    points[30 : 30 + int(2 * LONGEST_GAP_S * 25)] = np.nan
    lost = measure_clip(Landmarks(points, IDS))
    assert not lost.seen[125:150].any()
    assert lost.seen[:110].all()
    assert lost.seen[170:].all()
    assert np.isfinite(lost.faps).all()


@pytest.mark.parametrize(
    ("spoil", "why"),
    [
        (lambda p: p[:6], "too short"),
        (lambda p: p * np.nan, "no face"),
        (lambda p: p * 0, "one place"),
        (lambda p: p[:, :5], "expected points"),
    ],
)
def test_what_shows_no_face_says_so(spoil: object, why: str) -> None:
    points = clip(slow(75)).points
    with pytest.raises(ClipError, match=why):
        measure_clip(Landmarks(spoil(points), IDS))  # type: ignore[operator]


def test_points_that_are_not_tracked_are_named() -> None:
    points = clip(slow(75)).points
    keep = [i for i, point in enumerate(IDS) if point != 152]
    with pytest.raises(ClipError, match="152"):
        measure_clip(Landmarks(points[:, keep], tuple(IDS[i] for i in keep)))
