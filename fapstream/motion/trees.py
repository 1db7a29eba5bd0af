"""Decision trees that say which state a unit in context is in, and what a state says."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fapstream.motion.questions import Answers, Context, answers
from fapstream.motion.units import SIL

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def n_states(unit: str) -> int:
    """Of a unit's model: two, three of silence (speech-enabled-avatars, section 3.3)."""
    return 3 if unit == SIL else 2


def tree_number(unit: str, k: int) -> int:
    """Which tree the k-th state of a unit goes through; there are N_TREES."""
    return k + 2 if unit == SIL else k


N_TREES = 5


@dataclass(frozen=True, slots=True)
class Tree:
    """Nodes in rows (question, where yes leads, where no leads), shape (nodes, 3); a leaf is (-1, leaf,
    leaf)."""

    nodes: Ints

    @property
    def n_leaves(self) -> int:
        """Leaves are numbered from 0."""
        return int((self.nodes[:, 0] < 0).sum())

    def leaf(self, given: Answers) -> int:
        """Where those answers, shape (questions,), lead."""
        node = 0
        while self.nodes[node, 0] >= 0:
            node = self.nodes[node, 1 if given[self.nodes[node, 0]] else 2]
        return int(self.nodes[node, 1])


@dataclass(frozen=True, slots=True)
class TiedStates:
    """Gaussians over n parameters that states in context share.

    `trees`: of the first and second state of phones, and the three of silence; their leaves are numbered on
    through all of them. `mean`, `var`: shape (leaves, n); `stay`: the probability to stay a frame of 10 ms,
    shape (leaves,).
    """

    trees: tuple[Tree, ...]
    mean: Floats
    var: Floats
    stay: Floats

    def states(self, context: Context) -> Ints:
        """The leaves of a unit's states, in order."""
        given = answers(context)
        first = np.concatenate([[0], np.cumsum([tree.n_leaves for tree in self.trees])])
        numbers = [tree_number(context.unit, k) for k in range(n_states(context.unit))]
        return np.array([first[number] + self.trees[number].leaf(given) for number in numbers])

    def shares(self, states: Ints) -> Floats:
        """Which part of a unit each of its states takes: d_i / sum d, d_i = 1 / (1 - p_ii), the mean stay.

        The paper's section 4 has p_ii / (1 - p_ii), which leaves out the frame in which a state is entered.
        """
        stays = 1 / (1 - self.stay[states])
        found: Floats = stays / stays.sum()
        return found
