"""A folder of clips to learn from: landmarks, the phones that were heard, and which clips are for what.

landmarks.npz   xyz64: int16 (clips, frames, points, 3), pixels x 64, -32768 where there is no face;
                ids: the points' numbers in the mesh of 478; names; nframes: how many of the frames are real
phones.json     {clip: [[word, start_s, duration_s, [[phone, start_s, duration_s], ...]], ...]}, silence is
                the word <sil> and the phone SIL
split.json      {"train": [clip, ...], "dev": [clip, ...]}
flac/           sound, 16 kHz, where it is wanted
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from fapstream.errors import ClipError
from fapstream.learn.landmarks import Landmarks
from fapstream.motion.units import features

FPS = 25.0
NO_FACE = -32768
SILENT_WORD, SILENT_PHONE = "<sil>", "SIL"
MOST_FRAMES = 15_000
"""Of a clip: ten minutes."""


@dataclass(frozen=True, slots=True)
class PhoneHeard:
    """A phone of CMUdict without its stress digit, and when it was heard, s."""

    name: str
    start: float
    end: float


@dataclass(frozen=True, slots=True)
class WordHeard:
    """A word or a silence, and its phones."""

    text: str
    start: float
    end: float
    phones: tuple[PhoneHeard, ...]

    @property
    def silent(self) -> bool:
        """It is a silence."""
        return self.text == SILENT_WORD


@dataclass(frozen=True, slots=True)
class Clip:
    """A sentence that was filmed."""

    name: str
    landmarks: Landmarks
    words: tuple[WordHeard, ...]

    def speech(self) -> tuple[float, float]:
        """Where the first word begins and the last one ends, s. Raises ClipError."""
        spoken = [word for word in self.words if not word.silent]
        if not spoken:
            raise ClipError(f"{self.name}: nothing is said in the clip")
        return spoken[0].start, spoken[-1].end


class Folder:
    """The clips of a folder. Raises ClipError for files that are not what they should be."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.split = _split(path / "split.json")
        self._phones = _json(path / "phones.json")
        try:
            arrays = _arrays(path / "landmarks.npz")
        except (OSError, ValueError, KeyError, TypeError, EOFError, BadZipFile, zlib.error) as e:
            raise ClipError(f"{path / 'landmarks.npz'}: not landmarks of clips ({e})") from e
        self._xyz, self._frames = arrays["xyz64"], arrays["nframes"]
        self._ids = tuple(int(i) for i in arrays["ids"])
        self._row = {str(name): row for row, name in enumerate(arrays["names"])}

    def part(self, name: str) -> tuple[str, ...]:
        """The clips of `train`, `dev` or what else the folder is split into. Raises ClipError."""
        if name not in self.split:
            raise ClipError(
                f"{self.path / 'split.json'}: no part {name!r}; there are {', '.join(self.split)}"
            )
        return self.split[name]

    def clips(self, names: tuple[str, ...]) -> Iterator[Clip]:
        """Those clips. Raises ClipError."""
        for name in names:
            yield Clip(name, self._landmarks(name), _words(name, self._phones.get(name)))

    def _landmarks(self, name: str) -> Landmarks:
        if name not in self._row:
            raise ClipError(f"{self.path}: no landmarks of the clip {name!r}")
        row = self._row[name]
        xyz = self._xyz[row, : int(self._frames[row])]
        if len(xyz) > MOST_FRAMES:
            raise ClipError(f"{name}: {len(xyz)} frames; cut clips into at most {MOST_FRAMES}")
        points = np.where(xyz == NO_FACE, np.nan, xyz / 64)
        return Landmarks(points, self._ids, FPS)


def _arrays(path: Path) -> dict[str, Any]:
    """Those of landmarks.npz. Raises ValueError for such as do not fit one another, and what numpy does."""
    with np.load(path, allow_pickle=False) as file:
        arrays = {name: file[name] for name in ("xyz64", "nframes", "ids", "names")}
    xyz, frames, ids, names = arrays.values()
    if xyz.ndim != 4 or xyz.shape != (*names.shape, xyz.shape[1], *ids.shape, 3):
        raise ValueError(f"xyz64 has the shape {xyz.shape}; {names.size} clips, {ids.size} points")
    if not all(array.dtype.kind in "iu" for array in (xyz, frames, ids)):
        raise ValueError("xyz64, nframes and ids have to be whole numbers")
    if frames.shape != names.shape or not all(0 <= n <= xyz.shape[1] for n in frames):
        raise ValueError(f"nframes has to hold 0 to {xyz.shape[1]} frames for each of {names.size} clips")
    if any(len(np.unique(array)) < array.size for array in (ids, names)):
        raise ValueError("the same point or the same clip is there twice")
    return arrays


def _split(path: Path) -> dict[str, tuple[str, ...]]:
    split = _json(path)
    for part, names in split.items():
        if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
            raise ClipError(f"{path}: {part!r} has to be a list of clips")
    return {part: tuple(names) for part, names in split.items()}


def _words(name: str, rows: Any) -> tuple[WordHeard, ...]:
    try:
        words = tuple(
            WordHeard(
                str(text).lower(),
                float(start),
                float(start) + float(duration),
                tuple(PhoneHeard(str(p), float(s), float(s) + float(d)) for p, s, d in phones),
            )
            for text, start, duration, phones in rows
        )
        if not words or not all(word.phones for word in words):
            raise ValueError("none, or one without phones")
    except (TypeError, ValueError) as e:
        raise ClipError(f"phones.json: {name!r} has no words with phones and times ({e})") from None
    unknown = {phone.name for word in words for phone in word.phones} - {u.rstrip("01") for u in features()}
    if unknown:
        raise ClipError(f"phones.json: {name!r}: no phones of CMUdict: {', '.join(sorted(unknown))}")
    times = [0.0]
    for word in words:
        times += [word.start, *(t for phone in word.phones for t in (phone.start, phone.end)), word.end]
    if not np.isfinite(times).all() or not all(a <= b + 1e-6 for a, b in pairwise(times)):
        raise ClipError(f"phones.json: {name!r}: the times do not ascend")
    return words


def _json(path: Path) -> Any:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as e:
        raise ClipError(f"{path}: {e}") from e
    if not isinstance(found, dict):
        raise ClipError(f"{path}: expected an object")
    return found
