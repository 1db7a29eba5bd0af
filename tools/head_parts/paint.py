"""Materials and the textures painted for them."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image as Picture
from PIL import ImageDraw
from scipy import ndimage
from scipy.interpolate import PchipInterpolator

from fapstream.head.mesh import Image, Material
from head_parts.features import IRIS_RAD, PUPIL_RAD
from head_parts.people import EyeLook
from head_parts.surface import Array

if TYPE_CHECKING:
    from head_parts.bust import Bust
    from head_parts.source import Source

AXIS_Z = 0.35
HEIGHTS = ((5.0, 0.0), (6.25, 0.17), (7.95, 0.90), (8.7, 1.0))
"""Where heights of the head fall in the texture: the face takes most of it."""
SKIN_SIZE = 1024
EYE_SPAN_RAD = 2.0
"""Polar angle at the rim of the eye's picture."""
FRINGE = 1 / 3
"""Share of the picture of lashes and brows that the lashes have."""
LASH = (24, 17, 14)
ALPHA_STEPS = 12
"""Coverage is one of so many values; the picture packs better so."""


def linear(red: float, green: float, blue: float) -> tuple[float, float, float, float]:
    """An sRGB colour 0..255 as a linear factor."""
    return (*(float((c / 255) ** 2.2) for c in (red, green, blue)), 1.0)


def encode(rgb: Array, kind: str = "JPEG", quality: int = 88, subsampling: int = 1) -> Image:
    """(h, w, 3) 0..255 as an embedded picture."""
    out = io.BytesIO()
    Picture.fromarray(np.clip(np.rint(rgb), 0, 255).astype(np.uint8)).save(
        out,
        kind,
        **({"quality": quality, "subsampling": subsampling} if kind == "JPEG" else {"optimize": True}),
    )
    return Image(out.getvalue(), f"image/{kind.lower()}")


def teeth_picture() -> Image:
    """Teeth on the left (biting edge at the bottom), gum on the right."""
    fall = np.linspace(0, 1, 32)[:, None, None]
    tooth = np.array([226, 212, 190]) * (1 - fall) + np.array([240, 236, 226]) * fall
    tooth = tooth * np.linspace(1.0, 0.45, 16)[None, :, None]
    gum = np.array([170, 92, 90]) * (1 - fall) + np.array([186, 104, 100]) * fall
    return encode(np.concatenate([tooth, np.repeat(gum, 16, 1)], 1), "PNG")


def depth_picture(front: tuple[int, int, int], back: tuple[int, int, int]) -> Image:
    """A strip that darkens from the lips (top) into the throat."""
    t = np.linspace(0, 1, 32)[:, None, None]
    return encode(np.repeat(np.array(front) * (1 - t) + np.array(back) * t, 4, 1), "PNG")


def eye_material(look: EyeLook, size: int = 384) -> Material:
    """Sclera, iris and pupil, seen along the gaze; the radius is the root of the polar angle."""
    rng = np.random.default_rng(3)
    y, x = np.mgrid[-1 : 1 : size * 1j, -1 : 1 : size * 1j]
    angle, turn = (x**2 + y**2) * EYE_SPAN_RAD, np.arctan2(y, x)
    t = (angle - PUPIL_RAD) / (IRIS_RAD - PUPIL_RAD)
    colour = mix(_sclera(look, angle, turn, rng), _iris(look, t, turn, rng), smooth(1.05, 0.97, t))
    colour = mix(colour, np.array([8, 7, 7.0]), smooth(0.05, -0.03, t))
    colour *= 1 - 0.30 * smooth(0.10, 0.75, -y * np.hypot(x, y))[..., None]
    return Material("eye", texture=encode(colour, quality=86), roughness=0.08)


