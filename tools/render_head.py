"""Renders a head file with given FAP values to a PNG, without a display, as the viewer does.

python tools/render_head.py --fap 3=400 --fap 5=-300 --yaw 30 --out face.png
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from PIL import Image as Picture

from fapstream.head.gltf import read_head
from fapstream.head.mesh import Head
from fapstream.viewer import camera
from fapstream.viewer.canvas import Studio
from fapstream.viewer.look import load_look

GENERIC = Path(__file__).parents[1] / "fapstream/assets/heads/generic.glb"
OVERSAMPLED = 2
"""Pictures are drawn so many times larger and reduced."""


@dataclass(frozen=True)
class View:
    """Where the picture is taken from: degrees, and how many times closer than the portrait."""

    yaw: float = 0.0
    pitch: float = 0.0
    zoom: float = 1.0
    mouth: bool = False
    target: tuple[float, float, float] | None = None
    """Metres; what to look at instead of the portrait or the mouth."""
    parts: tuple[str, ...] = ()
    """The parts to draw; none named is all."""

    def of(self, head: Head) -> camera.View:
        """The viewer's own."""
        target = self.target or (head.mouth.center if self.mouth else None)
        return camera.View(self.yaw, self.pitch, self.zoom, target)


class Renderer:
    """One head, many pictures."""

    def __init__(self, head: Head, size: int) -> None:
        self.head, self.size = head, size
        self._studios: dict[tuple[str, ...], Studio] = {}

    def picture(self, values: np.ndarray, view: View) -> Picture.Image:
        """The face under one FAP frame (68,)."""
        if view.parts not in self._studios:
            drawn = self.size * OVERSAMPLED
            self._studios[view.parts] = Studio(only(self.head, view.parts), (drawn, drawn), samples=0)
        pixels = self._studios[view.parts].picture(values, view.of(self.head))
        image = Picture.fromarray(np.ascontiguousarray(pixels[..., :3]))
        return image.resize((self.size, self.size), Picture.Resampling.LANCZOS)


def only(head: Head, names: tuple[str, ...]) -> Head:
    """The head with these parts alone; none named is all."""
    if not names:
        return head
    turns = [
        replace(
            turn,
            parts=None if turn.parts is None else tuple(name for name in turn.parts if name in names),
            weights={name: weights for name, weights in turn.weights.items() if name in names},
        )
        for turn in head.turns
    ]
    return replace(
        head,
        parts=tuple(part for part in head.parts if part.name in names),
        fat=tuple(entry for entry in head.fat if entry.part in names),
        turns=tuple(turns),
    )


def matrices(head: Head, view: View) -> tuple[np.ndarray, np.ndarray]:
    """World to eye, and eye to clip space, 4x4 for column vectors."""
    lens = camera.lens(head.camera, load_look().fov, 1.0, view.of(head))
    return lens.view, lens.projection


def fap_frame(settings: list[str]) -> np.ndarray:
    """int32 (68,) from `fap=value` strings."""
    values = np.zeros(68, np.int32)
    for setting in settings:
        fap, _, value = setting.partition("=")
        values[int(fap) - 1] = int(value)
    return values


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--head", type=Path, default=GENERIC)
    parser.add_argument("--fap", action="append", default=[], metavar="N=VALUE")
    parser.add_argument("--yaw", type=float, default=0.0, help="camera to the subject's left, degrees")
    parser.add_argument("--pitch", type=float, default=0.0)
    parser.add_argument("--zoom", type=float, default=1.0)
    parser.add_argument("--mouth", action="store_true", help="look at the mouth rather than the portrait")
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    head = read_head(options.head.read_bytes(), str(options.head))
    view = View(options.yaw, options.pitch, options.zoom, options.mouth)
    Renderer(head, options.size).picture(fap_frame(options.fap), view).save(options.out)


if __name__ == "__main__":
    main()
