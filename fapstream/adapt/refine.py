"""From pixels in one or two photos to feature points in space: the paper's solution, then refined with its
cameras.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from fapstream.adapt.covariance import Covariance, precision
from fapstream.adapt.points import Marks, PhotoPoints
from fapstream.adapt.start import USUAL_M, seen_side, start
from fapstream.adapt.views import Camera
from fapstream.errors import PointsError

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

FEWEST = 8
"""Points of the front photo; fewer say too little about a face."""
FLATTEST = 0.02
"""Points whose second spread is less than this share of the first lie on a line."""
STRANGEST_M, STRANGEST_SHARE = 0.011, 0.12
"""Faces differ by 2 to 6 mm rms from the generic one. Points that differ more than the first, or of which a
third is further off in a photo than the second, of the distance between the eyes, are no face, or not as it
was said.
"""
EYES = 0.063
"""Metres between the eyes of the generic head, nearly."""


@dataclass(frozen=True, slots=True)
class Belief:
    """What is believed before: how good points are found, how far cameras stand, how straight they look.

    `pixels`: sd of a sure point, as a share of the distance between the eyes; `tail`: beyond so many sd a
    point is rather wrong than imprecise (Cauchy). `distance`: metres, with `distance_sd` of its logarithm;
    `tilt`: sd of the camera's turn, radians.
    """

    pixels: float = 0.004
    tail: float = 3.0
    distance: float = USUAL_M
    distance_sd: float = 0.5
    tilt: float = 0.06
    faces: Covariance = field(default_factory=Covariance)


@dataclass(frozen=True, slots=True)
class Sight:
    """One photo: its camera, the points (n, 2) in it, NaN where it has none, and their sd `noise` (n,),
    pixels.
    """

    camera: Camera
    seen: Floats
    noise: Floats

    @property
    def known(self) -> Mask:
        """bool (n,)."""
        mask: Mask = np.isfinite(self.seen[:, 0])
        return mask


@dataclass(frozen=True, slots=True)
class Located:
    """Feature points in space: `points` (n, 3) in the generic head's frame, metres, by `names`, and the
    cameras.

    `errors`: by view, pixels (n, 2) from where a point was found to where the camera sees it; NaN where it
    was not.
    """

    names: tuple[str, ...]
    points: Floats
    sights: Mapping[str, Sight]
    errors: Mapping[str, Floats]

    def mean_error(self, view: str) -> float:
        """Pixels, over the points of that photo."""
        return float(np.nanmean(np.linalg.norm(self.errors[view], axis=1)))

    def eye_distance(self, view: str) -> float:
        """In pixels, at the scale of that photo."""
        return EYES * self.sights[view].camera.scale


def locate(photos: PhotoPoints, places: Mapping[str, Floats], belief: Belief | None = None) -> Located:
    """Feature points in space from points in photos; `places` are the generic head's, by name.

    Points in both photos begin at the paper's solution, the others at their places on the generic head;
    then all of them and the cameras are refined together: the most probable given `belief`, robustly. The
    scale of the result is the generic head's, for photos do not tell how large a head is.

    Raises PointsError for points that are too few, on a line, or no face.
    """
    belief = belief or Belief()
    names = tuple(places)
    generic = np.array([places[name] for name in names])
    _check(photos.front, "front")
    marks = seen_side(photos)
    if "profile" in marks:
        if marks["profile"].points:
            _check(marks["profile"], "profile")
        else:
            del marks["profile"]
    begun = start(marks, photos.facing, names, generic)
    sights = {
        view: Sight(camera, marks[view].array(names), _noise(marks[view].sureness(names), camera, belief))
        for view, camera in begun.cameras.items()
    }
    points, sights = _refined(begun.points, generic, sights, belief)
    errors = {view: sight.camera.project(points) - sight.seen for view, sight in sights.items()}
    found = Located(names, points, sights, errors)
    _check_face(found, generic)
    return found


def _check(marks: Marks, view: str) -> None:
    known = np.array(list(marks.points.values()), float).reshape(-1, 2)
    if len(known) < FEWEST:
        raise PointsError(
            f"{view}: {len(known)} points are too few to fit a head; {FEWEST} or more are needed"
        )
    spread = np.linalg.svd(known - known.mean(0), compute_uv=False)
    if not spread[1] > FLATTEST * spread[0]:
        raise PointsError(f"{view}: the points lie on one line")


def _check_face(found: Located, generic: Floats) -> None:
    """A face does not differ from the generic one by centimetres, nor from what its own photos show."""
    unlike = float(np.sqrt(((found.points - generic) ** 2).sum(1).mean()))
    off = {view: _typical(errors) for view, errors in found.errors.items()}
    worst = max(off, key=lambda view: off[view] / found.eye_distance(view))
    if not (unlike < STRANGEST_M and off[worst] < STRANGEST_SHARE * found.eye_distance(worst)):
        raise PointsError(
            f"the points do not make a face (it would be {1000 * unlike:.0f} mm from an average one, and "
            f"{off[worst]:.0f} pixels off in the {worst} photo): are left and right, or photos, exchanged?"
        )


def _typical(errors: Floats) -> float:
    """Pixels that two thirds of the points are not off by."""
    return float(np.nanpercentile(np.linalg.norm(errors, axis=1), 67))


ROUNDS = 25
ENOUGH = 1e-5
"""Relative change of the cost at which refining ends."""


def _noise(sureness: Floats, camera: Camera, belief: Belief) -> Floats:
    """sd of points (n,), pixels, from how sure they are (n,)."""
    noise: Floats = belief.pixels * EYES * camera.scale / np.clip(sureness, 0.05, 1)
    return noise


def _refined(
    points: Floats, generic: Floats, sights: Mapping[str, Sight], belief: Belief
) -> tuple[Floats, dict[str, Sight]]:
    """The most probable points and cameras: Levenberg and Marquardt on all, reweighted (Cauchy) at each
    step.
    """
    n, prior = len(generic), precision(belief.faces, generic)
    current = dict(sights)
    cost = _cost(points, current, generic, prior, belief)
    damping = 1e-3
    for _ in range(ROUNDS):
        matrix, slope = _equations(points, current, generic, prior, belief)
        while damping < 1e6:
            damped = matrix + damping * np.diag(np.diag(matrix))
            step = cho_solve(cho_factor(damped, check_finite=False), -slope, check_finite=False)
            tried = {
                view: Sight(
                    sight.camera.moved(step[3 * n + 7 * k : 3 * n + 7 * k + 7]), sight.seen, sight.noise
                )
                for k, (view, sight) in enumerate(current.items())
            }
            moved = points + step[: 3 * n].reshape(-1, 3)
            new = _cost(moved, tried, generic, prior, belief)
            if new < cost:
                break
            damping *= 8
        else:
            break
        points, current, gain, cost = moved, tried, cost - new, new
        damping = max(damping / 6, 1e-7)
        if gain < ENOUGH * cost:
            break
    return points, current


def _tilted(camera: Camera, belief: Belief) -> Floats:
    """What the camera's own parameters are off, in sd: (4,): log distance and turn."""
    off: Floats = np.r_[
        np.log(camera.closeness * belief.distance) / belief.distance_sd, camera.turn / belief.tilt
    ]
    return off