def _sclera(look: EyeLook, angle: Array, turn: Array, rng: np.random.Generator) -> Array:
    """White that goes pinker to the corners, with a few fine vessels."""
    colour = np.array(look.sclera) - smooth(0.45, 1.2, angle)[..., None] * np.array([26, 58, 58])
    vessels = np.zeros(angle.shape)
    for _ in range(26):
        start, sway, thin = (
            rng.choice([0, np.pi]) + rng.normal(0, 0.5),
            rng.uniform(-1, 1, 3),
            rng.uniform(0.5, 1),
        )
        path = start + 0.12 * (
            sway[0] * np.sin(5 * angle) + sway[1] * np.sin(11 * angle + 1) + sway[2] * angle
        )
        gap = np.abs((turn - path + np.pi) % (2 * np.pi) - np.pi)
        vessels += thin * np.exp(-((gap / 0.012) ** 2)) * smooth(0.55, 1.0, angle)
    return colour - 0.5 * np.clip(vessels, 0, 1)[..., None] * np.array([14, 52, 50])


def _iris(look: EyeLook, t: Array, turn: Array, rng: np.random.Generator) -> Array:
    """Fibres from pupil (t = 0) to limbus (1), a collarette, a dark ring, light pooling at the bottom."""
    at = [(turn + np.pi) / (2 * np.pi) * 1023, np.clip(t, 0, 1) * 31]
    fibres = ndimage.gaussian_filter(rng.normal(size=(1024, 32)), (2.2, 5), mode=("wrap", "nearest"))
    broad = ndimage.gaussian_filter(rng.normal(size=(1024, 32)), (9, 6), mode=("wrap", "nearest"))
    fibre = ndimage.map_coordinates(fibres / fibres.std(), at, order=1)
    fibre = 0.16 * fibre + 0.12 * ndimage.map_coordinates(broad / broad.std(), at, order=1)
    collar = np.exp(-(((t - 0.32 - 0.04 * fibre) / 0.10) ** 2))
    glow = 0.70 + 0.42 * collar + fibre * smooth(0.0, 0.15, t) + 0.34 * smooth(-0.2, 0.9, -np.sin(-turn)) * t
    colour = (
        np.array(look.iris) * glow[..., None] + np.array([16, 9, 0]) * (collar * (1 - 0.5 * t))[..., None]
    )
    colour = colour * (1 - 0.62 * smooth(0.74, 1.0, t))[..., None]
    return np.asarray(colour * (1 - 0.45 * smooth(0.14, 0.0, t))[..., None])


def fringe_material(brow_cover: Array, brow: tuple[float, float, float]) -> Material:
    """Lashes in the upper part (root at its bottom), the brows' hairs `brow_cover` (h, w) below."""
    height, width = brow_cover.shape
    lash = _lash_cover(width, round(height * FRINGE / (1 - FRINGE)))
    colour = np.concatenate([np.full((*lash.shape, 3), LASH), np.full((height, width, 3), brow)])
    alpha = np.rint(np.concatenate([lash, brow_cover])[..., None] * ALPHA_STEPS) * (255 / ALPHA_STEPS)
    out = io.BytesIO()
    pixels = np.concatenate([colour, alpha], -1).astype(np.uint8)
    Picture.fromarray(pixels, "RGBA").save(out, "PNG", optimize=True)
    picture = Image(out.getvalue(), "image/png")
    return Material("lashes", texture=picture, roughness=0.9, alpha="BLEND", double_sided=True)


def _lash_cover(width: int, height: int) -> Array:
    """Single hairs, gathered in twos and threes at their tips; denser to the root."""
    rng = np.random.default_rng(5)
    canvas = Picture.new("L", (width * 3, height * 3), 0)
    pen = ImageDraw.Draw(canvas)
    for x in np.arange(14, width * 3 - 12, 13.0):
        start, lean = x + rng.normal(0, 4), rng.normal(0, 16) + (x / width / 1.5 - 1) * 22
        t = np.linspace(0, 1, 10)
        line = np.stack([start + lean * t**2, height * 3 * (1 - t * rng.uniform(0.55, 0.98))], 1)
        for k in range(9):
            pen.line([*line[k], *line[k + 1]], fill=int(250 - 12 * k), width=max(2, round(8 * (1 - t[k]))))
    cover = np.asarray(canvas.resize((width, height), Picture.Resampling.BOX), float) / 255
    root = smooth(0.80, 1.0, np.linspace(0, 1, height))[:, None]
    return np.maximum(cover, 0.85 * root)


