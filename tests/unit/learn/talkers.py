"""A man of whom everything is known says words of GRID before a camera."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import ceil
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fapstream.learn.clips import WordHeard
from tests.unit.learn.faces import IDS, filmed, moved
from tests.unit.learn.folders import SILENCE, heard, landmarks_file, rows, write

Floats = NDArray[np.float64]

WORDS = {
    "bin": ("B", "IH", "N"), "lay": ("L", "EY"), "place": ("P", "L", "EY", "S"), "set": ("S", "EH", "T"),
    "blue": ("B", "L", "UW"), "green": ("G", "R", "IY", "N"), "white": ("W", "AY", "T"), "at": ("AE", "T"),
    "by": ("B", "AY"), "f": ("EH", "F"), "two": ("T", "UW"), "now": ("N", "AW"), "soon": ("S", "UW", "N"),
    "red": ("R", "EH", "D"), "four": ("F", "AO", "R"), "g": ("JH", "IY"), "u": ("Y", "UW"),
    "seven": ("S", "EH", "V", "AH", "N"), "one": ("W", "AH", "N"),
}  # fmt: skip
FPS, PHONE_S, QUIET_S = 25, 0.09, 0.25

MOVES = (
    {3: 1.0, 5: -0.6, 10: -0.5, 11: -0.5, 52: -0.6, 57: -0.5, 58: -0.5, 12: -0.2, 13: -0.2},
    {18: 1.0},
    {4: -1.0, 8: -0.8, 9: -0.8, 51: -0.9, 55: -0.7, 56: -0.7},
    {5: -1.0, 10: -0.8, 11: -0.8, 52: -0.9, 57: -0.7, 58: -0.7},
    {6: 1.0, 7: 1.0, 53: 1.0, 54: 1.0},
    {12: 1.0, 13: 1.0, 59: 1.0, 60: 1.0},
)
"""FAPs of the six things that his face does: jaw, chin, upper lip, lower lip, wide, corners up."""
SIZES = np.array([450.0, 200, 150, 250, 120, 150])


def targets() -> dict[str, Floats]:
    """How much of each he does in the middle of a phone; nothing in silence and least in closures."""
    rng = np.random.default_rng(7)
    phones = sorted({phone for word in WORDS.values() for phone in word})
    found = {phone: SIZES * rng.uniform([0.2, -1, 0.1, 0.1, -1, -1], 1) for phone in phones}
    closed = {phone: found[phone] * (0.1, 1, 0, 0, 1, 1) for phone in ("B", "P", "F")}
    return found | closed | {"SIL": np.zeros(6)}


@dataclass(slots=True)
class Talker:
    """`lost`: of some clips, the frames in which the face is lost; `words`: of others, what is said instead;
    `frames`: of others, how many are filmed."""

    seed: int = 0
    lost: Mapping[str, slice] = field(default_factory=dict)
    words: Mapping[str, tuple[WordHeard, ...]] = field(default_factory=dict)
    frames: Mapping[str, int] = field(default_factory=dict)

    def folder(self, path: Path, split: Mapping[str, int]) -> Path:
        """So many clips for each part, named after it and numbered."""
        rng = np.random.default_rng(self.seed)
        names = {part: [f"{part}{i}" for i in range(n)] for part, n in split.items()}
        phones, tracks = {}, {}
        for name in (name for part in names.values() for name in part):
            said = self.words.get(name) or sentence(rng)
            points = film(said, rng)[: self.frames.get(name)]
            if name in self.lost:
                points[self.lost[name]] = np.nan
            phones[name], tracks[name] = rows(said), points
        return write(path, landmarks_file(tracks, IDS), phones, names)


def sentence(rng: np.random.Generator) -> tuple[WordHeard, ...]:
    """Three words or four between silences, about a second and a half; between two there may be one more."""
    chosen = [(str(word), WORDS[str(word)]) for word in rng.choice(list(WORDS), int(rng.integers(3, 5)))]
    if rng.random() < 0.4:
        chosen.insert(2, SILENCE)
    quiet = ("<sil>", ("SIL",) * round(QUIET_S / PHONE_S))
    return heard([quiet, *chosen, quiet], PHONE_S)


def film(said: tuple[WordHeard, ...], rng: np.random.Generator) -> Floats:
    """From phone to phone softly; the head is never still. Pixels (frames, points, 3)."""
    phones = [phone for word in said for phone in word.phones]
    keys = np.array([(phone.start + phone.end) / 2 for phone in phones])
    known = targets()
    wanted = np.array([known[phone.name] for phone in phones])
    t = np.arange(ceil(phones[-1].end * FPS)) / FPS
    after = np.clip(np.searchsorted(keys, t), 1, len(keys) - 1)
    share = np.clip((t - keys[after - 1]) / (keys[after] - keys[after - 1]), 0, 1)[:, None]
    share = share * share * (3 - 2 * share)
    done = (1 - share) * wanted[after - 1] + share * wanted[after]
    values: dict[int, Floats] = {}
    for column, faps in enumerate(MOVES):
        for number, part in faps.items():
            values[number] = values.get(number, 0.0) + part * done[:, column]
    return filmed(moved(values), rng, FPS, noise_px=0.1).points
