"""Renders everything a head can do to contact sheets and a page that shows them.

tools/gallery [--out build/gallery] [--head generic --head F.glb]
"""

from __future__ import annotations

import argparse
import html
import math
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import fdp_chart
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from fapstream.cli import main as fapstream
from fapstream.fap import EXPRESSIONS, N_VISEMES, expressions, faps, limits, visemes
from fapstream.fap.tables import Fap
from fapstream.head.gltf import read_head
from fapstream.head.mesh import Head
from fapstream.records import N_FAPS
from fapstream.server import packaged_heads
from fapstream.viewer.camera import PORTRAIT, View
from fapstream.viewer.canvas import Studio
from fapstream.viewer.clip import read_clip

LABEL_PX = 22
OVERSAMPLED = 2
"""Pictures are drawn so many times larger and reduced."""

FROM_THE_SIDE = {3, 14, 16, 17, 18, 27, 28}
"""FAPs that move something forward."""
ANGLES = (("front", 0.0), ("three-quarter", 40.0), ("profile", 90.0))
SENTENCE = "Hello! I am made of sixty-eight numbers. \\:)600 Beautiful, is it not?"
STILLS = 12
WIDE_OPEN = 10
"""The viseme that lets the tongue be seen."""
WITH_JAW = {5: -1.3, 10: -1.1, 11: -1.1, 52: -1.25, 57: -0.9, 58: -0.9}
"""How the lower lip goes with FAP 3 (protocol/HEAD.md)."""
CORNERS = {6: 53, 7: 54, 12: 59, 13: 60, 53: 6, 54: 7, 59: 12, 60: 13}
"""The inner corners of the lips and the outer ones go together."""
JAW_FROM = -500
"""Below this it does not go alone."""
VISEME_PHONES = (
    "none", "p b m", "f v", "T D", "t d", "k g", "tS dZ S", "s z", "n l", "r", "A:", "e", "I", "Q", "U",
)  # fmt: skip
"""What each viseme of MPEG-4 stands for."""


@dataclass(frozen=True)
class Shot:
    """One picture of a sheet. `values`: FAPs (68,)."""

    label: str
    values: np.ndarray
    view: View = PORTRAIT


class Gallery:
    """Sheets of one head."""

    def __init__(self, name: str, head: Head, tile: int) -> None:
        self.name, self.head, self.tile = name, head, tile
        self.studio = Studio(head, (tile * OVERSAMPLED, tile * OVERSAMPLED))

    def views(self) -> Iterator[Shot]:
        """The neutral face and a smile from three sides."""
        for label, values in (("", still()), (", joy", expressions()["joy"])):
            for angle, yaw in ANGLES:
                yield Shot(f"{self.name}, {angle}{label}", values, View(yaw=yaw))

    def faps(self) -> Iterator[Shot]:
        """Each low-level FAP at both of its limits."""
        for row in faps()[2:]:
            for limit in limits()[row.fap - 1]:
                if limit:
                    values = still({row.fap: limit}) + company(row, limit)
                    yield Shot(f"{row.fap} {row.name} = {limit:.0f}", values, self.look_at(row))

    def look_at(self, row: Fap) -> View:
        """Close enough to see what the FAPs of a group move."""
        left, fdp = row.fap % 2 == 1, self.head.fdp
        mouth, eye, ear = (
            self.head.mouth.center,
            fdp["3.5" if left else "3.6"],
            fdp["10.1" if left else "10.2"],
        )
        close = {
            2: View(yaw=50.0 if row.fap in FROM_THE_SIDE else 0.0, zoom=2.0, target=mouth),
            3: View(yaw=70.0 if row.fap in FROM_THE_SIDE else 0.0, zoom=4.0, target=eye),
            4: View(zoom=1.6, target=fdp["9.3"]),
            5: View(yaw=20.0, zoom=1.6, target=fdp["9.3"]),
            6: View(yaw=20.0, zoom=3.0, target=mouth),
            8: View(zoom=2.0, target=mouth),
            9: View(yaw=25.0, zoom=2.5, target=fdp["9.3"]),
            10: View(yaw=65.0 if left else -65.0, zoom=2.0, target=ear),
        }
        return close.get(row.group, View(yaw=25.0))

    def visemes(self) -> Iterator[Shot]:
        """The 14 visemes, the mouth large."""
        view = View(yaw=20.0, zoom=2.0, target=self.head.mouth.center)
        for number in range(1, N_VISEMES):
            yield Shot(f"{number}: {VISEME_PHONES[number]}", visemes()[number], view)

    def expressions(self) -> Iterator[Shot]:
        """The 6 expressions from the front and from the side."""
        for yaw in (0.0, 35.0):
            for name in EXPRESSIONS:
                yield Shot(name, expressions()[name], View(yaw=yaw, zoom=1.3))

    def talk(self, rows: np.ndarray) -> Iterator[Shot]:
        """Stills of a talk, FAPs (n, 68), at even steps."""
        for k in np.linspace(0, len(rows) - 1, STILLS + 2)[1:-1].astype(int):
            yield Shot(f"{k / 25:.2f} s", rows[k])

    def sheet(self, shots: Sequence[Shot], columns: int) -> Image.Image:
        """All of them on one picture, each with its label below."""
        height = self.tile + LABEL_PX
        image = Image.new("RGB", (columns * self.tile, math.ceil(len(shots) / columns) * height), "white")
        draw, font = ImageDraw.Draw(image), ImageFont.load_default(14)
        for k, shot in enumerate(shots):
            x, y = k % columns * self.tile, k // columns * height
            pixels = np.ascontiguousarray(self.studio.picture(shot.values, shot.view)[..., :3])
            image.paste(
                Image.fromarray(pixels).resize((self.tile, self.tile), Image.Resampling.LANCZOS), (x, y)
            )
            draw.text((x + 6, y + self.tile + 2), shot.label, "black", font)
        return image