def tear_material() -> Material:
    """Left half the clear film, right half the wet flesh of the eye's corner."""
    film, flesh = (255, 236, 230, 70), (206, 128, 120, 255)
    out = io.BytesIO()
    Picture.fromarray(np.array([[film] * 4 + [flesh] * 4] * 8, np.uint8), "RGBA").save(out, "PNG")
    return Material("tears", texture=Image(out.getvalue(), "image/png"), roughness=0.06, alpha="BLEND")


def smooth(low: float, high: float, value: Array) -> Array:
    t = np.clip((value - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def mix(one: Array, other: Array, share: Array) -> Array:
    return one * (1 - share[..., None]) + other * share[..., None]


def shirt_material(colour: tuple[float, float, float], size: int = 64) -> Material:
    """Jersey: rows of stitches that tile."""
    y, x = np.mgrid[0:size, 0:size] / size * 2 * np.pi
    stitch = np.cos(8 * x + 0.9 * np.sin(8 * y)) * 0.5 + 0.35 * np.cos(8 * y)
    blotch = ndimage.gaussian_filter(np.random.default_rng(4).normal(size=(size, size)), 2, mode="wrap")
    shade = 1 + 0.028 * stitch + 0.03 * blotch / blotch.std()
    return Material(
        "shirt", texture=encode(np.array(colour) * shade[..., None], "PNG"), roughness=0.95, double_sided=True
    )


TEETH = Material("teeth", texture=teeth_picture(), roughness=0.28)
TONGUE = Material("tongue", texture=depth_picture((222, 134, 128), (96, 42, 40)), roughness=0.62)
MOUTH = Material("mouth", texture=depth_picture((150, 70, 66), (16, 5, 5)), roughness=0.75, double_sided=True)


def sample(mask: Array, uvs: Array) -> Array:
    """Bilinear values of a picture (row 0 at v = 1) at texture coordinates (..., 2)."""
    rows, columns = mask.shape
    at = [(1 - uvs[..., 1]) * rows - 0.5, uvs[..., 0] * columns - 0.5]
    return ndimage.map_coordinates(mask, at, order=1, mode="nearest")


def atlas_uvs(source: Source, bust: Bust) -> Array:
    """The base atlas' coordinates of the coarse vertices, (n, 2); the face's where there are several."""
    body = source.groups["body"]
    first = np.full(len(source.base), -1)
    first[body.vertices.ravel()] = body.uvs.ravel()
    face = source.uvs[body.uvs].mean(1)[:, 0] > 0.63
    face &= source.uvs[body.uvs].mean(1)[:, 1] > 0.14
    first[body.vertices[face].ravel()] = body.uvs[face].ravel()
    return source.uvs[first[bust.control]]


def wrap(bust: Bust) -> Array:
    """Texture coordinates (n, 2) of the fine skin: a cylinder round the head that favours the face.

    Below the mouth the height also counts how far the skin has gone in, for the underside of the chin.
    """
    points = bust.skin.points
    x, y, z = points.T
    theta = np.arctan2(x, z - AXIS_Z)
    reach = np.hypot(x, z - AXIS_Z)
    under = smooth(6.80, 6.40, y)
    height = y + 0.6 * under * np.minimum(reach - 1.0, 0.1)
    table = np.array(HEIGHTS)
    v = PchipInterpolator(table[:, 0], table[:, 1])(np.clip(height, 5.0, 8.7))
    u = 0.5 + (theta + 0.88 * np.sin(theta)) / (2 * np.pi)
    return np.stack([u, 1 - v], 1)
