"""The skin's fine relief, as a normal map: pores, the furrows of the lips, the lids' crease, lines of age."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np

from fapstream.head.mesh import Image
from head_parts.face_canvas import Canvas, grain, noise
from head_parts.paint import encode, smooth
from head_parts.people import Person
from head_parts.surface import Array

PORE_DM, LINE_DM, FURROW_DM, CREASE_DM = 0.0007, 0.006, 0.0016, 0.008
STEEPEST = 0.9


def pores(canvas: Canvas) -> Array:
    """Depth 0..1 of the pores: many on the nose, cheeks and forehead, none on the lips."""
    _, ey, _ = canvas.eye
    where = (
        0.45 + 0.55 * canvas.spot(0.0, ey - 0.34, 0.20, 0.25) + 0.5 * canvas.spot(0.20, ey - 0.42, 0.22, 0.25)
    )
    where += 0.25 * canvas.spot(0.0, ey + 0.42, 0.4, 0.22) + 0.3 * canvas.spot(
        0.0, canvas.mouth[1] - 0.35, 0.2, 0.15
    )
    dots = np.clip(grain(len(canvas.at), 0.9, 2.4, 21) - 0.55, 0, 2) / 2
    return np.asarray(dots * where * (1 - canvas.lips) * canvas.front)


def age_lines(canvas: Canvas) -> Array:
    """Depth of the lines of age, about 1 where deepest; from lines.toml."""
    ex, ey, _ = canvas.eye
    origin = {"brow": (0.0, ey), "eye": (ex, ey), "mouth": (0.0, canvas.mouth[1])}
    wander = 0.008 * np.stack([noise(canvas.at, 9, 51), noise(canvas.at, 9, 52)], -1)
    x, y = np.abs(canvas.at[..., 0]) + wander[..., 0], canvas.at[..., 1] + wander[..., 1]
    total = np.zeros(x.shape)
    for row in tomllib.loads(Path(__file__).with_name("lines.toml").read_text("utf-8")).values():
        path = np.array(row["path"]) + origin[row["from"]]
        low, high = path.min(0) - 0.1, path.max(0) + 0.1
        at = np.nonzero((x > low[0]) & (x < high[0]) & (y > low[1]) & (y < high[1]) & (canvas.front > 0.3))
        gap, along = _to_path(np.stack([x[at], y[at]], -1), path)
        fade = (
            smooth(0.0, 0.25, along) * smooth(1.0, 0.75, along)
            if row["path"][0][0] > 0.001
            else smooth(1.0, 0.7, along)
        )
        total[at] = np.maximum(total[at], row["depth"] * fade * np.exp(-((gap / row["width"]) ** 2)))
    return np.asarray(total * np.clip(0.75 + 0.4 * noise(canvas.at, 10, 53), 0.15, 1.2))


def _to_path(points: Array, path: Array) -> tuple[Array, Array]:
    """Distance of points (n, 2) to a polyline through `path`, and how far along it 0..1."""
    fine = np.linspace(0, len(path) - 1, 40)
    line = np.stack([np.interp(fine, np.arange(len(path)), path[:, k]) for k in (0, 1)], 1)
    gap = np.full(len(points), np.inf)
    along = np.zeros(len(points))
    for k, point in enumerate(line):
        here = np.hypot(*(points - point).T)
        nearer = here < gap
        gap[nearer], along[nearer] = here[nearer], k / 39
    return gap, along


def crease(canvas: Canvas, lift: float) -> Array:
    """The fold of the upper lids, 0..1, `lift` decimetres over the middle of the margin."""
    total = np.zeros(canvas.open.shape)
    for eye in canvas.bust.eyes.values():
        margin = canvas.bust.skin.points[eye.upper]
        order = np.argsort(margin[:, 0])
        left, right = margin[order[0], 0], margin[order[-1], 0]
        x, y = canvas.at[..., 0], canvas.at[..., 1]
        t = (x - left) / (right - left)
        arch = np.clip(4 * t * (1 - t), 0, 1) ** 0.6
        line = np.interp(x, margin[order, 0], margin[order, 1]) + lift * (0.35 + 0.65 * arch)
        gap = (y - line) / np.where(y > line, 0.012, 0.007)
        total += np.exp(-(gap**2)) * smooth(-0.10, 0.1, t) * smooth(1.12, 0.9, t) * (canvas.at[..., 2] > 0.9)
    return total


def furrows(canvas: Canvas) -> Array:
    """The lips' upright furrows, about -1..1."""
    return noise(canvas.at * (6.0, 1.0, 1.0), 9, 4) * canvas.lips


def normal_map(canvas: Canvas, person: Person) -> Image:
    """Tangent space, +y up the picture; slopes from heights in decimetres over the texels' own size."""
    fine = noise(canvas.at, 60, 61) * 0.00035 * canvas.front
    height = fine - PORE_DM * (1 + 0.1 * person.skin.lines) * pores(canvas) * 2
    height -= LINE_DM * person.skin.lines * age_lines(canvas)
    height += FURROW_DM * furrows(canvas) * (1 + 0.5 * person.skin.lines)
    height -= CREASE_DM * crease(canvas, person.eyes.crease)
    right, down = (np.maximum(np.linalg.norm(np.gradient(canvas.at, axis=k), axis=-1), 4e-4) for k in (1, 0))
    slope_x, slope_y = np.gradient(height, axis=1) / right, -np.gradient(height, axis=0) / down
    flat = 1 - canvas.seam
    slope_x, slope_y = slope_x * flat, slope_y * flat
    steep = np.maximum(np.hypot(slope_x, slope_y) / STEEPEST, 1)
    normal = np.stack([-slope_x / steep, -slope_y / steep, np.ones_like(height)], -1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return encode(normal * 127.5 + 127.5, quality=70, subsampling=0)
