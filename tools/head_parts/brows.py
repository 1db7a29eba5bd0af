"""Brows: single hairs on a patch that lies on the skin, over a soft shade painted under it."""

from __future__ import annotations

import numpy as np
from PIL import Image as Picture
from PIL import ImageDraw
from scipy import ndimage

from head_parts.assemble import Piece
from head_parts.face_canvas import Canvas
from head_parts.paint import FRINGE, smooth
from head_parts.surface import Array

OFF_SKIN = 0.0035
WIDE = 0.047
"""Half the width near the nose."""
LENGTH, REACH = 0.46, 2.6
"""Decimetres from nose to temple; how many half widths the patch goes up and down."""
WIDTH, HEIGHT, FINER = 512, 128, 3


def placed(points: Array, eye: Array) -> tuple[Array, Array]:
    """The brow's own coordinates: s from nose 0 to temple 1, d across it in half widths."""
    s = (np.abs(points[..., 0]) - (eye[0] - 0.185)) / LENGTH
    middle = eye[1] + 0.205 + 0.075 * np.sin(np.clip(s, 0, 1.1) * np.pi * 0.72)
    middle -= 0.075 * np.clip(s - 0.66, 0, 1) * 1.6
    width = WIDE - 0.66 * WIDE * np.clip(s, 0, 1) ** 1.3
    return s, (points[..., 1] - middle) / width


def body(s: Array, d: Array) -> Array:
    """How dense the hairs are, 0..1."""
    return np.exp(-(d**2) * 1.2) * smooth(-0.08, 0.24, s) * smooth(1.06, 0.80, s)


def brow_shade(canvas: Canvas) -> Array:
    s, d = placed(canvas.at, canvas.eye)
    return np.asarray(body(s, d) * smooth(0.7, 0.9, canvas.at[..., 2]))


def brow_piece(skin: Piece, eye: Array) -> Piece:
    """The skin's triangles under the brows, lifted a little; they move with the same vertices."""
    s, d = placed(skin.points, eye)
    on = (np.abs(d) < REACH) & (s > -0.12) & (s < 1.12) & (skin.points[:, 2] > 0.7)
    used, triangles = np.unique(skin.triangles[on[skin.triangles].all(1)], return_inverse=True)
    uvs = np.stack([(s + 0.1) / 1.2, FRINGE + (1 - FRINGE) * (0.5 - d / (2 * REACH))], -1)
    return Piece(
        "brows",
        skin.points[used] + OFF_SKIN * skin.normals[used],
        skin.normals[used],
        np.clip(uvs[used], (0.002, FRINGE + 0.01), (0.998, 0.995)),
        triangles.reshape(-1, 3),
        skin.material,
        skin.sources[used],
    )


def brow_hairs(weight: float) -> Array:
    """Coverage (HEIGHT, WIDTH) 0..1 by hairs that lean outward, upper ones down and lower ones up."""
    rng = np.random.default_rng(9)
    width, height = WIDTH * FINER, HEIGHT * FINER
    canvas = Picture.new("L", (width, height), 0)
    pen = ImageDraw.Draw(canvas)
    for _ in range(int(640 * weight)):
        s, d = rng.beta(1.25, 1.25), np.clip(rng.normal(0, 0.55), -1.1, 1.1)
        lean = np.radians(78 - 72 * min(1.0, 1.15 * s**0.6) - 22 * d * min(1.0, 2 * s) + rng.normal(0, 9))
        x, y = (s + 0.06) / 1.2 * width, (0.53 - d / (2 * REACH)) * height
        size, thick = rng.uniform(0.65, 1.1) * 88 * (1 - 0.25 * s), rng.choice([2, 2, 3, 3])
        for k in range(7):
            ahead = x + size / 7 * np.cos(lean), y - size / 7 * np.sin(lean)
            shade = int(rng.uniform(190, 255) * (1 - 0.5 * (k / 7) ** 2))
            pen.line([x, y, *ahead], fill=shade, width=max(1, thick - (k > 3) - (k > 5)))
            (x, y), lean = ahead, lean - 0.06
    small = canvas.resize((WIDTH, HEIGHT), Picture.Resampling.BOX)
    cover = np.asarray(ndimage.gaussian_filter(np.asarray(small, float) / 255, 0.35)) * 1.1
    along = np.linspace(0, 1, WIDTH)
    edge = (0.35 + 0.65 * smooth(0.08, 0.28, along)) * smooth(0.0, 0.03, along) * smooth(1.0, 0.97, along)
    return np.clip(cover * edge, 0, 1)
