"""The skin's colour: two pigments, blood and melanin, laid on a tone; lips, brows, stubble, baked shade."""

from __future__ import annotations

import numpy as np

from fapstream.head.mesh import Material
from head_parts.assemble import Piece
from head_parts.brows import brow_shade
from head_parts.face_canvas import Canvas, canvas_of, grain, noise
from head_parts.face_relief import age_lines, crease, furrows, normal_map, pores
from head_parts.hair import Scalp
from head_parts.paint import encode, mix, smooth
from head_parts.people import Person
from head_parts.source import Source
from head_parts.surface import Array

BLOOD = np.array([0.10, 0.62, 0.50])
MELANIN = np.array([0.42, 0.74, 0.98])
"""How much each pigment takes from red, green and blue."""


def skin_material(source: Source, scalp: Scalp, skin: Piece, others: list[Piece], person: Person) -> Material:
    canvas = canvas_of(source, scalp, skin, others)
    blood, melanin = _blood(canvas, person), _melanin(canvas, person)
    colour = np.array(person.skin.tone) * np.exp(-blood[..., None] * BLOOD - melanin[..., None] * MELANIN)
    colour = mix(colour, _lips(canvas, person), 0.9 * smooth(0.15, 0.8, canvas.lips))
    colour = mix(colour, np.array(person.brows.colour), 0.45 * person.brows.weight * brow_shade(canvas))
    colour = mix(colour, np.array(person.hair.root), _beard(canvas, person))
    colour = mix(colour, np.array(person.hair.root) * 1.1, _scalp(canvas))
    colour *= 1 - canvas.seam[..., None] * np.array([0.22, 0.38, 0.38])
    colour *= _shade(canvas.open) * (1 - 0.10 * pores(canvas))[..., None]
    return Material(
        "skin", texture=encode(colour, quality=77), roughness=0.55, normal=normal_map(canvas, person)
    )


def _blood(canvas: Canvas, person: Person) -> Array:
    """Where the skin is redder: cheeks, nose, ears, chin, lids, corners of the eyes; and blotches."""
    ex, ey, _ = canvas.eye
    mouth = canvas.mouth[1]
    cheeks = 0.19 * canvas.spot(ex + 0.15, ey - 0.44, 0.25, 0.20)
    nose = 0.20 * canvas.spot(0, ey - 0.36, 0.12, 0.11) + 0.10 * canvas.spot(0.12, ey - 0.45, 0.06, 0.06)
    other = 0.06 * canvas.spot(0, mouth - 0.34, 0.16, 0.12) + 0.22 * canvas.ears
    lids = 0.15 * canvas.spot(ex, ey, 0.21, 0.085) + 0.10 * canvas.spot(ex - 0.17, ey - 0.05, 0.06, 0.08)
    blotches = (
        0.030 * noise(canvas.at, 5, 1) + 0.028 * noise(canvas.at, 19, 2) + 0.02 * noise(canvas.at, 55, 3)
    )
    folds = 0.09 * person.skin.lines * age_lines(canvas) + 0.20 * crease(canvas, person.eyes.crease)
    return np.asarray((cheeks + nose + other + lids + blotches) * person.skin.blush + folds)


def _melanin(canvas: Canvas, person: Person) -> Array:
    """Where it is darker: sockets, under the eyes, freckles and spots."""
    ex, ey, _ = canvas.eye
    skin = person.skin
    sockets = 0.10 * canvas.spot(ex, ey + 0.07, 0.22, 0.09) + 0.11 * canvas.spot(
        ex - 0.06, ey - 0.14, 0.17, 0.05
    )
    tan = 0.05 * smooth(ey + 0.2, ey + 0.6, canvas.at[..., 1]) * canvas.front
    spots = smooth(1.5, 2.3, noise(canvas.at, 30, 31)) * smooth(-0.4, 0.8, noise(canvas.at, 4, 32))
    where = 0.3 + canvas.spot(ex, ey - 0.3, 0.4, 0.3) + 0.6 * canvas.spot(0.1, ey + 0.45, 0.5, 0.25)
    fine = 0.018 * noise(canvas.at, 12, 33) + 0.022 * grain(len(canvas.at), 1.0, 3.0, 34)
    lines = 0.10 * skin.lines * age_lines(canvas) + 0.10 * crease(canvas, person.eyes.crease)
    return np.asarray(sockets + tan + 0.55 * skin.freckles * spots * where + fine + lines)


