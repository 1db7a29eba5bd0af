"""Facial parts deformation (FPD): each part of the face is turned, stretched and moved for itself.

N. Sarris, N. Grammalidis, M. G. Strintzis, section 2.3. Where the paper's steps break down they are replaced:
- alignment: the paper minimises differences of the gradients dy/dx and dz/dx of three lines, which a line
  with dx = 0 does not have, and every line on the midline is one; here it is the sum of |R u - v|^2 over
  the lines' unit directions;
- stretching: a part that is flat along an axis, as brows are, says nothing about the stretch along it; the
  stretch is pulled towards 1, the more the flatter the part is;
- what the parts leave at the feature nodes is made good at last: each node is then a part of its own, too few
  for a turn or a stretch, so it is only moved;
- parts are told by which feature nodes are nearest, so that all of space belongs to one: lashes and hair too.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fapstream.adapt.points import feature_points
from fapstream.adapt.rigid import nearest_rotation
from fapstream.adapt.warp import Chain, squared_gaps
from fapstream.data import read_text

Floats = NDArray[np.float64]

BORDER = 0.04
"""Metres: where the nearest nodes of two parts are less different in distance than this, both have a say."""
NEIGHBOURS = 12
"""So many single nodes have a say in what is moved after the parts."""
FLAT = 0.004
"""Metres: parts that are as flat as this along an axis are stretched half as much along it as they would
be.
"""
MOST_STRETCHED = 2.0
FEWEST = 3


@dataclass(frozen=True, slots=True)
class Part:
    """A facial part: names of its feature nodes, of pairs of them whose lines it is aligned by, and of
    points that it lies round."""

    name: str
    points: tuple[str, ...]
    lines: tuple[tuple[str, str], ...]
    area: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Piece:
    """What becomes of one part: x' = matrix @ (x - middle) + target."""

    matrix: Floats
    middle: Floats
    target: Floats

    def __call__(self, points: Floats) -> Floats:
        moved: Floats = (points - self.middle) @ self.matrix.T + self.target
        return moved


@cache
def parts() -> tuple[Part, ...]:
    """All parts; those of the right mirror those of the left."""
    found = []
    for name, row in tomllib.loads(read_text("adapt", "parts.toml")).items():
        part = Part(
            name, tuple(row["points"]), tuple((a, b) for a, b in row["lines"]), tuple(row.get("area", ()))
        )
        if row.get("sides"):
            found += [_named(part, f"{name}_l", str), _named(part, f"{name}_r", mirrored)]
        else:
            found.append(part)
    return tuple(found)


def mirrored(name: str) -> str:
    """The name of the same point on the other side."""
    point = feature_points().get(name)
    if point is not None:
        return point.mirror or name
    return _FDP_PAIRS[name]


_FDP_PAIRS = {"3.9": "3.10", "3.13": "3.14", "5.1": "5.2", "5.3": "5.4", "2.11": "2.12"}
"""MPEG-4 points that parts lie round and that are not looked for in photos."""


def _named(part: Part, name: str, rename: Callable[[str], str]) -> Part:
    lines = tuple((rename(a), rename(b)) for a, b in part.lines)
    return Part(name, tuple(map(rename, part.points)), lines, tuple(map(rename, part.area)))


@dataclass(frozen=True, slots=True)
class PartsWarp:
    """Space divided among parts: near a border, the mean of the candidates, weighted linearly across it.

    `nodes`: by part, the places (k, 3) that are nearest to what belongs to it.
    """

    pieces: tuple[Piece, ...]
    nodes: tuple[Floats, ...]

    def weights(self, points: Floats) -> Floats:
        """(n, parts), rows sum to 1."""
        gaps = np.stack([_nearest(points, nodes) for nodes in self.nodes], 1)
        over = gaps - gaps.min(1, keepdims=True)
        shares = np.clip(1 - over / BORDER, 0, None)
        found: Floats = shares / shares.sum(1, keepdims=True)
        return found

    def __call__(self, points: Floats) -> Floats:
        total = np.zeros(points.shape)
        for piece, share in zip(self.pieces, self.weights(points).T, strict=True):
            some = share > 0
            total[some] += share[some, None] * piece(points[some])
        return total


