"""Draws the feature points of a head, with their names, over pictures of it.

python tools/fdp_chart.py --head fapstream/assets/heads/generic.glb --out charts
writes one picture a panel, front.png and so on, and all.png.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image as Picture
from PIL import ImageDraw, ImageFont
from render_head import GENERIC, Renderer, View, matrices

from fapstream.head.gltf import read_head
from fapstream.head.mesh import Head

ARTICULATORS = ("teeth_upper", "teeth_lower", "tongue")
DOT, LINE, INK = (200, 20, 40), (40, 40, 40), (0, 0, 60)


@dataclass(frozen=True)
class Panel:
    """One picture: which points it shows, what it looks at (the mean of `about`), from where."""

    names: tuple[str, ...]
    about: tuple[str, ...]
    zoom: float
    yaw: float = 0.0
    pitch: float = 0.0
    parts: tuple[str, ...] = ()


def _group(number: int, points: str) -> tuple[str, ...]:
    return tuple(f"{number}.{point}" for point in points.split())


EYES = _group(3, "1 2 3 4 5 6 7 8 9 10 11 12 13 14")
NOSE = _group(9, "1 2 3 4 5 6 7 12 13 14 15")
LIPS = _group(2, "2 3 4 5 6 7 8 9") + _group(8, "1 2 3 4 5 6 7 8 9 10")
JAW = _group(2, "1 10 11 12 13 14")
EARS = _group(10, "1 3 5 7 9")
RIGHT_EAR = _group(10, "2 4 6 8 10")
INSIDE = _group(6, "1 2 3 4") + _group(9, "8 9 10 11")
PANELS = {
    "front": Panel(
        JAW + _group(4, "1 2 3 4 5 6") + _group(5, "1 2 3 4") + _group(11, "1 2 3 4 5")
        + _group(10, "1 2 5 6") + _group(7, "1"),
        ("9.3", "9.12"), 1.15,
    ),
    "profile": Panel(
        EARS + ("7.1", "11.1", "11.3", "11.4", "11.5", "11.6", "2.13", "2.11", "2.1", "2.10", "9.3", "9.12",
                "5.1", "5.3", "4.5", "3.7", "8.3"),
        ("10.1", "9.12"), 1.1, 88.0,
    ),
    "back": Panel(("11.4", "11.5", "11.6", "10.3", "10.4", "7.1"), ("11.6",), 1.1, 180.0),
    "mouth": Panel(LIPS, ("8.1", "8.2"), 4.6),
    "eyes": Panel(EYES, ("3.5", "3.6"), 2.9),
    "nose": Panel(NOSE, ("9.3", "9.12"), 4.2, 0.0, -12.0),
    "left-ear": Panel(EARS, ("10.1", "10.5"), 4.0, 75.0),
    "right-ear": Panel(RIGHT_EAR, ("10.2", "10.6"), 4.0, -75.0),
    "articulators": Panel(INSIDE, ("9.10", "6.2"), 4.6, 25.0, 18.0, ARTICULATORS),
}  # fmt: skip


def chart(head: Head, renderer: Renderer, panel: Panel) -> Picture.Image:
    """The picture of one panel; raises KeyError for a point the head has not."""
    target = tuple(float(c) for c in np.mean([head.fdp[name] for name in panel.about], 0))
    view = View(panel.yaw, panel.pitch, panel.zoom, target=target, parts=panel.parts)
    picture = renderer.picture(np.zeros(68, np.int16), view)
    at = {name: projected(head, view, name, picture.width) for name in panel.names}
    _write(ImageDraw.Draw(picture), at, picture.width)
    return picture


def charts(head: Head, size: int = 640) -> dict[str, Picture.Image]:
    """The picture of every panel, by its name. Every point that the head has is on one of them."""
    forgotten = set(head.fdp) - {name for panel in PANELS.values() for name in panel.names}
    assert not forgotten, f"on no panel: {sorted(forgotten)}"
    renderer = Renderer(head, size)
    return {name: chart(head, renderer, panel) for name, panel in PANELS.items()}


def sheet(head: Head, size: int = 640) -> Picture.Image:
    """All panels on one picture."""
    whole = Picture.new("RGB", (3 * size, 3 * size))
    for number, picture in enumerate(charts(head, size).values()):
        whole.paste(picture, (number % 3 * size, number // 3 * size))
    return whole


def projected(head: Head, view: View, name: str, size: int) -> np.ndarray:
    """Pixel (2,) of a feature point."""
    placed, projection = matrices(head, view)
    clip = projection @ placed @ np.append(np.array(head.fdp[name]), 1.0)
    return np.array([(clip[0] / clip[3] + 1) / 2 * size, (1 - clip[1] / clip[3]) / 2 * size])


def _write(draw: ImageDraw.ImageDraw, at: dict[str, np.ndarray], size: int) -> None:
    """Dots, and labels pushed away from the dots and from one another."""
    font = ImageFont.load_default(size // 40)
    dots = np.array(list(at.values()))
    away = dots - dots.mean(0)
    away /= np.maximum(np.linalg.norm(away, axis=1, keepdims=True), 1e-9)
    labels = dots + away * size * 0.045
    for _ in range(200):
        others = np.concatenate([labels, dots])
        gap = (labels[:, None] - others[None]) / (1.0, 0.55)
        near = np.linalg.norm(gap, axis=2)
        push = gap / np.maximum(near, 1e-6)[..., None] * np.clip(size * 0.042 - near, 0, None)[..., None]
        labels += 0.2 * push.sum(1)
        labels = np.clip(labels, size * 0.03, size * 0.97)
    for (name, dot), label in zip(at.items(), labels, strict=True):
        draw.line([*dot, *label], fill=LINE, width=1)
        draw.ellipse([*(dot - 3), *(dot + 3)], fill=DOT)
        draw.text(tuple(label), name, fill=INK, font=font, anchor="mm", stroke_width=3, stroke_fill="white")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--head", type=Path, default=GENERIC)
    parser.add_argument("--size", type=int, default=640)
    parser.add_argument("--out", type=Path, required=True, help="the folder to write to")
    options = parser.parse_args()
    head = read_head(options.head.read_bytes(), str(options.head))
    options.out.mkdir(parents=True, exist_ok=True)
    for name, picture in charts(head, options.size).items():
        picture.save(options.out / f"{name}.png")
    sheet(head, options.size).save(options.out / "all.png")


if __name__ == "__main__":
    main()
