"""What each photo tells of a skin's texels: where each lies on the head, and whether the photo sees it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from fapstream.adapt.blend import blurred
from fapstream.adapt.raster import Cover, cover, nearest
from fapstream.adapt.shading import LUMINANCE, linear, unlit
from fapstream.adapt.views import Camera
from fapstream.head.mesh import Part

Floats = NDArray[np.floating[Any]]
Mask = NDArray[np.bool_]

SIZE = 1024
SEEN_BIAS_M = 0.003
"""What lies behind another surface by less than this is still taken for seen."""
SLANT = (0.20, 0.50)
"""Cosines between the surface and the ray: below the first nothing is taken from a photo, above the second
all.
"""
GRAIN = 700
"""Pixels of a photo's longer side that are enough to tell what hides what."""
CHEEKS = ((0.014, 0.052), (-0.030, 0.018), (0.055, 0.12))
"""|x|, y and z, metres, on the generic head, where there is skin and nothing else."""
FEATURES = ((0.030, 0.046, 0.021, 0.020), (0.0, -0.036, 0.038, 0.032), (0.0, 0.0, 0.018, 0.014))
"""Ellipses on the generic face, |x|, y and half axes in metres, that are taken as they are, for what they
have is no skin either: eye and brow, mouth and chin (lips, beard), nostrils. `FRONT`: only what lies so far
forward.
"""
FRONT = (0.050, 0.065)
COLLAR = (-0.105, -0.085)
"""Heights on the generic head, metres: below the first are clothes and their shadow."""
MOUTH, TEETH = (0.028, -0.0275, 0.011), 0.12
"""Round the lips, |x|, middle and half height in y, metres: what is so much less red there than skin (log
r/g) is teeth, of a mouth that was not closed, and is not painted on lips.
"""
SPREADS, EVEN_SPREADS = (0.10, 0.14, 0.55), (0.09, 0.12, 0.24)
"""The least that skin differs from itself in log r/g, log b/g and log luminance (sd): as the light falls on
it, and without light.
"""
ERODED = 11
"""Texels by which what is trusted is made smaller: near hair, clothes and outlines colours run into one
another.
"""
ENOUGH = (0.15, 0.70)
"""Trust below the first is none, above the second full."""
LIKE, UNLIKE = 2.2, 3.4
"""How many sd from the skin of the cheeks is still skin for sure, and no skin for sure."""


@dataclass(frozen=True, slots=True)
class Photo:
    """A picture, uint8 (h, w, 3) sRGB, and the camera that took it."""

    pixels: NDArray[np.uint8]
    camera: Camera


@dataclass(frozen=True, slots=True)
class Canvas:
    """The texels of a skin that a head has: `hits` are what triangles cover, `places` (k, 3) and `normals`
    (k, 3) where each lies on the adapted head, `home` (k, 3) where it lies on the generic one.
    """

    size: int
    hits: Cover
    places: Floats
    normals: Floats
    home: Floats

    @classmethod
    def of(cls, skin: Part, generic: Part, size: int = SIZE) -> Canvas:
        """For the skin of an adapted head and the generic skin that it was made from."""
        corners = skin.triangles.astype(np.int64)
        hits = cover(skin.uvs.astype(np.float64) * size, corners, (size, size))
        last = np.zeros(size * size, np.int64)
        last[hits.pixels] = np.arange(len(hits.pixels))
        once = last[hits.pixels] == np.arange(len(hits.pixels))
        hits = Cover(hits.pixels[once], hits.triangles[once], hits.shares[once].astype(np.float32))
        normals = hits.mixed(corners, skin.normals)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
        places, home = (hits.mixed(corners, part.positions) for part in (skin, generic))
        return cls(size, hits, places, normals, home)

    def picture(self, values: Floats) -> Floats:
        """(size, size, ...): what the texels have, 0 elsewhere."""
        out = np.zeros((self.size * self.size, *values.shape[1:]), np.float32)
        out[self.hits.pixels] = values
        return out.reshape(self.size, self.size, *values.shape[1:])

    def texels(self, picture: Floats) -> Floats:
        """(k, ...): the texels of a picture (size, size, ...)."""
        flat: Floats = picture.reshape(self.size * self.size, *picture.shape[2:])[self.hits.pixels]
        return flat


@dataclass(frozen=True, slots=True)
class Layer:
    """What one photo tells of the texels: `light` (k, 3), linear, how much it is to be trusted (k,), 0..1,
    and the cosine (k,) between the surface and the way to the camera.
    """

    light: Floats
    trust: Floats
    facing: Floats


def seen(canvas: Canvas, photo: Photo, parts: Mapping[str, Part]) -> Layer:
    """The texels as a photo sees them; the `parts` of the head, adapted, hide one another."""
    height, width = photo.pixels.shape[:2]
    away = photo.camera.position.astype(np.float32) - canvas.places
    facing = (canvas.normals * away).sum(1) / np.linalg.norm(away, axis=1)
    towards = np.flatnonzero(facing > SLANT[0])
    places = canvas.places[towards].astype(np.float64)
    pixels = photo.camera.project(places)
    inside = ((pixels > 0.5) & (pixels < np.array([width, height]) - 0.5)).all(1)
    trust = np.zeros(len(facing), np.float32)
    trust[towards] = smoothstep(*SLANT, facing[towards]) * inside
    trust[towards] *= _unhidden(photo.camera, places, (width, height), parts)
    trust = soft(canvas, trust, 2.0) * trust
    picture = linear(photo.pixels)
    light = np.zeros((len(facing), 3), np.float32)
    at = [np.clip(pixels[:, 1] - 0.5, 0, height - 1), np.clip(pixels[:, 0] - 0.5, 0, width - 1)]
    for channel in range(3):
        light[towards, channel] = ndimage.map_coordinates(picture[..., channel], at, order=1, mode="nearest")
    return Layer(light, trust, facing)