def company(row: Fap, value: float) -> np.ndarray:
    """FAPs (68,) without which this one is never seen: an open mouth, the jaw, the corner's twin."""
    if row.group == 6:
        return visemes()[WIDE_OPEN]
    if row.fap in CORNERS:
        return still({CORNERS[row.fap]: value})
    if row.fap not in WITH_JAW or value > JAW_FROM:
        return still()
    jaw = value / WITH_JAW[row.fap]
    return still({3: jaw, **{fap: share * jaw for fap, share in WITH_JAW.items() if fap != row.fap}})


def still(values: dict[int, float] | None = None) -> np.ndarray:
    """A frame (68,) of FAPs by number."""
    frame = np.zeros(N_FAPS)
    for fap, value in (values or {}).items():
        frame[fap - 1] = value
    return frame


def spoken(text: str) -> np.ndarray:
    """FAPs (n, 68) at 25 frames a second of a text said by the best voice there is."""
    with tempfile.TemporaryDirectory() as folder:
        fap, wav = Path(folder, "talk.fap"), Path(folder, "talk.wav")
        if fapstream(["say", text, "--fap", str(fap), "--wav", str(wav)]):
            raise SystemExit("the sentence could not be spoken")
        return np.array([frame.values for frame in read_clip(fap, wav).frames])


def sheets(gallery: Gallery, rows: np.ndarray, every_fap: bool) -> Iterator[tuple[str, Image.Image]]:
    """The pictures of one head by title."""
    large = Gallery(gallery.name, gallery.head, gallery.tile * 2)
    yield "Three sides", large.sheet(list(gallery.views()), 3)
    large.studio.close()
    yield "Speaking", gallery.sheet(list(gallery.talk(rows)), 6)
    yield "Visemes", gallery.sheet(list(gallery.visemes()), 7)
    yield "Expressions", gallery.sheet(list(gallery.expressions()), 6)
    yield "Feature points", fdp_chart.sheet(gallery.head)
    if every_fap:
        yield "Every FAP at its limits", gallery.sheet(list(gallery.faps()), 8)


def page(pictures: Sequence[tuple[str, str, str]]) -> str:
    """HTML that shows pictures: (head, title, file)."""
    rows = "\n".join(
        f"<h2>{html.escape(head)}: {html.escape(title)}</h2><img src='{file}' loading='lazy' alt=''>"
        for head, title, file in pictures
    )
    style = "body{font-family:sans-serif;margin:2em;background:#f4f4f4}img{max-width:100%}"
    return f"<!doctype html><meta charset='utf-8'><title>Gallery</title><style>{style}</style>{rows}\n"


def portraits(shots: Sequence[tuple[str, Shot]], tile: int) -> Image.Image:
    """A row of heads by name, each with one picture of its own and the label below."""
    row = Image.new("RGB", (len(shots) * tile, tile + LABEL_PX), "white")
    for k, (name, shot) in enumerate(shots):
        gallery = Gallery(*load(name), tile)
        row.paste(gallery.sheet([shot], 1), (k * tile, 0))
        gallery.studio.close()
    return row


def for_readme(folder: Path) -> None:
    """The three pictures that README.md shows."""
    close = View(yaw=12.0, zoom=1.4)
    cast = ("mei", "vera", "kofi", "generic", "vera", "mei")
    people = [
        ("generic", Shot("generic", still())),
        ("mei", Shot("mei", 0.6 * expressions()["joy"], View(yaw=-20.0))),
        ("kofi", Shot("kofi", 0.8 * visemes()[WIDE_OPEN], View(yaw=20.0))),
        ("vera", Shot("vera", still(), View(yaw=-15.0))),
    ]
    felt = [
        (head, Shot(name, expressions()[name], close)) for head, name in zip(cast, EXPRESSIONS, strict=True)
    ]
    portraits(people, 400).save(folder / "people.jpg", quality=86)
    portraits(felt, 260).save(folder / "expressions.jpg", quality=86)
    fdp_chart.sheet(load("generic")[1], 420).save(folder / "points.jpg", quality=84)


def load(wish: str) -> tuple[str, Head]:
    """A packaged head by name, or a file."""
    packaged = packaged_heads()
    if wish in packaged:
        return wish, read_head(packaged[wish].read_bytes(), wish)
    return Path(wish).stem, read_head(Path(wish).read_bytes(), wish)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument(
        "--out", type=Path, default=Path("build/gallery"), help="folder (default build/gallery)"
    )
    parser.add_argument("--head", action="append", metavar="NAME|F.glb", help="default: all in the package")
    parser.add_argument("--tile", type=int, default=240, help="size of a small picture in pixels")
    parser.add_argument(
        "--readme", type=Path, metavar="DIR", help="write only the pictures of README.md there"
    )
    options = parser.parse_args()
    if options.readme:
        return for_readme(options.readme)
    options.out.mkdir(parents=True, exist_ok=True)
    rows, shown = spoken(SENTENCE), []
    for k, wish in enumerate(options.head or packaged_heads()):
        name, head = load(wish)
        gallery = Gallery(name, head, options.tile)
        for title, image in sheets(gallery, rows, every_fap=k == 0):
            file = f"{name}-{'-'.join(title.lower().replace(',', '').split())}.png"
            image.save(options.out / file)
            shown.append((name, title, file))
            print(options.out / file, flush=True)
        gallery.studio.close()
    (options.out / "index.html").write_text(page(shown), encoding="utf-8")
    print(options.out / "index.html")


if __name__ == "__main__":
    main()
