"""Eyes stay balls: what a warp becomes near them, so that lids still slide over them and close."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fapstream.adapt.rigid import Similarity
from fapstream.adapt.warp import Warp
from fapstream.head.mesh import Head

Floats = NDArray[np.float64]

LIDS = 1.25
"""Skin nearer to an eye's centre than so many radii are its lids."""
KEPT, LEFT = 1.15, 1.6
"""In radii: up to the first the distance from the ball is kept, beyond the second the warp is left alone."""
YAW = {"l": 23, "r": 24}
"""The FAP that turns each eye, and so tells where its centre is."""
PUPILS = {"l": "3.5", "r": "3.6"}


@dataclass(frozen=True, slots=True)
class Ball:
    """An eyeball on the generic head (`centre` (3,), `radius`, metres) and the similarity that takes it to
    the person.
    """

    centre: Floats
    radius: float
    moved: Similarity

    def kept(self, points: Floats, warped: Floats) -> Floats:
        """`warped` (n, 3), with the points that were near the ball as far from it, in radii, as they were."""
        arm = points - self.centre
        far = np.linalg.norm(arm, axis=1)
        rise = np.clip((LEFT - far / self.radius) / (LEFT - KEPT), 0, 1)
        near = np.flatnonzero(rise > 0)
        if not near.size:
            return warped
        share = (rise * rise * (3 - 2 * rise))[near, None]
        middle = self.moved(self.centre[None])
        away = warped[near] - middle
        away /= np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-9)
        kept = middle + away * (self.moved.scale * far[near])[:, None]
        result = warped.copy()
        result[near] += share * (kept - warped[near])
        return result


@dataclass(frozen=True, slots=True)
class EyeWarp:
    """A warp that keeps the surroundings of eyeballs round."""

    warp: Warp
    balls: tuple[Ball, ...]

    def __call__(self, points: Floats) -> Floats:
        moved = self.warp(points)
        for ball in self.balls:
            moved = ball.kept(points, moved)
        return moved


def keeping_eyes(warp: Warp, head: Head) -> tuple[EyeWarp, dict[str, Ball]]:
    """The warp with round eyes, and the eyeballs of `head` by side, as far as it has any."""
    balls = {}
    for side in YAW:
        pivots = [turn.pivot for turn in head.turns if YAW[side] in turn.faps]
        if pivots and any(part.name == f"eye_{side}" for part in head.parts):
            balls[side] = _ball(warp, head, side, np.array(pivots[0]))
    return EyeWarp(warp, tuple(balls.values())), balls


def _ball(warp: Warp, head: Head, side: str, centre: Floats) -> Ball:
    """Sized and set as deep as the lids are; up and down, left and right, where the pupil is."""
    points = head.part(f"eye_{side}").positions.astype(np.float64)
    radius = float(np.median(np.linalg.norm(points - centre, axis=1)))
    skin = head.part("skin").positions.astype(np.float64)
    lids = skin[np.linalg.norm(skin - centre, axis=1) < LIDS * radius]
    if len(lids) < 3:
        lids = points
    warped = warp(lids)
    spread = ((lids - lids.mean(0)) ** 2).sum()
    scale = float(np.sqrt(((warped - warped.mean(0)) ** 2).sum() / spread))
    place = warped.mean(0) - scale * (lids.mean(0) - centre)
    pupil = np.array(head.fdp.get(PUPILS[side], centre + (0, 0, radius)))
    place[:2] = warp(pupil[None])[0, :2] - scale * (pupil - centre)[:2]
    return Ball(centre, radius, Similarity(scale, np.eye(3), place - scale * centre))
