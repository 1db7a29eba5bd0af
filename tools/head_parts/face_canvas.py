"""What every texel of the skin's picture shows: its place on the face, masks, and openness to light."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from head_parts.assemble import Piece
from head_parts.bust import Bust
from head_parts.hair import Scalp
from head_parts.paint import SKIN_SIZE, atlas_uvs, sample, smooth
from head_parts.shade import openness
from head_parts.source import Source
from head_parts.surface import Array, rasterise


@dataclass(frozen=True)
class Canvas:
    """Each texel's place (s, s, 3) in decimetres, lips and ears 0..1, and openness to light 0..1."""

    at: Array
    lips: Array
    ears: Array
    open: Array
    seam: Array
    """1 where the lips meet."""
    scalp: Scalp
    mouth: Array
    """Middle of the line of the lips."""

    @property
    def bust(self) -> Bust:
        return self.scalp.bust

    @property
    def eye(self) -> Array:
        """Centre of the left eye."""
        return self.bust.eyes["l"].centre

    @property
    def front(self) -> Array:
        """1 on the face, 0 behind the ears."""
        return smooth(0.5, 1.1, self.at[..., 2])

    def spot(self, side: float, up: float, wide: float, high: float) -> Array:
        """A soft spot on both halves of the face about (side, up) in decimetres."""
        x, y = np.abs(self.at[..., 0]), self.at[..., 1]
        return np.asarray(np.exp(-(((x - side) / wide) ** 2) - ((y - up) / high) ** 2) * self.front)


def canvas_of(source: Source, scalp: Scalp, skin: Piece, others: list[Piece]) -> Canvas:
    """`others` take light away from the skin."""
    bust = scalp.bust
    atlas = bust.step.matrix @ atlas_uvs(source, bust)
    solid = [(p.points, p.triangles) for p in (skin, *others) if p.material.alpha != "BLEND"]
    light = openness(skin.points, skin.normals, solid)
    rows = np.column_stack([skin.points, atlas[skin.sources], scalp.ears[skin.sources], light])
    # where the wrap overlaps itself, about the shoulders, what is higher is what shows
    upward = skin.triangles[np.argsort(skin.points[skin.triangles][..., 1].mean(1))]
    picture, covered = rasterise(skin.uvs, upward, rows, SKIN_SIZE)
    nearest = ndimage.distance_transform_edt(~covered, return_distances=False, return_indices=True)
    picture = picture[tuple(nearest)]
    lips = ndimage.gaussian_filter(sample(source.mask("lips"), picture[..., 3:5]), 2.0)
    shade = ndimage.gaussian_filter(picture[..., 6], 1.0)
    lips = np.maximum(lips, _lip_line(bust, picture[..., :3], 0.035))
    seam = _lip_line(bust, picture[..., :3], 0.011)
    neck = smooth(6.35, 6.1, picture[..., 1])
    shade = np.maximum.reduce(
        [shade, 0.62 * lips, 0.80 * neck, 0.55 * picture[..., 5], 0.55 * _eye_rims(bust, picture)]
    )
    mouth = bust.skin.points[bust.skin.inner.point(0.0, True)]
    return Canvas(picture[..., :3], lips, picture[..., 5], shade, seam, scalp, mouth)


def _lip_line(bust: Bust, at: Array, wide: float) -> Array:
    """1 where the lips meet, so that no skin shows on their inside."""
    contour = bust.skin.points[bust.skin.inner.vertices][bust.skin.inner.upper]
    order = np.argsort(contour[:, 0])
    height = np.interp(at[..., 0], contour[order, 0], contour[order, 1])
    half = np.abs(contour[:, 0]).max()
    inside = smooth(half + 0.005, half - 0.01, np.abs(at[..., 0])) * (at[..., 2] > 1.2)
    wide = wide * (0.3 + 0.7 * np.sqrt(np.clip(1 - (at[..., 0] / half) ** 2, 0, 1)))
    return np.asarray(smooth(wide, 0.4 * wide, np.abs(at[..., 1] - height)) * inside)


def _eye_rims(bust: Bust, picture: Array) -> Array:
    """1 on the edges of the lids, which would otherwise bake the ball's shadow in."""
    at = np.concatenate([np.abs(picture[..., :1]), picture[..., 1:3]], -1)
    gap = np.linalg.norm((at - bust.eyes["l"].centre) * (1.0, 1.6, 0.3), axis=-1)
    return np.asarray(smooth(0.24, 0.16, gap))


def noise(points: Array, waves: float, seed: int) -> Array:
    """Smooth noise in space, about unit size, with two octaves."""
    grid = np.random.default_rng(seed).normal(size=(32, 32, 32))
    total = np.zeros(points.shape[:-1])
    for octave, size in ((1.0, 1.0), (2.1, 0.5)):
        at = np.moveaxis(points * waves * octave, -1, 0)
        total += size * ndimage.map_coordinates(grid, at, order=1, mode="grid-wrap")
    return total


def grain(size: int, fine: float, coarse: float, seed: int) -> Array:
    """Noise (size, size) between two scales in texels (rows; columns are wider on the face), of unit sd."""
    white = np.random.default_rng(seed).normal(size=(size, size))
    band = ndimage.gaussian_filter(white, (fine, 0.7 * fine), mode="wrap")
    band -= ndimage.gaussian_filter(white, (coarse, 0.7 * coarse), mode="wrap")
    return np.asarray(band / band.std())