@dataclass(frozen=True, slots=True)
class NodesWarp:
    """Nodes (n, 3) that are moved by `moves` (n, 3), and what lies between them by what is near.

    Weights fall with the distance and reach 0 at the next nearest node (Franke and Nielson 1980, Smooth
    interpolation of large sets of scattered data).
    """

    nodes: Floats
    moves: Floats

    def __call__(self, points: Floats) -> Floats:
        gaps = np.sqrt(squared_gaps(points, self.nodes)) + 1e-9
        count = min(NEIGHBOURS, len(self.nodes) - 1)
        reach = np.partition(gaps, count, 1)[:, [count]]
        weights = np.clip(1 / gaps - 1 / reach, 0, None) ** 2 + 1e-12
        moved: Floats = points + weights @ self.moves / weights.sum(1, keepdims=True)
        return moved


def fit_parts(
    source: Mapping[str, Floats], target: Mapping[str, Floats], places: Mapping[str, Floats]
) -> Chain:
    """The warp that takes feature nodes from `source` to `target`, both (3,) by name; the model has been
    aligned rigidly before. `places`: by name, where the parts lie.
    """
    whole = _in_parts(source, target, places)
    here = whole(np.array([source[name] for name in target]))
    wanted = np.array(list(target.values()))
    return Chain((whole, NodesWarp(here, wanted - here)))


def _in_parts(
    source: Mapping[str, Floats], target: Mapping[str, Floats], places: Mapping[str, Floats]
) -> PartsWarp:
    pieces, nodes = [], []
    for part in parts():
        names = [name for name in part.points if name in target]
        if len(names) < FEWEST:
            continue
        lines = [line for line in part.lines if set(line) <= set(names)]
        rows = [np.array([table[name] for name in names]) for table in (source, target)]
        ways = [
            np.array([table[b] - table[a] for a, b in lines]).reshape(-1, 3) for table in (source, target)
        ]
        pieces.append(fit_piece(*rows, *ways))
        nodes.append(np.array([places[name] for name in (*names, *part.area)]))
    return PartsWarp(tuple(pieces), tuple(nodes))


def fit_piece(source: Floats, target: Floats, lines: Floats, wanted: Floats) -> Piece:
    """Centre, align, stretch, move: feature nodes (n, 3) and their targets, lines (m, 3) and theirs."""
    middle, goal = source.mean(0), target.mean(0)
    turn = alignment(lines, wanted)
    stretch = stretching((source - middle) @ turn.T, target - goal)
    return Piece(stretch[:, None] * turn, middle, goal)


def alignment(lines: Floats, wanted: Floats) -> Floats:
    """The rotation (3, 3) that minimises sum |R u - v|^2 over the unit directions u, v of lines (m, 3)."""
    u = lines / np.maximum(np.linalg.norm(lines, axis=1, keepdims=True), 1e-12)
    v = wanted / np.maximum(np.linalg.norm(wanted, axis=1, keepdims=True), 1e-12)
    return nearest_rotation(v.T @ u)


def stretching(turned: Floats, target: Floats) -> Floats:
    """Factors (3,) by axis, of centred points (n, 3): sum(x t) / sum(x^2), pulled towards 1 where x is
    small.
    """
    pull = len(turned) * FLAT**2
    factors = ((turned * target).sum(0) + pull) / ((turned**2).sum(0) + pull)
    held: Floats = np.clip(factors, 1 / MOST_STRETCHED, MOST_STRETCHED)
    return held


def _nearest(points: Floats, nodes: Floats) -> Floats:
    found: Floats = np.sqrt(squared_gaps(points, nodes).min(1))
    return found
