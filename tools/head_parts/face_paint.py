"""The skin's texture: tone, blush, lips, brows, scalp and baked shade, painted in space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from PIL import Image as Picture
from PIL import ImageDraw
from scipy import ndimage

from fapstream.head.mesh import Material
from head_parts.assemble import Piece
from head_parts.bust import Bust
from head_parts.dress import above_hairline, ear_mask
from head_parts.paint import SKIN_SIZE, atlas_uvs, encode, sample, smooth
from head_parts.shade import openness
from head_parts.source import Source
from head_parts.surface import Array, rasterise

TONE = np.array([223, 172, 145.0])
LIP = np.array([190, 120, 112.0])
HAIR = np.array([58, 40, 29.0])


@dataclass(frozen=True)
class Canvas:
    """What each texel shows: its place (s, s, 3), lips and ears 0..1, and openness to light."""

    at: Array
    lips: Array
    ears: Array
    open: Array
    eye: Array
    """Centre of the left eye."""
    mouth: Array
    """Middle of the line of the lips."""


def skin_material(source: Source, bust: Bust, skin: Piece, others: list[Piece]) -> Material:
    canvas = _canvas(source, bust, skin, others)
    colour = _tone(canvas)
    colour = _mix(colour, LIP * _lip_lines(canvas)[..., None], 0.80 * canvas.lips)
    colour = _mix(colour, HAIR, brows(canvas) * 0.88)
    colour = _mix(colour, HAIR * 0.9, _scalp(canvas))
    colour *= _shade(canvas.open)
    return Material("skin", texture=encode(colour, quality=82), roughness=0.55)


def _canvas(source: Source, bust: Bust, skin: Piece, others: list[Piece]) -> Canvas:
    atlas = bust.step.matrix @ atlas_uvs(source, bust)
    opaque = [(p.points, p.triangles) for p in (skin, *others) if p.material.alpha == "OPAQUE"]
    light = openness(skin.points, skin.normals, opaque)
    ears = ear_mask(source, bust)[skin.sources]
    rows = np.column_stack([skin.points, atlas[skin.sources], ears, light])
    picture, covered = rasterise(skin.uvs, skin.triangles, rows, SKIN_SIZE)
    nearest = ndimage.distance_transform_edt(~covered, return_distances=False, return_indices=True)
    picture = picture[tuple(nearest)]
    lips = ndimage.gaussian_filter(sample(source.mask("lips"), picture[..., 3:5]), 1.5)
    mouth = bust.skin.points[bust.skin.inner.point(0.0, True)]
    shade = ndimage.gaussian_filter(picture[..., 6], 1.0)
    lips = np.maximum(lips, _lip_line(bust, picture[..., :3]))
    neck = smooth(6.35, 6.1, picture[..., 1])
    shade = np.maximum.reduce(
        [shade, 0.62 * lips, 0.80 * neck, 0.55 * picture[..., 5], 0.55 * _eye_rims(bust, picture)]
    )
    return Canvas(picture[..., :3], lips, picture[..., 5], shade, bust.eyes["l"].centre, mouth)


def _lip_line(bust: Bust, at: Array) -> Array:
    """1 where the lips meet, so that no skin shows on their inside."""
    contour = bust.skin.points[bust.skin.inner.vertices][bust.skin.inner.upper]
    order = np.argsort(contour[:, 0])
    height = np.interp(at[..., 0], contour[order, 0], contour[order, 1])
    inside = smooth(0.21, 0.195, np.abs(at[..., 0])) * (at[..., 2] > 1.3)
    return np.asarray(smooth(0.035, 0.015, np.abs(at[..., 1] - height)) * inside)


def _eye_rims(bust: Bust, picture: Array) -> Array:
    """1 on the edges of the lids, which would otherwise bake the ball's shadow in."""
    at = np.concatenate([np.abs(picture[..., :1]), picture[..., 1:3]], -1)
    gap = np.linalg.norm((at - bust.eyes["l"].centre) * (1.0, 1.6, 0.3), axis=-1)
    return np.asarray(smooth(0.24, 0.16, gap))


def _tone(canvas: Canvas) -> Array:
    """Skin with its slight changes of colour."""
    x, y, z = np.moveaxis(canvas.at, -1, 0)
    side = np.abs(x)
    ex, ey, _ = canvas.eye
    front = smooth(0.5, 1.1, z)

    def spot(cx: float, cy: float, rx: float, ry: float) -> Array:
        return np.exp(-(((side - cx) / rx) ** 2) - ((y - cy) / ry) ** 2) * front

    noise = 0.022 * _noise(canvas.at, 5, 1) + 0.012 * _noise(canvas.at, 24, 2)
    colour = TONE * (1 + noise[..., None] * np.array([0.6, 1.0, 1.1]))
    blush = 0.75 * spot(ex + 0.17, ey - 0.46, 0.27, 0.22) + 0.55 * spot(0, ey - 0.36, 0.13, 0.12)
    blush += 0.25 * spot(0, canvas.mouth[1] - 0.32, 0.16, 0.12) + 0.7 * canvas.ears
    socket = 0.75 * spot(ex, ey + 0.07, 0.22, 0.09) + 0.5 * spot(ex - 0.08, ey - 0.15, 0.17, 0.06)
    rim = spot(ex, ey, 0.20, 0.075)
    colour *= 1 - blush[..., None] * np.array([0.02, 0.135, 0.125])
    colour *= 1 - socket[..., None] * np.array([0.07, 0.12, 0.10])
    return np.asarray(colour * (1 - rim[..., None] * np.array([0.02, 0.10, 0.10])))


