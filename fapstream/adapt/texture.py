"""The skin's picture from photos: every texel from where its place on the head is seen.

Sarris, Grammalidis, Strintzis, section 2.3. The head's own texture coordinates take the place of the paper's
cylinder: they are a cylinder that favours the face. Where both photos see a texel they are mixed by how
squarely each sees it, T = k front + (1 - k) profile; the paper's k = |nz| / (|nx| + |nz|) is that of
cameras at right angles. Here k is that of the real cameras, smooth, and 0/0 nowhere. The profile is
calibrated to the front (equations 15, 16), and serves mirrored for the other side. What no photo sees is
the generic skin in the person's colours.

Before that, light is taken out of the photos as far as it follows from how the skin faces: the clients
light the head again, and light twice would be seen.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image as Picture

from fapstream.adapt.blend import blurred, carried_on, joined
from fapstream.adapt.layers import Canvas, Layer, Photo, seen, without_light
from fapstream.adapt.shading import calibration, encoded, linear, unrendered
from fapstream.head.mesh import Head, Image, Part

Floats = NDArray[np.floating[Any]]

HIDING = ("skin", "eye_l", "eye_r")
"""Parts that hide one another in photos. Hair is the person's own there, not the head's."""
MIRRORED = 0.5
"""How much the mirrored profile counts beside what was seen."""
QUALITY = 90
REACH = 30.0
"""Texels over which the generic skin takes the person's where nothing was seen."""
CALIBRATED = 0.3
"""Trust in both photos from which on texels are compared."""


def paint_skin(head: Head, generic: Head, photos: Mapping[str, Photo]) -> Image:
    """The picture of the skin of `head`, which was made from `generic`, from photos by view."""
    skin, old = head.part("skin"), generic.part("skin")
    canvas = Canvas.of(skin, old)
    parts = {part.name: part for part in head.parts if part.name in HIDING}
    layers = [_flat(canvas, seen(canvas, photo, parts)) for photo in photos.values()]
    if len(layers) > 1:
        layers[1:] = [_calibrated(layers[0], layers[1])]
        layers.append(_calibrated(layers[0], _mirrored(canvas, layers[1])))
    found = joined(
        [canvas.picture(row.light) for row in layers], [canvas.picture(_say(row)) for row in layers]
    )
    trust = canvas.picture(1 - np.prod([1 - row.trust for row in layers], axis=0))
    return _image(_completed(canvas, found, trust, _picture(old)))


def _flat(canvas: Canvas, layer: Layer) -> Layer:
    flat = without_light(canvas, layer)
    return replace(flat, light=unrendered(flat.light))


def _say(layer: Layer) -> Floats:
    """What weighs a layer among others: trust, and how squarely it is seen."""
    say: Floats = layer.trust * np.clip(layer.facing, 0, 1)
    return say


def _calibrated(front: Layer, other: Layer) -> Layer:
    """`other` in the colours of the front, told from what both see."""
    both = np.minimum(front.trust, other.trust)
    if (both > CALIBRATED).sum() < 100:
        both = front.trust * other.trust
    factor, shift = calibration(front.light, other.light, both * (both > CALIBRATED))
    light = other.light * factor.astype(np.float32) + shift.astype(np.float32)
    return replace(other, light=np.maximum(light, 0))


def _mirrored(canvas: Canvas, layer: Layer) -> Layer:
    """The other side of the head, as texture coordinates mirror it."""
    rows = np.concatenate([layer.light, layer.trust[:, None], layer.facing[:, None]], 1)
    flipped = canvas.texels(canvas.picture(rows)[:, ::-1])
    return Layer(flipped[:, :3], MIRRORED * flipped[:, 3], flipped[:, 4])


def _completed(canvas: Canvas, found: Floats, trust: Floats, generic: Floats) -> Floats:
    """(n, n, 3): what was found, and elsewhere the generic skin in its colours."""
    weights = canvas.texels(trust) * (canvas.texels(trust) > CALIBRATED)
    means = [weights @ canvas.texels(picture) for picture in (found, generic)]
    base = generic * (means[0] / np.maximum(means[1], 1e-6))
    near = np.minimum(2 * blurred(trust, REACH), 1)
    change = carried_on(found - base, trust) * np.maximum(near, trust)[..., None]
    picture = np.maximum(base + change, 0)
    covered = canvas.picture(np.ones(len(canvas.places)))
    return carried_on(picture, covered)


def _picture(skin: Part) -> Floats:
    """(n, n, 3): the skin's own picture as light, at the canvas' size."""
    if skin.material.texture is None:
        return np.broadcast_to(np.array(skin.material.color[:3]), (1024, 1024, 3)).copy()
    with Picture.open(io.BytesIO(skin.material.texture.data)) as image:
        pixels = np.asarray(image.convert("RGB").resize((1024, 1024), Picture.Resampling.BILINEAR))
    return linear(pixels)


def _image(light: Floats) -> Image:
    out = io.BytesIO()
    Picture.fromarray(encoded(light)).save(out, "JPEG", quality=QUALITY, subsampling=0, optimize=True)
    return Image(out.getvalue(), "image/jpeg")
