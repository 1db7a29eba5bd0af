"""FAPs measured on people: how far feature points are from where they are on the neutral face, in FAPU.

That is what a FAP is by definition (ISO/IEC 14496-2, Annex C). A camera in front sees what happens in its
plane: jaw, lips, corners, brows, lids. It does not see depth: thrust of the jaw (14) and protrusion of the
lips (16, 17) are not measured, nor is what the points do not show or speech does not need: the jaw's shift
(15), the chin's push (18), gaze and pupils, cheeks, tongue, head, nose and ears. Their columns stay 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import savgol_filter

from fapstream.errors import ClipError, DataError
from fapstream.fap import faps
from fapstream.head import Fapu, measure
from fapstream.learn.landmarks import Floats, Landmarks, columns, points_of, still, table
from fapstream.records import N_FAPS

RATE = 100
"""Samples a second of every track."""

MEASURED = tuple(f for f in (*range(3, 14), *range(19, 23), *range(31, 39), *range(51, 61)))
"""FAPs that a camera in front can measure."""

SMOOTH_FRAMES, SMOOTH_ORDER = 5, 3
"""A cubic through five frames takes the tracker's noise (0.35 to 0.7 mm a frame in GRID) down to 0.7 of it
and leaves a lip closure of two frames at 25 a second where it is."""

LOWER = points_of("jaw", "lips", "face")
"""The points that speech moves."""

LONGEST_GAP_S = 0.2
"""Over as long a gap without a face motion is interpolated; longer ones are not measured."""
SHORTEST_S = 0.4
"""A clip has to show the face for as long."""

NEAR_CLOSED_MM = 1.0
"""The neutral face is the median of the frames whose lips are no further apart than the closest by this."""
CLOSEST_PERCENT = 5

_DIRECTIONS = {"down": (1, -1), "up": (1, 1), "left": (0, 1), "right": (0, -1)}
"""Axis and sign of a FAP's positive motion."""


@dataclass(frozen=True, slots=True)
class Measured:
    """What a face does in a clip, RATE times a second from 0 s on.

    `faps`: shape (n, 68), FAP units; only those of MEASURED are, the rest is 0. `points`: how far the points
    of jaw, lips and face (in the table's order, m of them) are from neutral, shape (n, m, 2), mm at 90 mm
    between the outer corners of the eyes, to the subject's left and up. `seen`: shape (n,), whether the face
    was. `fapu`: of the neutral face, in metres at that size.
    """

    faps: Floats
    points: Floats
    seen: NDArray[np.bool_]
    fapu: Fapu


def measure_clip(landmarks: Landmarks) -> Measured:
    """The FAPs of a clip. Raises ClipError: too short, no face, points missing, a face that is none."""
    points = still(landmarks)
    seen = np.asarray(np.isfinite(points).all(axis=(1, 2)))
    if seen.sum() < max(SHORTEST_S * landmarks.fps, SMOOTH_FRAMES):
        raise ClipError(f"the face is to be seen in only {seen.sum()} frames: too short a clip")
    neutral = neutral_face(points[seen], landmarks.ids)
    names = tuple(dict.fromkeys(row.fdp for row in table() if row.fdp))
    at = feature_points(neutral[None], landmarks.ids, names)
    try:
        fapu = measure({name: _metres(at[name][0]) for name in names}, "the clip")
    except DataError as e:
        raise ClipError(f"the points are no face: {e.reason}") from None
    smooth, known = _resampled(points - neutral, seen, landmarks.fps)
    lower = columns(landmarks.ids, LOWER)
    return Measured(faps_of(smooth, landmarks.ids, fapu, MEASURED), smooth[:, lower, :2], known, fapu)


def neutral_face(points: Floats, ids: tuple[int, ...]) -> Floats:
    """The face at rest, shape (k, 3), of points (n, k, 3) in mm: the median of frames with closed lips."""
    upper, lower = columns(ids, (13, 14))
    apart = np.linalg.norm(points[:, upper] - points[:, lower], axis=-1)
    closed = apart <= np.percentile(apart, CLOSEST_PERCENT) + NEAR_CLOSED_MM
    return np.asarray(np.median(points[closed], axis=0))


def _metres(point: Floats) -> tuple[float, float, float]:
    x, y, z = point / 1000
    return float(x), float(y), float(z)


def feature_points(points: Floats, ids: tuple[int, ...], names: tuple[str, ...]) -> dict[str, Floats]:
    """Those of points (n, k, ...), by name, each (n, ...). Raises ClipError if points are missing."""
    members = {name: tuple(row.point for row in table() if row.fdp == name) for name in names}
    return {
        name: points[:, columns(ids, points_of_it)].mean(axis=1) for name, points_of_it in members.items()
    }


def _resampled(moved: Floats, seen: NDArray[np.bool_], fps: float) -> tuple[Floats, NDArray[np.bool_]]:
    """Tracks (n, k, 3) at RATE, smoothed, and where they are known."""
    frames = np.arange(len(moved))
    last = len(moved) - 1
    # rounding must not put the last instant beyond the last frame
    at = np.minimum(np.arange(int(last / fps * RATE + 1e-6) + 1) * fps / RATE, last)
    bridged = CubicSpline(frames[seen], moved[seen])(np.clip(frames, *frames[seen][[0, -1]]))
    smooth = savgol_filter(bridged, SMOOTH_FRAMES, SMOOTH_ORDER, axis=0)
    before = np.maximum(np.searchsorted(frames[seen], at, side="right") - 1, 0)
    after = np.minimum(np.searchsorted(frames[seen], at), seen.sum() - 1)
    gap = frames[seen][after] - frames[seen][before]
    inside = (at >= frames[seen][0]) & (at <= frames[seen][-1])
    return CubicSpline(frames, smooth)(at), inside & (gap <= LONGEST_GAP_S * fps + 1)


def faps_of(moved: Floats, ids: tuple[int, ...], fapu: Fapu, numbers: tuple[int, ...]) -> Floats:
    """FAPs (n, 68), those numbers of them, of displacements in mm, shape (n, k, 2) or (n, k, 3)."""
    values = np.zeros((len(moved), N_FAPS))
    wanted = [faps()[number - 1] for number in numbers]
    at = feature_points(moved, ids, tuple(dict.fromkeys(fap.fdp[0] for fap in wanted)))
    for fap in wanted:
        axis, sign = _DIRECTIONS[fap.positive]
        values[:, fap.fap - 1] = sign * at[fap.fdp[0]][:, axis] / (1000 * fapu.per_unit(fap.unit))
    return values
