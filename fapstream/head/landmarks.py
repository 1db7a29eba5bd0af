"""Where the eyes, the mouth and the chin of an unknown head are, told by what its shapes move."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fapstream.head.fapu import Fapu, Point
from fapstream.head.nodes import Array
from fapstream.head.rig import EYES, kind_of
from fapstream.head.scene import Surface

LIPS = ("mouthPucker", "mouthFunnel", "viseme_U", "viseme_O", "mouthClose")
JAW = ("jawOpen", "mouthOpen", "viseme_aa", "viseme_O", "viseme_E")
BLINKS = {"l": "eyeBlinkLeft", "r": "eyeBlinkRight"}
NOSE_SHARE = 0.7
"""Of the way from the eyes to the mouth, the bottom of the nose: ENS0 / (ENS0 + MNS0) of an average adult."""
BEHIND_LIDS = 0.2
"""How far the eye's centre lies behind its lids, in eye distances."""
PIVOT = (0.67, 1.28)
"""How far the top of the spine lies below and behind the eyes' centres, in eye distances (average adult)."""
LID_SHARE = 0.147
"""IRISD0 / ES0 of the average adult."""


@dataclass(frozen=True, slots=True)
class Landmarks:
    """In the coordinates of the surfaces they were found on. `eyes` are centres of rotation, left first."""

    eyes: tuple[Array, Array]
    mouth: Array
    mouth_size: tuple[float, float]
    chin: float
    top: float
    pivot: Array

    @property
    def eye_distance(self) -> float:
        return float(np.linalg.norm(self.eyes[0] - self.eyes[1]))

    def fapu(self) -> Fapu:
        """Estimated, in the unit of the coordinates."""
        es0 = self.eye_distance
        face = max(float((self.eyes[0][1] + self.eyes[1][1]) / 2 - self.mouth[1]), 0.3 * es0)
        return Fapu(LID_SHARE * es0, es0, NOSE_SHARE * face, (1 - NOSE_SHARE) * face, self.mouth_size[0])

    def fdp(self) -> dict[str, Point]:
        """The feature points that are known."""
        half = np.array([self.mouth_size[0] / 2, 0, 0])
        points = {"3.5": self.eyes[0], "3.6": self.eyes[1], "7.1": self.pivot}
        points |= {"8.3": self.mouth + half, "8.4": self.mouth - half}
        return {name: (float(x), float(y), float(z)) for name, (x, y, z) in points.items()}


def find(surfaces: Sequence[Surface], bones: Mapping[str, Array]) -> Landmarks:
    """`bones`: positions (3,) of `head`, `leftEye` and `rightEye`, as far as known."""
    lips = moving(surfaces, LIPS, 0.6)
    jaw = moving(surfaces, JAW, 0.7)
    lips = lips if len(lips) else jaw
    low, high = (np.percentile(lips, share, axis=0) for share in (1, 99))
    width = max(float(high[0] - low[0]), 1e-6)
    mouth = np.array([(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, high[2]])
    eyes = _eyes(surfaces, bones, mouth)
    if eyes is None:
        eyes = (
            mouth + (0.6 * width, 1.35 * width, -0.5 * width),
            mouth + (-0.6 * width, 1.35 * width, -0.5 * width),
        )
    centre, apart = (eyes[0] + eyes[1]) / 2, float(np.linalg.norm(eyes[0] - eyes[1]))
    pivot = bones.get("head", centre - (0, PIVOT[0] * apart, PIVOT[1] * apart))
    chin = float(jaw[:, 1].min()) if len(jaw) else float(mouth[1] - 0.6 * (centre[1] - mouth[1]))
    top = max(float(surface.positions[:, 1].max()) for surface in surfaces)
    top = float(np.clip(top, centre[1] + apart, centre[1] + 4 * apart))
    return Landmarks(eyes, mouth, (width, max(float(high[1] - low[1]), 0.2 * width)), chin, top, pivot)


def moving(surfaces: Iterable[Surface], shapes: Iterable[str], share: float) -> Array:
    """Positions (k, 3) of the vertices that a shape moves by more than `share` of the most.

    The shape is the first of `shapes` that the head has.
    """
    for shape in shapes:
        rows = [
            (surface.positions, _length(surface.moves[shape]))
            for surface in surfaces
            if shape in surface.moves
        ]
        most = max((float(length.max()) for _, length in rows), default=0.0)
        if most > 0:
            return np.concatenate([points[length > share * most] for points, length in rows])
    return np.zeros((0, 3))


def _eyes(
    surfaces: Sequence[Surface], bones: Mapping[str, Array], mouth: Array
) -> tuple[Array, Array] | None:
    """By bones, by meshes that are eyes, or by the lids; an eye that is not found mirrors the other."""
    found: dict[str, Array] = {}
    balls = [surface.positions for surface in surfaces if kind_of(surface.names) == "eye"]
    ball = np.concatenate(balls) if balls else np.zeros((0, 3))
    for side, sign in (("l", 1), ("r", -1)):
        half = ball[(ball[:, 0] - mouth[0]) * sign > 0]
        lids = moving(surfaces, (BLINKS[side], "blink"), 0.5)
        lids = lids[(lids[:, 0] - mouth[0]) * sign > 0]
        if EYES[side] in bones:
            found[side] = bones[EYES[side]]
        elif len(half):
            found[side] = (half.min(0) + half.max(0)) / 2
        elif len(lids):
            found[side] = (lids.min(0) + lids.max(0)) / 2
            found[side] = found[side] - (0, 0, BEHIND_LIDS * 2 * abs(found[side][0] - mouth[0]))
    if not found:
        return None
    mirrored = {side: (eye - mouth) * (-1, 1, 1) + mouth for side, eye in found.items()}
    eyes = found.get("l", mirrored.get("r")), found.get("r", mirrored.get("l"))
    if eyes[0] is None or eyes[1] is None or not eyes[0][0] - eyes[1][0] > 1e-6:
        return None
    return eyes[0], eyes[1]


def _length(moves: NDArray[np.float32]) -> Array:
    length: Array = np.linalg.norm(moves.astype(np.float64), axis=1)
    return length
