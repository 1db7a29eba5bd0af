"""A face that was never filmed: landmarks that follow FAPs we know, and a folder of clips of it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fapstream.fap import faps
from fapstream.learn.landmarks import table
from fapstream.records import N_FAPS

Floats = NDArray[np.float64]

IDS = tuple(row.point for row in table())
MNS, MW, ENS, ES, IRISD = 20.0, 50.0, 47.0, 60.0, 9.5
UNITS = {"MNS": MNS / 1024, "MW": MW / 1024, "ENS": ENS / 1024, "ES": ES / 1024, "IRISD": IRISD / 1024}
"""Of this face, mm."""
PLACES = {
    "3.5": (30, 0, 0), "3.6": (-30, 0, 0), "3.1": (30, 4.75, 0), "3.2": (-30, 4.75, 0), "3.3": (30, -4.75, 0),
    "3.4": (-30, -4.75, 0), "3.7": (45, 0, -8), "3.12": (-45, 0, -8), "3.11": (16, 0, 0), "3.8": (-16, 0, 0),
    "9.15": (0, -47, 12), "2.2": (0, -67, 12), "2.3": (0, -67, 12), "2.4": (22, -67, 6), "2.5": (-22, -67, 6),
    "2.6": (11, -67, 10), "2.7": (-11, -67, 10), "2.8": (11, -67, 10), "2.9": (-11, -67, 10),
    "8.1": (0, -60, 14), "8.2": (0, -76, 14), "8.3": (25, -67, 5), "8.4": (-25, -67, 5), "8.5": (12, -61, 12),
    "8.6": (-12, -61, 12), "8.7": (12, -75, 12), "8.8": (-12, -75, 12), "8.9": (4, -59, 14),
    "8.10": (-4, -59, 14),
    "2.1": (0, -110, 4), "2.10": (0, -100, 10), "4.1": (12, 18, 2), "4.2": (-12, 18, 2), "4.3": (28, 24, 0),
    "4.4": (-28, 24, 0), "4.5": (46, 18, -10), "4.6": (-46, 18, -10),
}  # fmt: skip
"""Feature points, mm, to the subject's left, up and forwards."""


def neutral() -> Floats:
    """Points (k, 3) of the face at rest, in the order of IDS; those without a name lie where they may."""
    rng = np.random.default_rng(0)
    found = np.zeros((len(IDS), 3))
    around = {"bone": (0, 25, -5), "lips": (0, -67, 10), "face": (0, -85, 6), "base": (0, -47, 12)}
    for i, row in enumerate(table()):
        if row.fdp:
            found[i] = PLACES[row.fdp]
        else:
            found[i] = np.array(around[row.part]) + rng.normal(0, (18, 9, 5))
    found[IDS.index(10)] = (0, 70, PLACES["9.15"][2])
    for row in table():
        if row.mirror > row.point:
            found[IDS.index(row.mirror)] = found[IDS.index(row.point)] * (-1, 1, 1)
        elif row.mirror == row.point:
            found[IDS.index(row.point), 0] = 0.0
    return found


def moved(values: Floats) -> Floats:
    """Points (n, k, 3), mm, under FAPs (n, 68) that cameras see."""
    points = np.tile(neutral(), (len(values), 1, 1))
    rows = {
        row.fdp: [i for i, other in enumerate(table()) if other.fdp == row.fdp] for row in table() if row.fdp
    }
    directions = {"down": (1, -1), "up": (1, 1), "left": (0, 1), "right": (0, -1)}
    for fap in faps():
        if fap.fdp and fap.fdp[0] in rows and fap.positive in directions and fap.unit in UNITS:
            axis, sign = directions[fap.positive]
            for i in rows[fap.fdp[0]]:
                points[:, i, axis] += sign * values[:, fap.fap - 1] * UNITS[fap.unit]
    return points


def turned(points: Floats, rng: np.random.Generator, noise: float = 0.0) -> Floats:
    """As a camera's tracker gives them: pixels, x to the right, y down, z away, from a head that moves."""
    n = len(points)
    t = np.linspace(0, 2 * np.pi, n)
    out = np.empty_like(points)
    for i in range(n):
        a, b, c = 0.2 * np.sin(t[i] + 1), 0.25 * np.sin(1.3 * t[i]), 0.1 * np.cos(t[i])
        rx = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
        ry = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
        rz = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
        scale = 1.1 + 0.05 * np.sin(t[i])
        out[i] = scale * points[i] @ (rx @ ry @ rz).T + (5 * np.sin(t[i]), 3.0, 0)
    out += rng.normal(0, noise, out.shape) if noise else 0.0
    return out * (1, -1, -1) + (180, 144, 0)


