"""Learn where the named points are on the mesh and on the outline, from persons whose points are known.

python tools/fit_landmarks.py --persons build/identities
`--persons`: folders that tools/identities.py wrote. Writes mesh.tsv, outline.tsv and behind.tsv to
fapstream/adapt/data.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from itertools import combinations
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.spatial import cKDTree

from fapstream.adapt import silhouette
from fapstream.adapt.found import EYES, only_face
from fapstream.adapt.outline import headings, resampled
from fapstream.adapt.points import BEHIND, PhotoPoints, feature_points, read_points
from fapstream.adapt.silhouette import FINE, FIRM, OFFSETS
from fapstream.adapters.landmarks import Landmarker

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

DATA = Path(__file__).parents[1] / "fapstream" / "adapt" / "data"
CHAIN = (
    "11.1", "forehead", "glabella", "nasion", "bridge", "9.3", "9.15", "8.1", "stomion", "8.2", "sulcus",
    "2.10", "2.1", "throat",
)  # fmt: skip
PROPORTIONED = ("3.1", "3.3", "4.5", "8.3", "9.1")
"""Behind the outline besides those that tell where it looks."""
SURE = 0.004
"""sd of a point of confidence 1, in eye distances (fapstream.adapt.refine.Belief); those are EYES_SHARE of"""
EYES_SHARE, EYES_HEIGHT = 0.70, 0.57
"""what lies between outer corners of the eyes, and of the height of the face."""
NOISE = 0.008
"""sd of a point of the mesh, distances between outer corners: what weights make of it counts as an error."""
MORE = 0.003
"""What another point of the mesh must gain."""
LEAST_SURE, MOST_SURE = 0.02, 0.5
NEAR, AFAR = 11, 6
OUTLINE = (
    "name, confidence, step from the point before in heights of the face (x forward, y down), its sds,"
    " headings of the outline around (radians, from x towards y), their sds"
)
BEHIND_HEAD = "name on the left, confidence, place in the mean chain's frame"
FOLDS = 5
HIDDEN = 0.02
"""Heights of the face between a point and the outline: it is under hair."""
LEAST_BEND_RAD, LEAST_STEP = 0.15, 0.015


def persons(folders: Sequence[Path]) -> Iterator[tuple[PhotoPoints, NDArray[np.uint8], NDArray[np.uint8]]]:
    """Their points and two photos."""
    for folder in folders:
        for path in sorted(folder.glob("*.points.json")):
            base = str(path).removesuffix("points.json")
            files = (f"{base}{view}.jpg" for view in ("front", "profile"))
            front, profile = (np.asarray(Image.open(file).convert("RGB")) for file in files)
            yield read_points(path.read_text(), str(path)), front, profile


class Meshes:
    """Meshes of front photos (s, 468, 2) and true points (s, 2), distances between outer corners of the eyes.

    They are level, and each person is also there mirrored: the right half of the face teaches the left.
    """

    def __init__(self) -> None:
        self.meshes: list[Floats] = []
        self.truth: list[dict[str, Floats]] = []

    def add(self, mesh: Floats, points: PhotoPoints) -> None:
        """One more person."""
        right, left = mesh[EYES[0], :2], mesh[EYES[1], :2]
        along = left - right
        turn = np.array([[along[0], -along[1]], [along[1], along[0]]]) / (along**2).sum()
        level = lambda at: (np.asarray(at) - (left + right) / 2) @ turn  # noqa: E731
        self.meshes.append(level(mesh[:, :2]))
        self.truth.append({name: level(at) for name, at in points.front.points.items()})

    def ready(self) -> None:
        """After the last."""
        once = np.array(self.meshes)
        mean = once.mean(0)
        self.mirror = cKDTree(mean).query(mean * (-1, 1))[1]
        self.mean = (mean + mean[self.mirror] * (-1, 1)) / 2
        self.all = np.concatenate([once, once[:, self.mirror] * (-1, 1)])

    def of(self, name: str) -> Floats:
        """(s, 2): where the point is."""
        other = feature_points()[name].mirror or name
        return np.array([t[name] for t in self.truth] + [t[other] * (-1, 1) for t in self.truth])

    def row(self, name: str) -> list[tuple[str, str]]:
        """The lines of a left or middle point and of its mirror."""
        truth, people = self.of(name), len(self.truth)
        off = []
        for fold in range(FOLDS):
            test = np.arange(2 * people) % people % FOLDS == fold
            indices, weights = self._fit(name, truth, ~test)
            off.append(np.einsum("skd,k->sd", self.all[test][:, indices], weights) - truth[test])
        typical = np.median(np.linalg.norm(np.concatenate(off), axis=1))
        sure = confidence(float(typical) / EYES_SHARE)
        indices, weights = self._fit(name, truth, np.ones(2 * people, bool))
        terms = lambda which: "\t".join(f"{i}:{w:.3f}" for i, w in zip(which, weights, strict=True))  # noqa: E731
        rows = [(name, f"{sure:.3f}\t{terms(indices)}")]
        other = feature_points()[name].mirror
        return rows + ([(other, f"{sure:.3f}\t{terms(self.mirror[list(indices)])}")] if other else [])

    def _fit(self, name: str, truth: Floats, rows: NDArray[np.bool_]) -> tuple[tuple[int, ...], Floats]:
        """The one to three points of the mesh with the mean, weighted, that is nearest to the truth."""
        seen, wanted = self.all[rows], truth[rows]
        tries = []
        for count in (1, 2, 3):
            for indices in combinations(self._candidates(name, wanted.mean(0)), count):
                weights = affine(seen[:, indices], wanted)
                off = np.einsum("skd,k->sd", seen[:, indices], weights) - wanted
                cost = (off**2).sum(1).mean() + NOISE**2 * (weights**2).sum() + (count * MORE) ** 2
                tries.append((float(cost), indices, weights))
        return min(tries, key=lambda row: row[0])[1:]

    def _candidates(self, name: str, at: Floats) -> list[int]:
        """Near it; for what the mesh does not reach, also those that tell how long and wide a face is."""
        middle = np.flatnonzero(self.mirror == np.arange(len(self.mirror)))
        pool = middle if feature_points()[name].mirror is None else np.arange(len(self.mirror))
        near = pool[np.argsort(np.linalg.norm(self.mean[pool] - at, axis=1))].tolist()
        if name == "11.1":
            return near[:4] + [152, 1, 168, 0]
        if name.startswith("10."):
            return near[:AFAR] + [1, 152, 10, int(self.mirror[near[0]]), *EYES, 61, 291]
        return near[:NEAR]


def affine(seen: Floats, wanted: Floats) -> Floats:
    """Small weights (k,) of sum 1 by which points (s, k, 2) have the mean nearest to those wanted (s, 2)."""
    base, rest = wanted - seen[:, 0], seen[:, 1:] - seen[:, :1]
    small = NOISE**2 * len(wanted)
    matrix = np.einsum("sid,sjd->ij", rest, rest) + small * (np.eye(rest.shape[1]) + 1)
    weights = np.linalg.solve(matrix, np.einsum("sid,sd->i", rest, base) + small)
    return np.concatenate([[1 - weights.sum()], weights])


def confidence(typical: float) -> float:
    """From the median distance to the truth, in eye distances (of two normal errors, 1.18 of their sd)."""
    return float(np.clip(SURE / (typical / 1.1774), LEAST_SURE, MOST_SURE))


class Outlines:
    """Outlines with a true chain, nose to the right, in heights of the face."""

    def __init__(self) -> None:
        self.bends: dict[str, list[Floats]] = {name: [] for name in CHAIN}
        self.places: list[dict[str, Floats]] = []
        self.lines: list[tuple[Floats, PhotoPoints]] = []

    def add(self, line: Floats, points: PhotoPoints) -> None:
        """One more person."""
        side = -1 if points.facing == "left" else 1
        own = dict(points.profile.points)
        height = float(np.hypot(*np.subtract(own["nasion"], own["2.1"])))
        place = {left_name(name): np.array(at) * (side, 1) / height for name, at in own.items()}
        walked = resampled(line[::side] * (side, 1) / height, FINE[-1])
        around = np.stack([np.roll(headings(walked), -round(offset / FINE[-1])) for offset in OFFSETS], 1)
        away, at = cKDTree(walked).query([place[name] for name in CHAIN])
        for name, far, k in zip(CHAIN, away, at, strict=True):
            if far < HIDDEN:
                self.bends[name].append(around[k])
        self.places.append(place)
        self.lines.append((line, points))

    def chain(self, sure: dict[str, float]) -> Iterator[tuple[str, str]]:
        """Lines of outline.tsv."""
        before = CHAIN[0]
        for name in CHAIN:
            steps = np.array([place[name] - place[before] for place in self.places])
            bends = np.array(self.bends[name])
            mean = np.angle(np.exp(1j * bends).mean(0))
            off = np.angle(np.exp(1j * (bends - mean)))
            numbers = [*steps.mean(0), *np.hypot(steps.std(0), LEAST_STEP), *mean]
            numbers += list(np.hypot(off.std(0), LEAST_BEND_RAD))
            yield name, f"{sure.get(name, 0.2):.3f}\t" + "\t".join(f"{n:.3f}" for n in numbers)
            before = name

    def behind(self, sure: dict[str, float]) -> Iterator[tuple[str, str]]:
        """Lines of behind.tsv: in the frame of the mean chain."""
        mean = np.mean([[place[name] - place[CHAIN[0]] for name in CHAIN] for place in self.places], 0)
        flat = lambda rows: rows[:, 0] + 1j * rows[:, 1]  # noqa: E731
        goal = flat(mean[FIRM])
        names = list(dict.fromkeys(left_name(name) for name in (*PROPORTIONED, *BEHIND)))
        placed = {name: [] for name in names}
        for place in self.places:
            own = flat(np.array([place[name] for name in CHAIN[FIRM]]))
            arm = own - own.mean()
            scale = ((goal - goal.mean()) * arm.conj()).sum() / (abs(arm) ** 2).sum()
            for name in names:
                placed[name].append(scale * (complex(*place[name]) - own.mean()) + goal.mean())
        for name in names:
            at = np.mean(placed[name])
            yield name, f"{sure.get(name, 0.05):.3f}\t{at.real:.3f}\t{at.imag:.3f}"

    def sureness(self) -> dict[str, float]:
        """Confidence by left name, from what the tables as they are find on the outlines."""
        silhouette.chain.cache_clear()
        silhouette.behind.cache_clear()
        off: dict[str, list[float]] = {}
        for line, points in self.lines:
            true = points.profile.points
            height = np.hypot(*np.subtract(true["nasion"], true["2.1"]))
            found = silhouette.profile_marks(silhouette.lay(line, float(height)), points.profile.size, {})
            for name in set(found.points) & set(true):
                away = np.hypot(*np.subtract(found.points[name], true[name])) / height / EYES_HEIGHT
                off.setdefault(left_name(name), []).append(float(away))
        return {name: confidence(float(np.median(rows))) for name, rows in off.items()}


def left_name(name: str) -> str:
    """That of a pair which is on the left."""
    order, other = list(feature_points()), feature_points()[name].mirror
    return name if other is None or order.index(name) < order.index(other) else other


def write(name: str, head: str, rows: Iterator[tuple[str, str]]) -> None:
    """A table, in the order of points.tsv or of the outline."""
    text = "".join(f"{key}\t{row}\n" for key, row in rows)
    (DATA / name).write_text(f"# {head}\n# Learned by tools/fit_landmarks.py.\n{text}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--persons", type=Path, nargs="+", required=True, help="folders of known persons")
    options = parser.parse_args()
    landmarker, meshes, outlines = Landmarker(), Meshes(), Outlines()
    people = list(persons(options.persons))
    for points, front, profile in people:
        meshes.add(landmarker.mesh(front, only_face(landmarker.faces(front)))[0], points)
        outlines.add(landmarker.outline(profile, only_face(landmarker.faces(profile))), points)
    meshes.ready()
    left = [n for n, p in feature_points().items() if "front" in p.views and left_name(n) == n and n != "3.5"]
    write(
        "mesh.tsv", "name, confidence, points of the mesh: weights", (r for n in left for r in meshes.row(n))
    )
    sure: dict[str, float] = {}
    for _ in range(2):
        write("outline.tsv", OUTLINE, outlines.chain(sure))
        write("behind.tsv", BEHIND_HEAD, outlines.behind(sure))
        sure = outlines.sureness()


if __name__ == "__main__":
    main()
