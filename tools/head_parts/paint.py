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
from head_parts.surface import Array

if TYPE_CHECKING:
    from head_parts.bust import Bust
    from head_parts.source import Source

AXIS_Z = 0.35
HEIGHTS = ((5.0, 0.0), (6.25, 0.17), (7.95, 0.90), (8.7, 1.0))
"""Where heights of the head fall in the texture: the face takes most of it."""
SKIN_SIZE = 1024


def linear(red: float, green: float, blue: float) -> tuple[float, float, float, float]:
    """An sRGB colour 0..255 as a linear factor."""
    return (*(float((c / 255) ** 2.2) for c in (red, green, blue)), 1.0)


def encode(rgb: Array, kind: str = "JPEG", quality: int = 88) -> Image:
    """(h, w, 3) 0..255 as an embedded picture."""
    out = io.BytesIO()
    Picture.fromarray(np.clip(np.rint(rgb), 0, 255).astype(np.uint8)).save(
        out, kind, **({"quality": quality, "subsampling": 1} if kind == "JPEG" else {"optimize": True})
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


def eye_picture(size: int = 256) -> Image:
    """Sclera, iris and pupil, seen along the gaze; the radius is the polar angle."""
    from head_parts.features import EYE_SPAN_RAD, IRIS_RAD, PUPIL_RAD

    rng = np.random.default_rng(3)
    y, x = np.mgrid[-1 : 1 : size * 1j, -1 : 1 : size * 1j]
    angle, turn = np.hypot(x, y) * EYE_SPAN_RAD, np.arctan2(y, x)
    sclera = np.array([232, 226, 221.0]) - smooth(0.45, 1.3, angle)[..., None] * np.array([22, 48, 48])
    fibres = ndimage.gaussian_filter1d(rng.normal(size=512), 1.6, mode="wrap")
    fibre = (fibres / np.abs(fibres).max())[((turn + np.pi) / (2 * np.pi) * 511).astype(int)]
    t = (angle - PUPIL_RAD) / (IRIS_RAD - PUPIL_RAD)
    glow = 0.62 + 0.75 * np.exp(-(((t - 0.28) / 0.33) ** 2)) + 0.28 * fibre
    iris = np.array([96, 70, 46.0]) * glow[..., None] + np.array([6, 14, 16]) * np.clip(t, 0, 1)[..., None]
    iris *= (1 - 0.72 * smooth(0.72, 1.0, t))[..., None]
    colour = _mix(sclera, iris, smooth(IRIS_RAD + 0.02, IRIS_RAD - 0.03, angle))
    return encode(
        _mix(colour, np.array([9, 8, 8.0]), smooth(PUPIL_RAD + 0.012, PUPIL_RAD - 0.012, angle)), quality=92
    )


def lash_picture() -> Image:
    """Single hairs, transparent between; the root at the bottom."""
    rng = np.random.default_rng(5)
    width, height = 512, 64
    canvas = Picture.new("L", (width * 2, height * 2), 0)
    pen = ImageDraw.Draw(canvas)
    for x in np.arange(10, width * 2 - 8, 17.0):
        start, lean = x + rng.normal(0, 3), rng.normal(0, 9) + (x / width - 1) * 14
        t = np.linspace(0, 1, 9)
        line = np.stack([start + lean * t**2, height * 2 * (1 - t * rng.uniform(0.7, 0.98))], 1)
        for k in range(8):
            pen.line([*line[k], *line[k + 1]], fill=int(235 - 14 * k), width=max(1, round(6 * (1 - t[k]))))
    pen.rectangle([0, height * 2 - 13, width * 2, height * 2], fill=210)
    alpha = canvas.resize((width, height), Picture.Resampling.LANCZOS)
    picture = Picture.merge("RGBA", [Picture.new("L", (width, height), c) for c in (30, 21, 17)] + [alpha])
    out = io.BytesIO()
    picture.save(out, "PNG", optimize=True)
    return Image(out.getvalue(), "image/png")


def smooth(low: float, high: float, value: Array) -> Array:
    t = np.clip((value - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def _mix(one: Array, other: Array, share: Array) -> Array:
    return one * (1 - share[..., None]) + other * share[..., None]


def hair_material() -> Material:
    rng = np.random.default_rng(11)
    size = 256
    fine = ndimage.gaussian_filter(rng.normal(size=(size, size)), (34, 0.6), mode="wrap")
    broad = ndimage.gaussian_filter(rng.normal(size=(size, size)), (40, 5), mode="wrap")
    tone = 0.30 * fine / fine.std() + 0.20 * broad / broad.std()
    colour = (
        np.array([66, 46, 33.0]) * (1 + 0.55 * tone[..., None])
        + np.array([10, 6, 2]) * np.clip(tone, 0, 2)[..., None]
    )
    return Material("hair", texture=encode(colour, quality=82), roughness=0.74, double_sided=True)


EYE = Material("eye", texture=eye_picture(), roughness=0.12)
TEETH = Material("teeth", texture=teeth_picture(), roughness=0.28)
TONGUE = Material("tongue", texture=depth_picture((168, 86, 84), (44, 16, 16)), roughness=0.62)
MOUTH = Material("mouth", texture=depth_picture((120, 52, 50), (12, 4, 4)), roughness=0.75, double_sided=True)
LASHES = Material("lashes", texture=lash_picture(), roughness=0.9, alpha="BLEND", double_sided=True)
SHIRT = Material("shirt", linear(74, 94, 118), roughness=0.95, double_sided=True)


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
    u = 0.5 + (theta + 0.8 * np.sin(theta)) / (2 * np.pi)
    return np.stack([u, 1 - v], 1)
