"""A sheet of pictures that shows photos and the heads made from them, from five sides and talking.

python tools/adapted_sheet.py --row front.jpg profile.jpg me.glb --row front.jpg - other.glb --out sheet.jpg
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from PIL import Image as Picture
from PIL import ImageOps
from render_head import Renderer, View

from fapstream.fap import expressions, visemes
from fapstream.head.gltf import read_head

SIDES = (0.0, 45.0, 90.0, -45.0)
OPEN, GLAD = 10, 0.6
"""The viseme of the talking picture, and how much joy goes with it."""
TALKING = View(yaw=12.0)


def row(front: Path, profile: Path | None, head: Path, tile: int) -> list[Picture.Image]:
    """Two photos, four sides, and the head talking."""
    photos = [_square(path, tile) for path in (front, profile)]
    renderer = Renderer(read_head(head.read_bytes(), str(head)), tile)
    rest = np.zeros(68)
    turned = [renderer.picture(rest, View(yaw=yaw)) for yaw in SIDES]
    talking = np.rint(visemes()[OPEN] + GLAD * expressions()["joy"]).astype(np.int32)
    return [*photos, *turned, renderer.picture(talking, TALKING)]


def _square(path: Path | None, tile: int) -> Picture.Image:
    if path is None:
        return Picture.new("RGB", (tile, tile), (225, 229, 233))
    with Picture.open(path) as picture:
        return ImageOps.fit(
            ImageOps.exif_transpose(picture).convert("RGB"), (tile, tile), centering=(0.5, 0.2)
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument(
        "--row", nargs=3, action="append", required=True, metavar=("FRONT", "PROFILE", "HEAD"),
        help="photos and the head made from them; - for no profile",
    )  # fmt: skip
    parser.add_argument("--tile", type=int, default=220, help="pixels a picture (default %(default)s)")
    parser.add_argument("--out", type=Path, required=True)
    options = parser.parse_args()
    rows = [
        row(Path(front), None if profile == "-" else Path(profile), Path(head), options.tile)
        for front, profile, head in options.row
    ]
    sheet = Picture.new("RGB", (options.tile * len(rows[0]), options.tile * len(rows)))
    for y, pictures in enumerate(rows):
        for x, picture in enumerate(pictures):
            sheet.paste(picture, (x * options.tile, y * options.tile))
    sheet.save(options.out, quality=88)


if __name__ == "__main__":
    main()
