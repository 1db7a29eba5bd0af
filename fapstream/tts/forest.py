"""A small forest of decision trees over bytes, packed in flat arrays: several trees per letter that vote.

Packed: little-endian uint32 trees per letter k, node count n, distribution count d; uint32 roots[26 * k]
letter by letter; feature uint8[n]; value uint8[inner nodes], those of one feature together, in the order of
the features; distribution uint16[leaves]; and the distributions, label uint8[CHOICES * d], weight
uint8[CHOICES * d], the likeliest label first. Nodes are in preorder; one asks whether
`asked[feature] == value`: yes goes on at the next node, no at the one after the subtree of yes. feature LEAF
marks a leaf.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

LEAF: Final = 255
CHOICES: Final = 3
"""Labels that a leaf may tell apart."""

SURE: Final = 255
"""The weight of a label that is as good as certain."""

ENOUGH: Final = 3
"""When so many trees are sure of the same label, the others are not asked."""

Votes = list[tuple[int, float]]


class Forest:
    """Labels and probabilities for a letter; see above."""

    def __init__(self, data: bytes, at: int = 0) -> None:
        """Reads the packed forest at `at`; `end` is where it ends."""
        k, n, d = np.frombuffer(data, "<u4", 3, at).tolist()
        roots = np.frombuffer(data, "<u4", 26 * k, at + 12).tolist()
        self._roots: list[list[int]] = [roots[letter * k : (letter + 1) * k] for letter in range(26)]
        at += 4 * (26 * k + 3)
        self._feature = data[at : at + n]
        feature = np.frombuffer(self._feature, np.uint8)
        inner, at = np.flatnonzero(feature != LEAF).astype(np.uint32), at + n
        value = np.zeros(n, np.uint8)
        value[inner[np.argsort(feature[inner], kind="stable")]] = np.frombuffer(
            data, np.uint8, len(inner), at
        )
        at += len(inner)
        step = np.empty(n, np.uint16)
        for root, end in pairwise([*roots, n]):
            if end - root > np.iinfo(np.uint16).max:
                raise ValueError(f"a tree of {end - root} nodes")
            step[root:end] = second_branches(feature[root:end]) - np.arange(end - root, dtype=np.uint32)
        leaves = feature == LEAF
        count = int(np.count_nonzero(leaves))
        step[leaves] = np.frombuffer(data, "<u2", count, at)
        at += 2 * count
        self._value = value.tobytes()
        halves = step.astype("<u2").tobytes()
        self._low, self._high = halves[::2], halves[1::2]
        """Bytes of: how much further on the second branch begins; at a leaf, which distribution it has."""
        self._choice = data[at : at + CHOICES * d]
        self._weight = data[at + CHOICES * d : at + 2 * CHOICES * d]
        self._leaves: list[Votes | None] = [None] * d
        self.end = at + 2 * CHOICES * d

    def vote(self, letter: int, asked: bytes) -> Votes:
        """Labels of a letter (a=0) and their probabilities, given its features."""
        feature, value, low, high = self._feature, self._value, self._low, self._high
        votes: dict[int, float] = {}
        roots = self._roots[letter]
        sure = 0
        for node in roots:
            while (f := feature[node]) != LEAF:
                node += 1 if asked[f] == value[node] else low[node] + 256 * high[node]
            leaf = low[node] + 256 * high[node]
            p = 0.0
            for label, p in self._leaves[leaf] or self._leaf(leaf):
                votes[label] = votes.get(label, 0.0) + p
            sure += p == 1.0
            if sure == ENOUGH and len(votes) == 1:
                return [(label, 1.0)]
        share = 1 / len(roots)
        return [(label, p * share) for label, p in votes.items()]

    def _leaf(self, at: int) -> Votes:
        """A distribution, unpacked the first time that it is met; only what is sure has probability 1."""
        labels = self._choice[CHOICES * at : CHOICES * (at + 1)]
        weights = self._weight[CHOICES * at : CHOICES * (at + 1)]
        total = sum(weights) + (0.01 if weights[0] != SURE else 0.0)
        leaf = [(label, w / total) for label, w in zip(labels, weights, strict=True) if w]
        self._leaves[at] = leaf
        return leaf


def second_branches(feature: NDArray[np.uint8]) -> NDArray[np.uint32]:
    """For nodes in preorder, feature (n,), where the second branch of each begins; at leaves, anything.

    With +1 for an inner node and -1 for a leaf, the sum over the nodes before a second branch is, for the
    first time again, what it was at its parent.
    """
    depth = np.ones(len(feature) + 1, np.int16)
    depth[1:][feature == LEAF] = -1
    depth[0] = 0
    np.cumsum(depth, out=depth)
    order = np.argsort(depth[:-1], kind="stable").astype(np.uint32)
    following = np.zeros(len(feature), np.uint32)
    following[order[:-1]] = order[1:]
    return following
