"""How well a head fits its photos, as one HTML page with everything in it."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping
from html import escape

import numpy as np
from numpy.typing import NDArray
from PIL import Image as Picture
from PIL import ImageDraw

from fapstream.adapt.person import Fit
from fapstream.adapt.points import feature_points
from fapstream.adapt.session import wireframe
from fapstream.head.mesh import Head

Floats = NDArray[np.float64]
Pixels = NDArray[np.uint8]

SHOWN = 900
"""Pixels of a photo's longer side in the report."""
FAR_SHARE = 0.02
"""Of the distance between the eyes: points that are further off are marked."""
MESH, SEEN, FITTED = (120, 200, 255, 90), (80, 255, 120, 255), (255, 90, 60, 255)

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 1180px; margin: 2rem auto; padding: 0 1rem }
body { background: #fff; color: #1b2430 }
h1 { font-size: 1.5rem } h2 { font-size: 1.1rem; margin-top: 2rem }
.row { display: flex; flex-wrap: wrap; gap: 12px } figure { margin: 0; flex: 1 1 200px }
img { width: 100%; border-radius: 10px; display: block } figcaption { color: #5d6b7c; font-size: .85rem }
table { border-collapse: collapse } td, th { padding: 2px 14px 2px 0; text-align: left }
.n { text-align: right; font-variant-numeric: tabular-nums } .far { color: #c0392b; font-weight: 600 }
@media (prefers-color-scheme: dark) { body { background: #12151a; color: #e8ecf1 } }
"""


def report(
    generic: Head, head: Head, fit: Fit, photos: Mapping[str, Pixels], views: Mapping[str, Pixels]
) -> str:
    """The page. `photos` by front and profile, `views`: pictures of the head by what they show."""
    overlays = {
        f"{view}: points as given in green, as fitted in red": overlay(generic, fit, view, photos[view])
        for view in fit.located.sights
        if view in photos
    }
    skin = head.part("skin").material.texture
    pictures = {}
    if skin is not None:
        pictures["its skin"] = np.asarray(Picture.open(io.BytesIO(skin.data)).convert("RGB"))
    body = [
        f"<h1>{escape(head.name)}</h1>",
        _summary(head, fit),
        *_section("The fit over the photos", overlays),
        *_section("The head", {**views, **pictures}),
        "<h2>Feature points</h2>",
        _table(fit),
    ]
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{escape(head.name)}</title>'
        f"<style>{STYLE}</style><body>{''.join(body)}</body></html>\n"
    )


def overlay(generic: Head, fit: Fit, view: str, photo: Pixels) -> Pixels:
    """The photo with the fitted mesh, the points that were given, and lines to where the head has them."""
    vertices, edges = wireframe(generic)
    camera = fit.located.sights[view].camera
    share = min(1.0, SHOWN / max(photo.shape[:2]))
    mesh = share * camera.project(fit.skin[vertices])
    seen = share * fit.located.sights[view].seen
    fitted = share * fit.mesh(_places(generic, fit.located.names))[view]
    size = (round(photo.shape[1] * share), round(photo.shape[0] * share))
    picture = Picture.fromarray(photo).resize(size, Picture.Resampling.LANCZOS)
    pen = ImageDraw.Draw(picture, "RGBA")
    for a, b in edges.tolist():
        pen.line([*mesh[a], *mesh[b]], fill=MESH)
    for given, there in zip(seen, fitted, strict=True):
        if np.isfinite(given).all():
            pen.line([*given, *there], fill=FITTED, width=2)
            pen.ellipse([*(given - 3), *(given + 3)], outline=SEEN, width=2)
    return np.asarray(picture.convert("RGB"))


def _places(generic: Head, names: tuple[str, ...]) -> Floats:
    table = feature_points()
    return np.array([table[name].place or generic.fdp[name] for name in names], float)


def _summary(head: Head, fit: Fit) -> str:
    rows = []
    for view, sight in fit.located.sights.items():
        off = _lengths(fit, view)
        figures = (
            f"{np.nanmean(off):.2f} px mean", f"{np.nanmax(off):.2f} px at most",
            f"{np.nanmean(off**2):.2f} px&sup2; mean square",
            f"camera at {1 / max(sight.camera.closeness, 1e-3):.2f} m",
        )  # fmt: skip
        cells = "".join(f"<td class=n>{figure}</td>" for figure in figures)
        rows.append(f"<tr><th>{view}</th>{cells}</tr>")
    units = ", ".join(f"{name} {1000 * value:.1f} mm" for name, value in head.fapu.as_dict().items())
    return f"<table>{''.join(rows)}</table><p>FAPU, at the size of the generic head: {units}</p>"


def _lengths(fit: Fit, view: str) -> Floats:
    lengths: Floats = np.linalg.norm(fit.located.errors[view], axis=1)
    return lengths


def _table(fit: Fit) -> str:
    views = list(fit.located.sights)
    heads = "".join(f"<th class=n>{view}</th>" for view in views)
    lines = [f"<table><tr><th>point</th><th></th>{heads}</tr>"]
    for i, name in enumerate(fit.located.names):
        cells = "".join(_cell(fit, view, i) for view in views)
        lines.append(f"<tr><td>{name}</td><td>{escape(feature_points()[name].title)}</td>{cells}</tr>")
    return "".join([*lines, "</table>"])


def _cell(fit: Fit, view: str, row: int) -> str:
    off = _lengths(fit, view)[row]
    if not np.isfinite(off):
        return "<td class=n>&ndash;</td>"
    far = " far" if off > FAR_SHARE * fit.located.eye_distance(view) else ""
    return f'<td class="n{far}">{off:.1f} px</td>'


def _section(title: str, pictures: Mapping[str, Pixels]) -> list[str]:
    figures = [
        f'<figure><img alt="{escape(what)}" src="{_data(picture)}">'
        f"<figcaption>{escape(what)}</figcaption></figure>"
        for what, picture in pictures.items()
    ]
    return [f"<h2>{title}</h2><div class=row>", *figures, "</div>"] if figures else []


def _data(pixels: Pixels) -> str:
    out = io.BytesIO()
    Picture.fromarray(pixels).save(out, "JPEG", quality=88)
    return "data:image/jpeg;base64," + base64.b64encode(out.getvalue()).decode("ascii")