def _cost(
    points: Floats, sights: Mapping[str, Sight], generic: Floats, prior: Floats, belief: Belief
) -> float:
    off = (points - generic).ravel()
    total = float(off @ prior @ off)
    for sight in sights.values():
        known, tail = sight.known, belief.tail**2
        error = (sight.camera.project(points[known]) - sight.seen[known]) / sight.noise[known, None]
        total += float((tail * np.log1p((error**2).sum(1) / tail)).sum())
        total += float((_tilted(sight.camera, belief) ** 2).sum())
    return total


def _equations(
    points: Floats, sights: Mapping[str, Sight], generic: Floats, prior: Floats, belief: Belief
) -> tuple[Floats, Floats]:
    """The normal equations' matrix and right side: points first, then seven parameters a camera."""
    n = len(points)
    size = 3 * n + 7 * len(sights)
    matrix, slope = np.zeros((size, size)), np.zeros(size)
    matrix[: 3 * n, : 3 * n] = prior
    slope[: 3 * n] = prior @ (points - generic).ravel()
    for k, sight in enumerate(sights.values()):
        at = slice(3 * n + 7 * k, 3 * n + 7 * k + 7)
        known = np.flatnonzero(sight.known)
        noise = sight.noise[known]
        by_point, by_camera = sight.camera.derivatives(points[known])
        error = (sight.camera.project(points[known]) - sight.seen[known]) / noise[:, None]
        weight = 1 / (1 + (error**2).sum(1) / belief.tail**2)
        by_point, by_camera = by_point / noise[:, None, None], by_camera / noise[:, None, None]
        own = np.einsum("kri,krj,k->kij", by_point, by_point, weight)
        cross = np.einsum("kri,krj,k->kij", by_point, by_camera, weight)
        for i, point in enumerate(known):
            rows = slice(3 * point, 3 * point + 3)
            matrix[rows, rows] += own[i]
            matrix[rows, at] += cross[i]
            matrix[at, rows] += cross[i].T
            slope[rows] += weight[i] * error[i] @ by_point[i]
        matrix[at, at] += np.einsum("kri,krj,k->ij", by_camera, by_camera, weight)
        slope[at] += np.einsum("kri,kr,k->i", by_camera, error, weight)
        bent = _tilted(sight.camera, belief) / np.r_[belief.distance_sd, np.full(3, belief.tilt)]
        matrix[at, at][[1, 2, 3, 4], [1, 2, 3, 4]] += (
            np.r_[belief.distance_sd, np.full(3, belief.tilt)] ** -2.0
        )
        slope[at][1:5] += bent
    return matrix, slope
