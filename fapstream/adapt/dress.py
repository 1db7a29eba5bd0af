"""What is not skin in the person's colours: irises, hair, clothes; and no brows besides those in the
photo.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image as Picture
from scipy import ndimage

from fapstream.adapt.layers import Photo, smoothstep
from fapstream.adapt.shading import LUMINANCE, encoded, linear
from fapstream.head.mesh import Head, Image, Part

Floats = NDArray[np.floating[Any]]

IRIS_M, IRIS_SPAN = 0.00605, (0.277, 0.456)
"""The iris of the generic eye: radius in metres, and from where to where it reaches in its picture, in half
widths.
"""
RING = (0.55, 0.85)
"""Between pupil and dark rim, in radii of the iris."""
EYE_SHOWN = (0.50, 0.43, 0.42)
"""Light that the clients show of an iris for a light of 1 in its picture; measured on the packaged heads."""
HAIR_POWER, HAIR_FACTOR = 1.5, 1.76
"""Luminance in the picture of hair = factor * (luminance shown) ^ power; measured likewise."""
CLOTH_FACTOR = 1.3
"""Light in the picture of cloth for a light of 1 shown; measured likewise."""
SQUARE = 0.3
"""Cosine between the surface and the way to the camera from which on something is seen squarely."""
MOST_CHANGED = 12.0
"""A channel of a picture is made at most so many times lighter or darker."""
BRIGHT = 0.6
"""Of the pixels of an iris, the darkest such share: the rest is the lamp's reflection."""
FEWEST = 40
"""Pixels that make a colour."""
LIKE_SKIN, LIKE_BACKDROP = 0.45, 0.35
"""Log distance in colour up to which a pixel over the hair is rather skin, or what is behind the head."""


def dressed(head: Head, generic: Head, photos: Mapping[str, Photo]) -> Head:
    """The head with eyes, hair and clothes recoloured after the photos, as far as they show them."""
    parts = []
    for part in head.parts:
        if part.name.startswith("eye") and "front" in photos:
            part = _with_iris(part, head, photos["front"])
        elif part.name.startswith("hair"):
            part = _with_hair_colour(part, head, photos)
        elif part.name.startswith("shirt") and "front" in photos:
            part = _with_cloth_colour(part, head, {"front": photos["front"]})
        elif part.name == "lashes":
            part = _without_brows(part, generic)
        parts.append(part)
    return replace(head, parts=tuple(parts))


def iris_colour(head: Head, side: str, front: Photo) -> Floats | None:
    """The light (3,) of an iris in the front photo; None where it cannot be told."""
    pupil = np.array([head.fdp["3.5" if side == "l" else "3.6"]])
    grown = np.ptp(head.part(f"eye_{side}").positions[:, 0]) / (2 * GENERIC_BALL_M)
    x, y = front.camera.project(pupil)[0]
    radius = IRIS_M * grown * front.camera.scale
    height, width = front.pixels.shape[:2]
    rows, columns = np.mgrid[:height, :width]
    far = np.hypot(columns + 0.5 - x, rows + 0.5 - y) / max(radius, 1e-6)
    ring = (far > RING[0]) & (far < RING[1]) & (rows + 0.5 > y - 0.2 * radius)
    if ring.sum() < FEWEST:
        return None
    light = linear(front.pixels[ring])
    level = light @ LUMINANCE
    colour: Floats = np.median(light[level <= np.quantile(level, BRIGHT)], axis=0)
    return colour


CHEEKS = ("5.3", "5.4", "9.12")
"""Feature points where there is skin."""
GENERIC_BALL_M = 0.0150
"""Radius of the generic eyeball."""


def _with_iris(part: Part, head: Head, front: Photo) -> Part:
    colour = iris_colour(head, part.name[-1], front)
    if colour is None or part.material.texture is None:
        return part
    light, kind = _light(part.material.texture)
    rows, columns = np.mgrid[-1 : 1 : len(light) * 1j, -1 : 1 : light.shape[1] * 1j]
    far = np.hypot(columns, rows)
    ring = (far > IRIS_SPAN[0] + 0.3 * np.ptp(IRIS_SPAN)) & (far < IRIS_SPAN[1] - 0.2 * np.ptp(IRIS_SPAN))
    factor = _change(colour / np.array(EYE_SHOWN), np.median(light[ring][:, :3], axis=0))
    share = 1 - smoothstep(IRIS_SPAN[1], IRIS_SPAN[1] * 1.06, far)
    light[..., :3] *= 1 + share[..., None] * (factor - 1)
    return _with_picture(part, light, kind)


