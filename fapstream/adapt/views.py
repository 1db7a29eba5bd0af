"""Two photos as two views: the paper's cameras and its linear solution, and the cameras that are refined.

Frames. The paper's (Sarris, Grammalidis, Strintzis, section 2.1) has its origin in the front camera, x to
the subject's right, y up, z away from the face; the profile camera sits at (b, 0, b) and looks along -x, so
that a profile it takes has its nose to the image's right. MPEG-4's has x to the subject's left and z
forward: (-x, y, -z) and a shift, `to_mpeg4`. Both are right-handed. Pixels go right and down.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fapstream.adapt.points import Facing
from fapstream.adapt.rigid import Similarity
from fapstream.head.deform import about_axis

Floats = NDArray[np.float64]

TO_MPEG4 = np.diag([-1.0, 1.0, -1.0])
"""From the paper's frame to MPEG-4's; its own inverse."""

LOOKS: dict[str, Floats] = {
    "front": np.eye(3),
    "right": np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]),
    "left": np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]),
}
"""From MPEG-4's axes to those of a camera in front of the head, or beside a head whose nose points to the
image's right or left: x right, y up, z towards the camera."""


def to_mpeg4(points: Floats) -> Floats:
    """Points (n, 3) of the paper's frame along MPEG-4's axes."""
    turned: Floats = points @ TO_MPEG4
    return turned


@dataclass(frozen=True, slots=True)
class PaperCameras:
    """The paper's two cameras: focal length in pixels, principal points, and the baseline b, which sets the
    scale.
    """

    focal: float
    front: tuple[float, float]
    profile: tuple[float, float]
    baseline: float
    facing: Facing = "right"

    def project(self, points: Floats) -> tuple[Floats, Floats]:
        """Equation 1: pixels (n, 2) in the front and in the profile of points (n, 3) in the paper's frame."""
        x, y, z = points.T
        side = 1.0 if self.facing == "right" else -1.0
        depth = self.baseline - side * x
        f, b = self.focal, self.baseline
        front = np.stack([-f * x / z + self.front[0], -f * y / z + self.front[1]], 1)
        profile = np.stack(
            [side * f * (b - z) / depth + self.profile[0], -f * y / depth + self.profile[1]], 1
        )
        return front, profile

    def locate(self, front: Floats, profile: Floats) -> Floats:
        """Equations A.1 to A.4: points (n, 3) in the paper's frame from pixels (n, 2) in both views, each
        by least squares over four equations in three unknowns.
        """
        side = 1.0 if self.facing == "right" else -1.0
        (xf, yf), (xp, yp) = (front - self.front).T, (profile - self.profile).T
        f, b = np.full(len(front), self.focal), self.baseline
        o = np.zeros(len(front))
        rows = np.stack(
            [
                np.stack([f, o, xf], 1),
                np.stack([o, f, yf], 1),
                np.stack([-side * xp, o, side * f], 1),
                np.stack([-side * yp, f, o], 1),
            ],
            1,
        )
        right = np.stack([o, o, side * f * b - xp * b, -yp * b], 1)
        normal = np.einsum("nki,nkj->nij", rows, rows)
        found: Floats = np.linalg.solve(normal, np.einsum("nki,nk->ni", rows, right)[..., None])[..., 0]
        return found


