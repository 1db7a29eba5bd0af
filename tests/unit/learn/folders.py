"""Folders of clips, written by tests."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fapstream.learn.clips import NO_FACE, PhoneHeard, WordHeard

Floats = NDArray[np.float64]
Words = Sequence[tuple[str, Sequence[str]]]

SILENCE = ("<sil>", ("SIL",))


def heard(words: Words, each_s: float = 0.1, start_s: float = 0.0) -> tuple[WordHeard, ...]:
    """Words of phones that all last as long, one after another."""
    found, at = [], start_s
    for text, phones in words:
        times = [at + i * each_s for i in range(len(phones) + 1)]
        told = [PhoneHeard(p, times[i], times[i + 1]) for i, p in enumerate(phones)]
        found.append(WordHeard(text, at, times[-1], tuple(told)))
        at = times[-1]
    return tuple(found)


def rows(words: Sequence[WordHeard]) -> list[Any]:
    """As phones.json has them."""
    return [
        [w.text, w.start, w.end - w.start, [[p.name, p.start, p.end - p.start] for p in w.phones]]
        for w in words
    ]


def landmarks_file(tracks: Mapping[str, Floats], ids: Sequence[int]) -> dict[str, Any]:
    """The arrays of landmarks.npz, of clips' points in pixels, (frames, points, 3), NaN where lost."""
    most = max((len(points) for points in tracks.values()), default=0)
    xyz = np.full((len(tracks), most, len(ids), 3), NO_FACE, np.int16)
    for row, points in enumerate(tracks.values()):
        known = np.isfinite(points)
        xyz[row, : len(points)] = np.where(known, np.rint(64 * np.where(known, points, 0.0)), NO_FACE)
    return {
        "xyz64": xyz,
        "ids": np.array(ids, np.int32),
        "names": np.array(list(tracks)),
        "nframes": np.array([len(points) for points in tracks.values()], np.int32),
    }


def write(path: Path, arrays: Mapping[str, Any], phones: Any, split: Any) -> Path:
    """The folder."""
    path.mkdir(exist_ok=True)
    np.savez(path / "landmarks.npz", **arrays)
    (path / "phones.json").write_text(json.dumps(phones), encoding="utf-8")
    (path / "split.json").write_text(json.dumps(split), encoding="utf-8")
    return path