def _lips(canvas: Canvas, person: Person) -> Array:
    """Redder towards the line where they meet, paler at the rim, darker in the furrows."""
    gap = np.abs(canvas.at[..., 1] - canvas.mouth[1])
    middle = smooth(0.085, 0.0, gap)
    colour = np.array(person.skin.lip) * (1 + 0.045 * furrows(canvas))[..., None]
    colour = mix(
        colour, np.array(person.skin.tone) * (0.93, 0.80, 0.78), 0.35 * smooth(0.9, 0.5, canvas.lips)
    )
    return np.asarray(
        colour
        * np.exp(-middle[..., None] * (0.10, 0.22, 0.20))
        * (1 + 0.03 * noise(canvas.at, 22, 41)[..., None])
    )


def _beard(canvas: Canvas, person: Person) -> Array:
    """Coverage by shaven hairs, and the grey they make together."""
    if person.skin.stubble == 0:
        return np.zeros(canvas.open.shape)
    _, ey, _ = canvas.eye
    side, y = np.abs(canvas.at[..., 0]), canvas.at[..., 1]
    mouth = canvas.mouth[1]
    jaw = smooth(
        mouth + 0.02 + 0.55 * np.clip(side - 0.28, 0, 1), mouth - 0.12 + 0.75 * np.clip(side - 0.30, 0, 1), y
    )
    lip = np.exp(-(((y - mouth - 0.13) / 0.055) ** 2)) * smooth(0.30, 0.20, side)
    corner = np.exp(-(((side - 0.27) / 0.055) ** 2)) * smooth(mouth + 0.15, mouth + 0.05, y)
    neck = smooth(mouth - 0.95, mouth - 0.65, y)
    burns = np.exp(-(((side - 0.70) / 0.09) ** 2)) * smooth(ey - 0.05, ey - 0.2, y)
    region = np.clip(np.maximum.reduce([jaw, lip, corner, burns]), 0, 1) * neck
    region *= (
        smooth(0.45, 0.80, canvas.at[..., 2] - 0.35 * (y - mouth)) * (1 - canvas.lips) * (1 - canvas.ears)
    )
    region *= 1 - 0.75 * np.exp(-((side / 0.11) ** 2) - ((y - mouth + 0.145) / 0.025) ** 2)
    dots = smooth(0.5, 1.5, grain(len(canvas.at), 0.55, 1.4, 43))
    return np.asarray(person.skin.stubble * region * (0.25 + 0.65 * dots))


def _scalp(canvas: Canvas) -> Array:
    """Hair that shows through at its edge, as short strokes."""
    inside = canvas.scalp.inside(canvas.at) * (1 - canvas.ears)
    strokes = 0.014 * noise(canvas.at * (1.0, 0.22, 1.0), 45, 6) + 0.012 * noise(
        canvas.at * (1.0, 0.3, 1.0), 90, 7
    )
    edge = smooth(-0.035, 0.04, inside + strokes) * smooth(-0.06, -0.02, inside)
    return np.asarray(0.9 * edge * (1 - smooth(0.1, 0.6, canvas.ears)))


def _shade(light: Array) -> Array:
    """Occluded skin is darker and redder, (..., 3)."""
    open_ = np.clip(light * 1.12, 0.05, 1)[..., None]
    return np.asarray(open_ ** np.array([0.40, 0.54, 0.58]))