@dataclass(frozen=True, slots=True)
class Camera:
    """A camera that sees the head from one of `LOOKS`, nearly.

    With p = look @ turn @ (x - pivot) + (shift, 0): u = cx + scale px / (1 - closeness pz),
    v = cy - scale py / (1 - closeness pz). `scale` is focal length over distance (pixels a metre at the
    pivot), `closeness` 1 / distance (1/metre, 0 is parallel projection): what photos tell well and what
    they hardly tell. `turn`: rotation vector (3,), radians; `centre` (cx, cy) the principal point.
    """

    look: str
    centre: tuple[float, float]
    pivot: Floats
    scale: float
    closeness: float
    turn: Floats
    shift: Floats

    @property
    def axes(self) -> Floats:
        """(3, 3), MPEG-4's axes to the camera's."""
        matrix: Floats = LOOKS[self.look] @ rotation(self.turn)
        return matrix

    @property
    def position(self) -> Floats:
        """Of the camera, metres; far away for a parallel projection."""
        place = np.array([-self.shift[0], -self.shift[1], 1 / max(self.closeness, 1e-3)])
        found: Floats = self.pivot + self.axes.T @ place
        return found

    def inside(self, points: Floats) -> Floats:
        """(n, 3): along the camera's axes, from the pivot; z towards the camera."""
        moved = (points - self.pivot) @ self.axes.T
        moved[:, :2] += self.shift
        return moved

    def project(self, points: Floats) -> Floats:
        """Pixels (n, 2) of points (n, 3)."""
        x, y, z = self.inside(points).T
        near = self.scale / np.maximum(1 - self.closeness * z, 1e-3)
        return np.stack([self.centre[0] + near * x, self.centre[1] - near * y], 1)

    def moved(self, change: Floats) -> Camera:
        """With the seven parameters changed: log scale, log closeness, turn, shift. The turn is about the
        pivot, after the turn there is."""
        return replace(
            self,
            scale=float(self.scale * np.exp(np.clip(change[0], -1, 1))),
            closeness=float(self.closeness * np.exp(np.clip(change[1], -1, 1))),
            turn=rotation_vector(rotation(change[2:5]) @ rotation(self.turn)),
            shift=self.shift + change[5:7],
        )

    def derivatives(self, points: Floats) -> tuple[Floats, Floats]:
        """Of the pixels: (n, 2, 3) by the point, (n, 2, 7) by `moved`'s parameters at no change."""
        p = self.inside(points)
        near = 1 / np.maximum(1 - self.closeness * p[:, 2], 1e-3)
        flip = np.array([1.0, -1.0])
        by_inside = np.zeros((len(points), 2, 3))
        by_inside[:, 0, 0], by_inside[:, 1, 1] = self.scale * near, -self.scale * near
        by_inside[:, :, 2] = flip * p[:, :2] * (self.scale * self.closeness * near**2)[:, None]
        by_point = by_inside @ self.axes
        offset = flip * p[:, :2] * (self.scale * near)[:, None]
        by_closeness = offset * (self.closeness * p[:, 2] * near)[:, None]
        turned = (points - self.pivot) @ rotation(self.turn).T
        by_turn = by_inside @ LOOKS[self.look] @ -cross_matrices(turned)
        by_change = np.concatenate(
            [offset[..., None], by_closeness[..., None], by_turn, by_inside[:, :, :2]], 2
        )
        return by_point, by_change


def camera_of(paper: PaperCameras, view: str, pose: Similarity, pivot: Floats) -> Camera:
    """One of the paper's cameras as it sees a head that `pose` takes from MPEG-4's frame to the paper's."""
    b = paper.baseline
    middle = pose(pivot[None])[0]
    home = np.zeros(3) if view == "front" else np.array([b if paper.facing == "right" else -b, 0.0, b])
    look = "front" if view == "front" else paper.facing
    place = LOOKS[look] @ TO_MPEG4 @ (middle - home) / pose.scale
    distance = -place[2]
    centre = paper.front if view == "front" else paper.profile
    turn = rotation_vector(TO_MPEG4 @ pose.rotation)
    return Camera(look, centre, pivot, paper.focal / distance, 1 / distance, turn, place[:2])


def rotation(vector: Floats) -> Floats:
    """The matrix (3, 3) of a rotation vector (3,), radians."""
    angle = float(np.linalg.norm(vector))
    if angle < 1e-8:
        return np.asarray(np.eye(3) + cross_matrices(vector[None])[0], np.float64)
    return about_axis(vector, angle)


def rotation_vector(matrix: Floats) -> Floats:
    """The rotation vector (3,) of a matrix (3, 3)."""
    twist = (
        np.array([matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]]) / 2
    )
    sine, cosine = float(np.linalg.norm(twist)), float((np.trace(matrix) - 1) / 2)
    if sine < 1e-8 and cosine > 0:
        return twist
    angle = np.arctan2(sine, cosine)
    if sine > 1e-6:
        found: Floats = twist * (angle / sine)
        return found
    values, vectors = np.linalg.eigh((matrix + matrix.T) / 2)  # half a turn
    return np.asarray(vectors[:, np.argmax(values)] * angle, float)


def cross_matrices(vectors: Floats) -> Floats:
    """(n, 3, 3): v x w = matrix @ w for vectors (n, 3)."""
    x, y, z = vectors.T
    o = np.zeros(len(vectors))
    return np.stack([np.stack([o, -z, y], 1), np.stack([z, o, -x], 1), np.stack([-y, x, o], 1)], 1)