def without_light(canvas: Canvas, layer: Layer) -> Layer:
    """The layer with what is not the head's left out, and without the light that fell on it."""
    rough = layer.trust * skinlike(canvas, layer.light, layer.trust, SPREADS)
    seen = np.flatnonzero(layer.trust)
    flat = layer.light.copy()
    flat[seen] = unlit(layer.light[seen], canvas.normals[seen], rough[seen])
    like = skinlike(canvas, flat, layer.trust, EVEN_SPREADS)
    trust = smoothstep(*ENOUGH, layer.trust * like * smoothstep(*COLLAR, canvas.home[:, 1]))
    shrunk = ndimage.grey_erosion(canvas.picture(trust), ERODED)
    return Layer(flat, np.minimum(soft(canvas, canvas.texels(shrunk), 4.0), trust), layer.facing)


def _unhidden(
    camera: Camera, places: NDArray[np.float64], size: tuple[int, int], parts: Mapping[str, Part]
) -> Mask:
    """bool (n,): places (n, 3) that no part lies before, seen from a camera; by depth, at the grain of
    `GRAIN`.
    """
    shrink = max(1.0, max(size) / GRAIN)
    small = (int(size[0] / shrink), int(size[1] / shrink))
    starts = np.cumsum([0, *(len(part.positions) for part in parts.values())])
    points = np.concatenate([part.positions for part in parts.values()]).astype(np.float64)
    triangles = np.concatenate(
        [part.triangles.astype(np.int64) + start for part, start in zip(parts.values(), starts, strict=False)]
    )
    hits = cover(camera.project(points) / shrink, triangles, small)
    _, near = nearest(hits, hits.mixed(triangles, camera.inside(points)[:, 2]), small)
    near = ndimage.maximum_filter(near, 3)
    pixels = camera.project(places) / shrink
    column, row = (np.clip(pixels[:, k].astype(np.int64), 0, small[k] - 1) for k in (0, 1))
    mask: Mask = camera.inside(places)[:, 2] > near[row, column] - SEEN_BIAS_M
    return mask


def soft(canvas: Canvas, values: Floats, blur: float) -> Floats:
    """Values (k,) of the texels, blurred by so many texels of 1024."""
    return canvas.texels(blurred(canvas.picture(values), blur * canvas.size / SIZE))


def skinlike(canvas: Canvas, light: Floats, trust: Floats, spreads: tuple[float, float, float]) -> Floats:
    """(k,), 0..1: how much a texel looks like the skin of the cheeks, or belongs to the face's own
    features; the rest is hair, clothes or what is behind the head.
    """
    seen = np.flatnonzero(trust)
    home, light = canvas.home[seen], light[seen]
    looks = np.log(np.maximum(np.stack([light[:, 0], light[:, 2], light @ LUMINANCE], 1), 1e-4))
    looks[:, :2] -= np.log(np.maximum(light[:, [1]], 1e-4))
    x, y, z = np.abs(home[:, 0]), home[:, 1], home[:, 2]
    cheek = (trust[seen] > 0.5) & (y > CHEEKS[1][0]) & (y < CHEEKS[1][1]) & (z > CHEEKS[2][0])
    cheek &= (x > CHEEKS[0][0]) & (x < CHEEKS[0][1])
    if cheek.sum() < 100:
        return np.ones(len(trust))
    middle = np.median(looks[cheek], axis=0)
    spread = np.maximum(1.5 * np.median(np.abs(looks[cheek] - middle), axis=0), spreads)
    off = np.sqrt((((looks - middle) / spread) ** 2).sum(1))
    skin, face, bare = (np.zeros(len(trust), np.float32) for _ in range(3))
    skin[seen] = 1 - smoothstep(LIKE, UNLIKE, off)
    teeth = (x < MOUTH[0]) & (np.abs(y - MOUTH[1]) < MOUTH[2]) & (z > FRONT[0])
    teeth &= looks[:, 0] < middle[0] - TEETH
    bare[seen] = teeth
    features = [1 - smoothstep(0.8, 1.1, np.hypot((x - a) / w, (y - b) / h)) for a, b, w, h in FEATURES]
    face[seen] = np.max(features, axis=0) * smoothstep(*FRONT, z)
    kept: Floats = np.maximum(soft(canvas, skin, 2.5), face)
    kept = kept * (1 - np.minimum(4 * soft(canvas, bare, 3.0), 1))
    return kept


def smoothstep(low: float, high: float, value: Floats) -> Floats:
    """0 up to `low`, 1 from `high`, smooth between."""
    t = np.clip((value - low) / (high - low), 0, 1)
    step: Floats = t * t * (3 - 2 * t)
    return step
