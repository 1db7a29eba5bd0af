"""From pixels in one or two photos to feature points in space: the paper's solution, then refined with its
cameras.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from fapstream.adapt.covariance import Covariance, precision
from fapstream.adapt.points import Facing, Marks, PhotoPoints, feature_points, near_side
from fapstream.adapt.rigid import Similarity
from fapstream.adapt.views import Camera, PaperCameras, camera_of
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
PORTRAIT_M = 0.36
"""What a portrait shows of the world, metres."""
MOST_TURNED = 0.6
"""Radians that a head may be turned from where the camera expects it."""
EYES = 0.063
"""Metres between the eyes of the generic head, nearly."""
FOCAL_SHARE = 1.6
"""Focal length over the longer side of the photo, before anything is known: a portrait, cut a little."""


@dataclass(frozen=True, slots=True)
class Belief:
    """What is believed before: how good points are found, how far cameras stand, how straight they look.

    `pixels`: sd of a sure point, as a share of the distance between the eyes; `tail`: beyond so many sd a
    point is rather wrong than imprecise (Cauchy). `distance`: metres, with `distance_sd` of its logarithm;
    `tilt`: sd of the camera's turn, radians.
    """

    pixels: float = 0.004
    tail: float = 3.0
    distance: float = 1.1
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
    sights = first_sights(photos, names, generic, belief)
    points, sights = _refined(generic, sights, belief)
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


def first_sights(
    photos: PhotoPoints, names: tuple[str, ...], generic: Floats, belief: Belief
) -> dict[str, Sight]:
    """Cameras to begin with: the paper's, where enough points are in both photos; else each by itself."""
    marks = {"front": photos.front}
    looks = {"front": "front"}
    if photos.profile is not None and photos.profile.points:
        _check(photos.profile, "profile")
        marks["profile"] = _of_near_side(photos.profile, near_side(photos.facing))
        looks["profile"] = photos.facing
    cameras = _paper_cameras(marks, photos.facing, names, generic) if len(marks) == 2 else None
    if cameras is None:
        near = 1 / belief.distance
        cameras = {view: _alone(row, looks[view], near, names, generic) for view, row in marks.items()}
    return {
        view: Sight(camera, marks[view].array(names), _noise(marks[view].sureness(names), camera, belief))
        for view, camera in cameras.items()
    }


def laid_over(photos: PhotoPoints, names: tuple[str, ...], generic: Floats) -> dict[str, Camera]:
    """Cameras that see the generic head's points (n, 3) where the few points of each photo are, or in the
    middle of a photo that has none.
    """
    marks = {"front": photos.front}
    if photos.profile is not None:
        marks["profile"] = _of_near_side(photos.profile, near_side(photos.facing))
    looks = {"front": "front", "profile": photos.facing}
    return {
        view: _alone(row, looks[view], 1 / Belief().distance, names, generic) for view, row in marks.items()
    }


def _noise(sureness: Floats, camera: Camera, belief: Belief) -> Floats:
    """sd of points (n,), pixels, from how sure they are (n,)."""
    noise: Floats = belief.pixels * EYES * camera.scale / np.clip(sureness, 0.05, 1)
    return noise


def _of_near_side(marks: Marks, side: int) -> Marks:
    """The marks with points of the hidden side taken for those of the side that is seen."""
    points, confidence = {}, {}
    for name, at in marks.points.items():
        mirror = feature_points()[name].mirror
        own = name if mirror is None or _side(name) == side else mirror
        points[own] = at
        confidence[own] = marks.confidence.get(name, 1.0)
    return Marks(marks.size, points, confidence)


def _side(name: str) -> int:
    """The sign of x: 1 on the left. The table has the left point of each pair first."""
    order = list(feature_points())
    mirror = feature_points()[name].mirror
    return 1 if mirror is not None and order.index(name) < order.index(mirror) else -1


def _paper_cameras(
    marks: Mapping[str, Marks], facing: Facing, names: tuple[str, ...], generic: Floats
) -> dict[str, Camera] | None:
    """Sections 2.1 and 2.2: located points, and the head's pose among them. None where too few are in both
    photos.

    The profile photo is first brought to the front's scale and height, for the paper has one camera for both.
    """
    front, profile = (marks[view].array(names) for view in ("front", "profile"))
    both = np.isfinite(front[:, 0]) & np.isfinite(profile[:, 0])
    if both.sum() < 4 or np.ptp(profile[both, 1]) <= 0:
        return None
    size, drop = np.polyfit(profile[both, 1], front[both, 1], 1)
    if not size > 0:
        return None
    centre = (marks["front"].size[0] / 2, marks["front"].size[1] / 2)
    aside = (profile[both, 0].min() + profile[both, 0].max()) / 2
    scaled = np.stack([(profile[:, 0] - aside) * size + centre[0], profile[:, 1] * size + drop], 1)
    paper = PaperCameras(FOCAL_SHARE * max(marks["front"].size), centre, centre, 1.0, facing)
    found = paper.locate(front[both], scaled[both])
    if not np.isfinite(found).all():
        return None
    pose = Similarity.fit(generic[both], found)
    cameras = {view: camera_of(paper, view, pose, generic.mean(0)) for view in ("front", "profile")}
    if any(np.linalg.norm(c.turn) > MOST_TURNED or c.closeness <= 0 for c in cameras.values()):
        return None
    cameras["profile"] = _in_own_photo(
        cameras["profile"], marks["profile"].size, size, generic[both], profile[both]
    )
    return cameras


def _in_own_photo(
    camera: Camera, photo: tuple[int, int], size: float, points: Floats, seen: Floats
) -> Camera:
    """The camera of a photo that was drawn `size` times larger: it sees `points` where they are, on the
    whole.
    """
    own = replace(camera, centre=(photo[0] / 2, photo[1] / 2), scale=camera.scale / size)
    off = np.median(seen - own.project(points), axis=0) * (1, -1)
    return replace(own, shift=own.shift + off / own.scale)


def _alone(marks: Marks, look: str, closeness: float, names: tuple[str, ...], generic: Floats) -> Camera:
    """A camera that looks straight, placed and scaled so that the generic head's points fall on those of the
    photo; in its middle if it has none, as large as portraits are if it has not two.
    """
    seen = marks.array(names)
    known = np.isfinite(seen[:, 0])
    centre = (marks.size[0] / 2, marks.size[1] / 2)
    straight = Camera(look, centre, generic.mean(0), 1.0, closeness, np.zeros(3), np.zeros(2))
    flat, wanted = straight.project(generic[known]) - centre, seen[known] - centre
    if not known.any():
        return replace(straight, scale=min(marks.size) / PORTRAIT_M)
    a, b = flat - flat.mean(0), wanted - wanted.mean(0)
    scale = float(np.sqrt((b**2).sum() / max(float((a**2).sum()), 1e-12)))
    if not scale > 0:
        scale = min(marks.size) / PORTRAIT_M
    near = (1 / (1 - closeness * straight.inside(generic[known])[:, 2])).mean()
    return replace(straight, scale=scale, shift=(wanted.mean(0) / scale - flat.mean(0)) / near * (1, -1))


ROUNDS = 25
ENOUGH = 1e-5
"""Relative change of the cost at which refining ends."""


def _refined(generic: Floats, sights: Mapping[str, Sight], belief: Belief) -> tuple[Floats, dict[str, Sight]]:
    """The most probable points and cameras: Levenberg and Marquardt on all, reweighted (Cauchy) at each
    step.
    """
    n, prior = len(generic), precision(belief.faces, generic)
    points, current = generic.copy(), dict(sights)
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
