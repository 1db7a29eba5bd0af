"""The picture of hair: opaque streaks for the cap, then tiles of strands from root (top) to tip."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
from PIL import Image as Picture
from PIL import ImageDraw
from scipy import ndimage

from fapstream.head.mesh import Image, Material
from head_parts.hair import CAP_TILES, CARD_TILES, SKULL, SPARSE, Scalp, seen_from_above
from head_parts.people import HairLook
from head_parts.surface import Array

TILE, HEIGHT, FINER = 64, 512, 2
CAP_DARK = 0.8
"""What lies under strands gets less light."""
SHADES = 40
"""Colours in the packed picture."""


def hair_material(look: HairLook, scalp: Scalp) -> Material:
    """A picture of (CAP_TILES + CARD_TILES) columns; where there are no cards, of the cap from above."""
    rng = np.random.default_rng(11)
    if not scalp.groom.cards:
        return replace(_cut_out(_coils(look, scalp, rng)), name="fuzz", roughness=1.0)
    columns = [_cap(look, rng)] + [
        _strands(look, 20 if k >= CARD_TILES - SPARSE else 46, rng) for k in range(CARD_TILES)
    ]
    return _cut_out(np.concatenate(columns, 1))


def _cut_out(pixels: Array) -> Material:
    picture = Picture.fromarray(np.clip(pixels, 0, 255).astype(np.uint8), "RGBA")
    out = io.BytesIO()
    picture.quantize(SHADES, Picture.Quantize.FASTOCTREE, dither=Picture.Dither.NONE).save(
        out, "PNG", optimize=True
    )
    image = Image(out.getvalue(), "image/png")
    return Material("hair", texture=image, roughness=0.6, alpha="MASK", cutoff=0.4, double_sided=True)


def _coils(look: HairLook, scalp: Scalp, rng: np.random.Generator) -> Array:
    """Short coiled hair from above, thinner towards the hairline, (HEIGHT, HEIGHT, 4)."""
    y, x = (np.mgrid[0:HEIGHT, 0:HEIGHT] + 0.5) / HEIGHT
    direction = seen_from_above(np.stack([x, y], -1))
    points = SKULL + direction * scalp.radius(direction)[..., None]
    knots = ndimage.gaussian_filter(rng.normal(size=x.shape), 1.3) - ndimage.gaussian_filter(
        rng.normal(size=x.shape), 3.0
    )
    knots /= knots.std()
    colour = (
        np.array(look.root) + (np.array(look.tip) - look.root) * np.clip(0.4 + 0.3 * knots, 0, 1)[..., None]
    )
    cover = 0.5 + scalp.inside(points) / 0.14 + 0.22 * knots - 0.3
    return np.dstack([colour, 255 * np.clip(cover, 0, 1)])


def _cap(look: HairLook, rng: np.random.Generator) -> Array:
    """Hair seen between the strands: dark, streaked along v."""
    size = (HEIGHT, TILE * CAP_TILES)
    streak = ndimage.gaussian_filter(rng.normal(size=size), (50, 1.1))
    tone = 0.14 + 0.2 * np.clip(streak / streak.std(), -1, 2)
    colour = _coloured(look, tone, np.full(size, 0.35))
    return np.dstack([colour * CAP_DARK, np.full(size, 255.0)])


def _strands(look: HairLook, count: int, rng: np.random.Generator) -> Array:
    """One lock: `count` strands of different shade and length, (h, w, 4)."""
    size = (TILE * FINER, HEIGHT)
    light = Picture.new("L", size, 0)
    alpha = Picture.new("L", size, 0)
    pen, mask = ImageDraw.Draw(light), ImageDraw.Draw(alpha)
    for _ in range(count):
        x = size[0] * (0.5 + np.clip(rng.normal(0, 0.21), -0.42, 0.42))
        bend, phase = rng.normal(0, 4.0), rng.uniform(0, 6.28)
        end = rng.uniform(0.72, 1.0) if rng.random() < 0.75 else rng.uniform(0.4, 0.8)
        t = np.linspace(rng.uniform(0, 0.03), end, 24)
        line = np.stack([x + bend * t**2 + 1.5 * np.sin(5 * t + phase), t * HEIGHT], 1)
        shade = int(np.clip(rng.normal(128, 46), 25, 250))
        wide = rng.choice([3, 4, 5, 7])
        for k in range(23):
            width = max(2, round(wide * min(1.0, 2.6 * (1 - t[k] / end) + 0.25)))
            pen.line([*line[k], *line[k + 1]], fill=shade, width=width)
            mask.line([*line[k], *line[k + 1]], fill=255, width=width)
    small = (TILE, HEIGHT)
    tone = np.asarray(_filled(light, alpha).resize(small, Picture.Resampling.BOX), float) / 255
    cover = np.asarray(alpha.resize(small, Picture.Resampling.BOX), float)
    cover[:, [0, -1]] = 0
    return np.dstack([_coloured(look, tone, np.linspace(0, 1, HEIGHT)[:, None]), cover])


def _filled(light: Picture.Image, alpha: Picture.Image) -> Picture.Image:
    """Shades carried on into the gaps, so that edges do not darken."""
    empty = np.asarray(alpha) == 0
    nearest = ndimage.distance_transform_edt(empty, return_distances=False, return_indices=True)
    return Picture.fromarray(np.asarray(light)[tuple(nearest)])


def _coloured(look: HairLook, tone: Array, along: Array) -> Array:
    """Colours (h, w, 3) of shades 0..1, at places 0 root .. 1 tip; the lightest turn grey first."""
    root, tip = np.array(look.root), np.array(look.tip)
    share = np.clip(0.15 + 0.75 * tone + 0.25 * (along - 0.4), 0, 1)[..., None]
    deep = np.clip(0.55 + 1.1 * along, 0.55, 1.0)
    colour = (root * (1 - share) + tip * share) * np.broadcast_to(deep, tone.shape)[..., None]
    white = np.clip((tone - (1 - look.grey)) / 0.1, 0, 1)[..., None]
    return colour * (1 - white) + np.array([196, 194, 190]) * white