TARGETS = {
    "SIL": (0, 0, 0), "B": (60, 0, -10), "M": (50, 0, -5), "F": (90, -60, 0), "T": (120, -170, 10),
    "S": (60, -150, 40), "L": (170, -230, 0), "W": (90, -120, -120), "AA": (420, -560, 0),
    "IY": (110, -200, 90),
    "UW": (130, -180, -150), "EY": (240, -330, 60),
}  # fmt: skip
"""Where each phone wants jaw, lower lip (FAP 3, 5) and corners (6)."""
WORDS = {
    "two": ("T", "UW"), "blue": ("B", "L", "UW"), "soft": ("S", "AA", "F", "T"), "we": ("W", "IY"),
    "may": ("M", "EY"),
    "be": ("B", "IY"), "lay": ("L", "EY"), "moss": ("M", "AA", "S"),
}  # fmt: skip


def said(words: Sequence[str], rng: np.random.Generator) -> tuple[list[list[object]], float]:
    """Words as phones.json has them, with silences around, and where they end, s."""
    rows: list[list[object]] = [["<sil>", 0.0, 0.4, [["SIL", 0.0, 0.4]]]]
    at = 0.4
    for word in words:
        start, phones = at, []
        for phone in WORDS[word]:
            length = round(float(rng.uniform(0.06, 0.14)), 3)
            phones.append([phone, round(at, 4), length])
            at = round(at + length, 4)
        rows.append([word, start, round(at - start, 4), phones])
    rows.append(["<sil>", at, 0.4, [["SIL", at, 0.4]]])
    return rows, at + 0.4


def performed(rows: list[list[object]], end: float, fps: float = 25.0) -> Floats:
    """FAPs (n, 68) of somebody who says that: from target to target, a little lazily."""
    times, wanted = [], []
    for _, _, _, phones in rows:
        for phone, start, length in phones:  # type: ignore[attr-defined]
            times.append(start + length / 2)
            wanted.append(TARGETS[phone])
    t = np.arange(round(end * 200)) / 200
    course = np.stack([np.interp(t, times, column) for column in np.array(wanted, float).T], axis=1)
    kernel = np.hanning(13) / np.hanning(13).sum()
    course = np.stack([np.convolve(np.pad(c, 6, mode="edge"), kernel, "valid") for c in course.T], axis=1)
    frames = course[:: round(200 / fps)]
    values = np.zeros((len(frames), N_FAPS))
    jaw, lip, corner = frames.T
    for fap, column in (
        (3, jaw),
        (5, lip),
        (10, 0.85 * lip),
        (11, 0.85 * lip),
        (52, lip),
        (57, 0.8 * lip),
        (58, 0.8 * lip),
    ):
        values[:, fap - 1] = column
    for fap in (6, 7, 53, 54):
        values[:, fap - 1] = corner
    values[:, 3] = values[:, 50] = 0.1 * lip
    return values


def folder(path: Path, train: int = 26, dev: int = 5, seed: int = 0) -> Path:
    """A folder of clips of this face."""
    rng = np.random.default_rng(seed)
    names = [f"clip{i:02d}" for i in range(train + dev)]
    phones, tracks = {}, []
    for name in names:
        rows, end = said(rng.choice(sorted(WORDS), 5).tolist(), rng)
        phones[name] = rows
        tracks.append(turned(moved(performed(rows, end)), rng, noise=0.05))
    longest = max(map(len, tracks))
    xyz = np.full((len(names), longest, len(IDS), 3), -32768, np.int16)
    for i, track in enumerate(tracks):
        xyz[i, : len(track)] = np.rint(track * 64)
    frames = np.array([len(track) for track in tracks], np.int16)
    np.savez(
        path / "landmarks.npz", xyz64=xyz, ids=np.array(IDS, np.int16), names=np.array(names), nframes=frames
    )
    (path / "phones.json").write_text(json.dumps(phones), encoding="utf-8")
    (path / "split.json").write_text(
        json.dumps({"train": names[:train], "dev": names[train:]}), encoding="utf-8"
    )
    return path
