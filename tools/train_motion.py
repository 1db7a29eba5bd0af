"""Learn a speaker's motion from a folder of clips: what `tools/train_motion` runs."""

from __future__ import annotations

import argparse
import os
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
from tqdm import tqdm

from fapstream.adapters.sound_file import read_sound
from fapstream.errors import FapstreamError
from fapstream.learn.articulatory import PAPER_EXPLAINED
from fapstream.learn.clips import Folder
from fapstream.learn.hmm import Recipe
from fapstream.learn.ohman import OhmanRecipe
from fapstream.learn.training import DEVELOPMENT, TRAIN, Trained, train
from fapstream.motion.speaker import FILE, pack, unpack
from fapstream.records import Pcm

DEFAULT_OUT = Path(__file__).parents[1] / "fapstream/motion/data" / FILE
MOST_BYTES = 1_000_000
MADE = "Learned from the GRID corpus, speaker 1 (Cooke, Barker, Cunningham and Shao 2006), CC BY 4.0."


def main() -> int:
    """Train, check, and only then replace the file."""
    parser = argparse.ArgumentParser(prog="tools/train_motion", description=__doc__)
    parser.add_argument("data", type=Path, help="folder with landmarks.npz, phones.json and split.json")
    parser.add_argument(
        "--out", type=Path, default=DEFAULT_OUT, metavar="F", help="default: the package's own file"
    )
    parser.add_argument(
        "--made", default=MADE, metavar="TEXT", help="what the file says of where it comes from"
    )
    args = parser.parse_args()
    try:
        folder = Folder(args.data)
        steps = (
            sum(len(folder.part(part)) for part in (TRAIN, DEVELOPMENT))
            + Recipe().steps
            + 3
            + OhmanRecipe().rounds
        )
        with tqdm(total=steps, unit="", dynamic_ncols=True) as bar:
            trained = train(folder, args.made, lambda what: _tell(bar, what), sound=_sound(args.data))
        write(trained, args.out)
    except FapstreamError as e:
        print(f"train_motion: {e}", file=sys.stderr)
        return 1
    report(trained, args.out)
    return 0


def _sound(data: Path) -> Callable[[str], Pcm] | None:
    """What reads the sound of a clip, if there is any."""
    flac = data / "flac"
    return (lambda name: read_sound(flac / f"{name}.flac")) if flac.is_dir() else None


def _tell(bar: tqdm[None], what: str) -> None:
    bar.set_description_str(what)
    bar.update()


def write(trained: Trained, out: Path) -> None:
    """The file, whole or not at all. Raises DataError if it would not be read again, or if nothing stands in
    for phones that were never heard."""
    data = pack(trained.speaker)
    speaker = unpack(data, out.name)
    speaker.mouth("hmm")
    speaker.mouth("ohman")
    if len(data) > MOST_BYTES:
        raise FapstreamError(f"the model takes {len(data)} bytes; {MOST_BYTES} are allowed")
    beside = out.with_name(f"{out.name}.new")
    beside.write_bytes(data)
    os.replace(beside, out)


def report(trained: Trained, out: Path) -> None:
    """What was learned, in a few lines."""
    speaker = trained.speaker
    how = speaker.smoothness
    print(f"{out}: {out.stat().st_size} bytes, {len(speaker.states.stay)} states")
    print(f"kernel {1000 * how.width_s:.0f} ms, lambda {how.weight:g}")
    print("articulatory parameter   % of variance   in the paper")
    for name, part, theirs in zip(
        speaker.articulation.names, trained.explained, PAPER_EXPLAINED, strict=True
    ):
        print(f"{name:<24} {100 * part:13.1f} {100 * theirs:14.1f}")
    print(f"{'together':<24} {100 * trained.explained.sum():13.1f} {100 * sum(PAPER_EXPLAINED):14.1f}")
    print(f"nine principal components: {100 * np.cumsum(trained.components)[-1]:.1f}")
    for reason, times in Counter(trained.left_out.values()).items():
        print(f"left out, {times} clips: {reason}")


if __name__ == "__main__":
    sys.exit(main())
