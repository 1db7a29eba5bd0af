"""The README's two pictures of learned motion: a sentence measured and made, and the articulatory parameters.

python tools/motion_pictures.py DATA [--clip NAME] [--out clients/web/demo]     (the extras learn and figures)
"""

from __future__ import annotations

import argparse
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib import pyplot
from PIL import Image, ImageDraw, ImageFont

from fapstream.head.gltf import read_head
from fapstream.learn.clips import Folder
from fapstream.learn.measured import RATE
from fapstream.learn.training import DEVELOPMENT, TRAIN, film, mean_fapu, speech
from fapstream.motion import MODELS, Motion
from fapstream.motion.articulation import COLUMNS
from fapstream.motion.speaker import speaker
from fapstream.records import N_FAPS
from tests.benchmarks.mouths import heard, ours, quantities
from tools.render_head import GENERIC, Renderer, View

DEMO = Path(__file__).parents[1] / "clients/web/demo"
COLOURS = {"hmm": "#1b6ca8", "ohman": "#d97706", "keyframes": "#9ca3af"}
MARGIN_S = 0.2
EXTREME = 3.0
"""Standard deviations over speech."""
TILE, LABEL = 240, 26
CLOSE = View(zoom=4.0)


def curves(folder: Folder, clip: str, out: Path) -> None:
    """Lip aperture over one sentence that nothing was learned from."""
    fapu = mean_fapu(film(folder, TRAIN, {}))
    filmed = next(f for f in film(folder, DEVELOPMENT, {}) if f.clip.name == clip)
    there = speech(filmed, MARGIN_S)
    t = np.arange(there.start, there.stop) / RATE
    matplotlib.rcParams["font.size"] = 9
    figure, axes = pyplot.subplots(figsize=(9, 3.2), layout="constrained")
    measured = quantities(filmed.measured.faps, filmed.measured.fapu)[there, 0]
    axes.plot(t, measured, color="black", linewidth=2.2, label="measured")
    for model in MODELS[::-1]:
        made = ours(heard(filmed.clip), Motion(model), fapu)[there, 0]
        axes.plot(t[: len(made)], made, color=COLOURS[model], linewidth=1.6, label=model)
    top = axes.get_ylim()[1]
    for word in filmed.clip.words:
        if not word.silent:
            axes.text((word.start + word.end) / 2, top, word.text, ha="center", va="bottom")
            for phone in word.phones:
                axes.axvline(phone.start, color="#e5e7eb", linewidth=0.7, zorder=0)
                axes.text(
                    (phone.start + phone.end) / 2,
                    -1.6,
                    phone.name,
                    ha="center",
                    fontsize=6.5,
                    color="#6b7280",
                )
    axes.set(xlabel="s", ylabel="lips apart, mm", xlim=(t[0], t[-1]))
    axes.legend(loc="upper left", frameon=False, ncols=2)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    figure.savefig(out, dpi=150)


def stills(out: Path) -> None:
    """The two ends of each parameter on the generic head."""
    articulation = speaker().articulation
    head = read_head(GENERIC.read_bytes(), str(GENERIC))
    renderer = Renderer(head, TILE)
    x, y, z = head.mouth.center
    view = View(zoom=CLOSE.zoom, target=(x, y - 0.008, z))
    sheet = Image.new("RGB", (articulation.n * TILE, 2 * TILE + LABEL), "white")
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(15)
    for k, name in enumerate(articulation.names):
        draw.text(((k + 0.5) * TILE, LABEL / 2), name, "black", font, anchor="mm")
        for row, size in enumerate((EXTREME, -EXTREME)):
            parameters = np.zeros(articulation.n)
            parameters[k] = size
            values = np.zeros(N_FAPS, np.int32)
            values[COLUMNS] = np.rint(articulation.faps(parameters))
            sheet.paste(renderer.picture(values, view), (k * TILE, LABEL + row * TILE))
    sheet.save(out, quality=88)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("--clip", help="default: the first of the part `dev`")
    parser.add_argument("--out", type=Path, default=DEMO)
    options = parser.parse_args()
    folder = Folder(options.data)
    curves(folder, options.clip or folder.part(DEVELOPMENT)[0], options.out / "motion.png")
    stills(options.out / "articulation.jpg")


if __name__ == "__main__":
    main()
