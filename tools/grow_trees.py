"""Grows and packs the decision trees of fapstream/tts/forest.py, for tools/train_lts.py.

A tree is grown breadth first, all nodes of a level at once: binary questions `x[feature] == value`, Gini
impurity, every node looking at a random part of the features. What a leaf saw is smoothed by what its parent
saw, and so on up to the root, and coarsened, so that branches that do not matter fall together.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fapstream.tts.forest import CHOICES, LEAF, SURE

VALUES = 256
STEPS = 4
"""Probabilities in a leaf are multiples of 1 / STEPS, except one as good as certain:"""

CERTAIN = 0.99

Leaf = tuple[tuple[int, int], ...]
"""Labels with weights, the likeliest first."""


@dataclass
class Examples:
    """x (features, n) uint8, y (n,) int64 below `classes`: rows of one letter."""

    x: np.ndarray
    y: np.ndarray
    classes: int


@dataclass
class Options:
    """`keep`: the share of the features that a node may ask about; `prior`: how many examples the parent's
    probabilities are worth; `gain`: how much purer, in examples, a question must make its node.
    """

    keep: float
    prior: float
    gain: float


class Tree:
    """`feature` (-1 at a leaf), `value`, `yes`, `no` and `probs` (classes,) of every node, root first."""

    def __init__(self, examples: Examples, rng: np.random.Generator, options: Options) -> None:
        self.options, self.rng = options, rng
        self.feature: list[int] = []
        self.value: list[int] = []
        self.yes: list[int] = []
        self.no: list[int] = []
        self.probs: list[np.ndarray] = []
        self._grow(examples)

    def _grow(self, examples: Examples) -> None:
        x, y, c = examples.x, examples.y, examples.classes
        rows, node = np.arange(len(y)), np.zeros(len(y), np.int64)
        parents = np.full((1, c), 1.0 / c)
        while len(parents):
            k = len(parents)
            total = np.bincount(node * c + y[rows], minlength=k * c).reshape(k, c).astype(float)
            probs = total + self.options.prior * parents
            probs /= probs.sum(1, keepdims=True)
            feature, value = self._split(examples, rows, node, total)
            inner = feature >= 0
            rank = np.cumsum(inner) - 1
            after = len(self.feature) + k + 2 * rank
            self.probs += list(probs)
            self.feature += feature.tolist()
            self.value += value.tolist()
            self.yes += np.where(inner, after, -1).tolist()
            self.no += np.where(inner, after + 1, -1).tolist()
            going = inner[node]
            rows, node = rows[going], node[going]
            node = 2 * rank[node] + (x[feature[node], rows] != value[node])
            parents = np.repeat(probs[inner], 2, axis=0)

    def _split(
        self, examples: Examples, rows: np.ndarray, node: np.ndarray, total: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """For every node of the level the best question: feature (-1: none helps) and value."""
        k, size = len(total), total.sum(1)
        best = (total**2).sum(1) / size + self.options.gain
        feature, value = np.full(k, -1), np.zeros(k, np.int64)
        mixed = (total.max(1) < size)[node]
        rows, node = rows[mixed], node[mixed]
        asked = self.rng.random((len(examples.x), k)) < self.options.keep
        for f in range(len(examples.x)):
            use = asked[f][node]
            if not use.any():
                continue
            some = rows[use]
            pair, score = scores(node[use], examples.x[f][some], examples.y[some], total)
            owner = pair // VALUES
            begin = starts(owner)
            top, which = np.maximum.reduceat(score, begin), owner[begin]
            goal = np.full(k, np.inf)
            better = top > best[which]
            goal[which[better]] = best[which[better]] = top[better]
            hit = np.flatnonzero(score == goal[owner])[::-1]  # the first of equals is written last
            feature[owner[hit]] = f
            value[owner[hit]] = pair[hit] % VALUES
        return feature, value


def starts(ordered: np.ndarray) -> np.ndarray:
    """Where each run of equal numbers begins."""
    return np.flatnonzero(np.r_[True, ordered[1:] != ordered[:-1]])


def scores(
    node: np.ndarray, values: np.ndarray, y: np.ndarray, total: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The gain of asking for each value of one feature in each node.

    node, values, y: (n,) of the examples; total (nodes, classes). Returns node * VALUES + value, ascending,
    and sum over both branches of (sum of squared counts) / size: higher is purer; -1 where a branch is empty.
    """
    c = total.shape[1]
    key = (node * VALUES + values) * c + y
    key.sort()
    begin = starts(key)
    cell, count = key[begin], np.diff(np.r_[begin, len(key)]).astype(float)
    pair = cell // c
    every = total[pair // VALUES, cell % c]
    begin = starts(pair)
    n_yes, square, cross = (np.add.reduceat(a, begin) for a in (count, count * count, count * every))
    pair = pair[begin]
    owner = pair // VALUES
    n_no = total.sum(1)[owner] - n_yes
    rest = (total**2).sum(1)[owner] - 2 * cross + square
    return pair, np.where(n_no > 0, square / n_yes + rest / np.maximum(n_no, 1), -1.0)


def coarse(probs: np.ndarray, labels: np.ndarray) -> list[Leaf]:
    """The CHOICES likeliest labels of each row of probs (nodes, classes), with weights."""
    top = np.argsort(-probs, axis=1, kind="stable")[:, :CHOICES]
    kept = np.take_along_axis(probs, top, 1)
    weight = np.rint(STEPS * kept / kept.sum(1, keepdims=True)).astype(int)
    weight[:, 0] = np.maximum(weight[:, 0], 1)
    weight[kept[:, 0] >= CERTAIN, 0] = SURE
    names = labels[top].tolist()
    return [
        tuple((name, w) for name, w in zip(*row, strict=True) if w)
        for row in zip(names, weight.tolist(), strict=True)
    ]


class Packer:
    """Collects trees, letter by letter, into the format of forest.py."""

    def __init__(self, trees_per_letter: int) -> None:
        self.k = trees_per_letter
        self.roots: list[int] = []
        self.features = bytearray()
        self.values: list[int] = []
        self.leaves: list[Leaf] = []

    def add(self, tree: Tree, labels: np.ndarray) -> None:
        """`labels` (classes,): the number of each class of the tree among the labels of the file."""
        leaf, feature = coarse(np.array(tree.probs), labels), tree.feature
        for i in range(len(feature) - 1, -1, -1):
            yes, no = tree.yes[i], tree.no[i]
            if feature[i] >= 0 and feature[yes] < 0 and feature[no] < 0 and leaf[yes] == leaf[no]:
                feature[i], leaf[i] = -1, leaf[yes]
        self.roots.append(len(self.features))
        waiting = [0]
        while waiting:
            i = waiting.pop()
            if feature[i] < 0:
                self.features.append(LEAF)
                self.leaves.append(leaf[i])
            else:
                self.features.append(feature[i])
                self.values.append(tree.value[i])
                waiting += [tree.no[i], tree.yes[i]]

    def pack(self) -> bytes:
        """The packed forest; raises ValueError when the leaves are too different for 16 bits."""
        order = [leaf for leaf, _ in Counter(self.leaves).most_common()]
        if len(order) > 0xFFFF:
            raise ValueError(f"{len(order)} different leaves")
        number = {leaf: i for i, leaf in enumerate(order)}
        padded = [leaf + ((0, 0),) * (CHOICES - len(leaf)) for leaf in order]
        feature = np.frombuffer(bytes(self.features), np.uint8)
        value = np.array(self.values, np.uint8)[np.argsort(feature[feature != LEAF], kind="stable")]
        parts: Sequence[bytes] = [
            np.array([self.k, len(feature), len(order), *self.roots], "<u4").tobytes(),
            feature.tobytes() + value.tobytes(),
            np.array([number[leaf] for leaf in self.leaves], "<u2").tobytes(),
            bytes(label for leaf in padded for label, _ in leaf),
            bytes(weight for leaf in padded for _, weight in leaf),
        ]
        return b"".join(parts)