def colour_under(head: Head, part: Part, photos: Mapping[str, Photo]) -> Floats | None:
    """The light (3,) of hair or clothes in the photos: what lies under that part there and is neither like
    the skin nor like what is behind the head; None where nothing is left.
    """
    found = []
    for photo in photos.values():
        light = linear(ndimage.uniform_filter(photo.pixels, (3, 3, 0)))
        under, skin = (_pixels(light, photo, places) for places in (_facing(part, photo), _cheeks(head)))
        backdrop = np.concatenate([light[:8].reshape(-1, 3), light[:, :4].reshape(-1, 3)])
        unlike = _gap(under, np.median(backdrop, axis=0)) > LIKE_BACKDROP
        if len(skin):
            unlike &= _gap(under, np.median(skin, axis=0)) > LIKE_SKIN
        found.append(under[unlike])
    pixels = np.concatenate(found) if found else np.zeros((0, 3))
    if len(pixels) < FEWEST:
        return None
    colour: Floats = np.median(pixels, axis=0)
    return colour


def _facing(part: Part, photo: Photo) -> NDArray[np.float64]:
    """Vertices of a part that face the camera: (n, 3)."""
    places = part.positions.astype(np.float64)
    away = photo.camera.position - places
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    square: NDArray[np.float64] = places[(part.normals * away).sum(1) > SQUARE]
    return square


def _cheeks(head: Head) -> NDArray[np.float64]:
    return np.array([head.fdp[name] for name in CHEEKS if name in head.fdp], np.float64).reshape(-1, 3)


def _pixels(light: Floats, photo: Photo, places: NDArray[np.float64]) -> Floats:
    """What a photo has at places (n, 3), as far as they are in it: (k, 3)."""
    at = np.floor(photo.camera.project(places)).astype(np.int64)
    inside = ((at >= 0) & (at < (light.shape[1], light.shape[0]))).all(1)
    found: Floats = light[at[inside, 1], at[inside, 0]]
    return found


def _gap(light: Floats, other: Floats) -> Floats:
    """(n,): how different colours are, in logs of their channels."""
    gap: Floats = np.abs(np.log(np.maximum(light, 0.004)) - np.log(np.maximum(other, 0.004))).max(-1)
    return gap


def _with_hair_colour(part: Part, head: Head, photos: Mapping[str, Photo]) -> Part:
    colour = colour_under(head, part, photos)
    if colour is None:
        return part
    level = float(colour @ LUMINANCE)
    return _recoloured(part, colour * HAIR_FACTOR * level ** (HAIR_POWER - 1))


def _with_cloth_colour(part: Part, head: Head, photos: Mapping[str, Photo]) -> Part:
    colour = colour_under(head, part, photos)
    return part if colour is None else _recoloured(part, CLOTH_FACTOR * colour)


def _recoloured(part: Part, wanted: Floats) -> Part:
    """The part with its picture brought to another colour (3,) on the whole."""
    if part.material.texture is None:
        return part
    light, kind = _light(part.material.texture)
    shown = light[..., 3] > 0.5 if light.shape[2] == 4 else np.ones(light.shape[:2], bool)
    light[..., :3] *= _change(wanted, np.median(light[shown][:, :3], axis=0))
    return _with_picture(part, light, kind)


def _without_brows(part: Part, generic: Head) -> Part:
    """Lashes alone: the photo's own brows are in the skin's picture."""
    high = generic.part(part.name).positions[:, 1]
    border = (generic.fdp["3.13"][1] + generic.fdp["4.1"][1]) / 2
    lashes = (high[part.triangles] < border).all(1)
    return replace(part, triangles=part.triangles[lashes])


def _change(wanted: Floats, present: Floats) -> Floats:
    factor: Floats = np.clip(wanted / np.maximum(present, 1e-4), 1 / MOST_CHANGED, MOST_CHANGED)
    return factor


def _light(image: Image) -> tuple[Floats, str]:
    """(h, w, 3 or 4): light, and alpha as it is, 0..1; and the format."""
    with Picture.open(io.BytesIO(image.data)) as picture:
        kind = str(picture.format)
        clear = "A" in picture.getbands() or "transparency" in picture.info
        pixels = np.asarray(picture.convert("RGBA" if clear else "RGB"))
    light = linear(pixels[..., :3])
    return (np.concatenate([light, pixels[..., 3:] / 255], 2) if clear else light), kind


def _with_picture(part: Part, light: Floats, kind: str) -> Part:
    pixels = encoded(light[..., :3])
    if light.shape[2] == 4:
        pixels = np.concatenate([pixels, np.rint(255 * light[..., 3:]).astype(np.uint8)], 2)
    out = io.BytesIO()
    picture = Picture.fromarray(pixels)
    if kind == "JPEG":
        picture.save(out, kind, quality=90, subsampling=0)
    else:
        picture.save(out, "PNG", optimize=True)
    image = Image(out.getvalue(), "image/jpeg" if kind == "JPEG" else "image/png")
    return replace(part, material=replace(part.material, texture=image))