def _lip_lines(canvas: Canvas) -> Array:
    lines = _noise(canvas.at * (6.0, 1.0, 1.0), 9, 4)
    edge = smooth(0.0, 0.02, np.abs(canvas.at[..., 1] - canvas.mouth[1]))
    return np.asarray((1 + 0.05 * lines) * (0.80 + 0.20 * edge))


def brows(canvas: Canvas) -> Array:
    """Coverage by hairs drawn in the brow's own coordinates: s from nose to temple, d across."""
    x, y, z = np.moveaxis(canvas.at, -1, 0)
    ex, ey, _ = canvas.eye
    s = (np.abs(x) - (ex - 0.185)) / 0.46
    middle = (
        ey + 0.205 + 0.085 * np.sin(np.clip(s, 0, 1.1) * np.pi * 0.72) - 0.075 * np.clip(s - 0.66, 0, 1) * 1.6
    )
    width = 0.052 - 0.036 * np.clip(s, 0, 1) ** 1.3
    d = (y - middle) / width
    hairs = _brow_hairs()
    rows, columns = hairs.shape
    at = [np.clip((0.5 - d / 5) * rows, 0, rows - 1), np.clip((s + 0.1) / 1.2 * columns, 0, columns - 1)]
    strokes = ndimage.map_coordinates(hairs, at, order=1)
    body = np.exp(-(d**2) * 1.1) * smooth(-0.04, 0.14, s) * smooth(1.03, 0.85, s)
    inside = smooth(0.7, 0.9, z) * (np.abs(d) < 2.4) * (s > -0.1) * (s < 1.1)
    return np.asarray(np.clip(0.42 * body + 0.75 * strokes * (0.35 + 0.65 * body), 0, 1) * inside)


def _brow_hairs() -> Array:
    rng = np.random.default_rng(9)
    width, height = 1536, 384
    canvas = Picture.new("L", (width, height), 0)
    pen = ImageDraw.Draw(canvas)
    for _ in range(520):
        s, d = rng.beta(1.15, 1.2), rng.normal(0, 0.55)
        lean = np.radians(75 - 66 * s**0.5 - 20 * d * s + rng.normal(0, 8))
        size = rng.uniform(0.6, 1.0) * 85
        x, y = (s + 0.1) / 1.2 * width, (0.5 - d / 5) * height + 0.4 * size * np.sin(lean)
        for k in range(6):
            step = size / 6
            ahead = x + step * np.cos(lean), y - step * np.sin(lean)
            pen.line([x, y, *ahead], fill=int(rng.uniform(150, 240) * (1 - k / 9)), width=max(2, 5 - k // 2))
            (x, y), lean = ahead, lean - 0.07
    return np.asarray(ndimage.gaussian_filter(np.asarray(canvas, float) / 255, 1.2))


def _scalp(canvas: Canvas) -> Array:
    """Hair that shows through at its edge."""
    inside = above_hairline(canvas.at, canvas.eye[1]) * (1 - canvas.ears)
    ragged = inside + 0.03 * _noise(canvas.at * (1.0, 0.25, 1.0), 26, 6)
    return np.asarray(0.92 * smooth(-0.06, 0.05, ragged) * (1 - smooth(0.1, 0.6, canvas.ears)))


def _shade(light: Array) -> Array:
    """Occluded skin is darker and redder, (..., 3)."""
    open_ = np.clip(light * 1.12, 0.05, 1)[..., None]
    return np.asarray(open_ ** np.array([0.42, 0.62, 0.68]))


def _noise(points: Array, waves: float, seed: int) -> Array:
    """Smooth noise in space, about unit size, with two octaves."""
    grid = np.random.default_rng(seed).normal(size=(32, 32, 32))
    total = np.zeros(points.shape[:-1])
    for octave, size in ((1.0, 1.0), (2.1, 0.5)):
        at = np.moveaxis(points * waves * octave, -1, 0)
        total += size * ndimage.map_coordinates(grid, at, order=1, mode="grid-wrap")
    return total


def _mix(one: Array, other: Array, share: Array) -> Array:
    return one * (1 - share[..., None]) + other * share[..., None]
