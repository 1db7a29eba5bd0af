"""Decision trees that tie the states of units in context: those that no question tells apart well are one.

Young, Odell and Woodland, "Tree-based state tying for high accuracy acoustic modelling" (1994): a node is
split by the question with the greatest gain in the log likelihood of the frames, as long as that gain and
what falls to either side are large enough. A unit in a context that was never met goes the same way.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fapstream.learn.gaussians import Counts
from fapstream.motion.trees import Tree

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


def grow(counts: Counts, answers: Bools, least: tuple[float, float], floor: Floats) -> Tree:
    """The tree over states with those counts and answers, shape (states, questions).

    `least`: frames on either side of a split, and gain. `floor`: the least variance, shape (d,).
    """
    rows: list[tuple[int, int, int]] = []
    leaves = 0

    def node(members: Ints) -> int:
        nonlocal leaves
        at = len(rows)
        rows.append((-1, leaves, leaves))
        question = _best(counts, answers, members, least, floor)
        if question < 0:
            leaves += 1
        else:
            yes = answers[members, question]
            rows[at] = (question, node(members[yes]), node(members[~yes]))
        return at

    node(np.flatnonzero(counts.occupancy > 0))
    return Tree(np.array(rows))


def _best(counts: Counts, answers: Bools, members: Ints, least: tuple[float, float], floor: Floats) -> int:
    """The question that splits members best, -1 if none is worth it."""
    yes = answers[members].T.astype(float)
    n, x, x2 = counts.occupancy[members], counts.x[members], counts.x2[members]
    all_n, all_x, all_x2 = n.sum(), x.sum(axis=0), x2.sum(axis=0)
    yes_n, yes_x, yes_x2 = yes @ n, yes @ x, yes @ x2
    no_n, no_x, no_x2 = all_n - yes_n, all_x - yes_x, all_x2 - yes_x2
    whole = _log_likelihood(np.array([all_n]), all_x[None], all_x2[None], floor)
    gain = _log_likelihood(yes_n, yes_x, yes_x2, floor) + _log_likelihood(no_n, no_x, no_x2, floor) - whole
    gain[np.minimum(yes_n, no_n) < least[0]] = -np.inf
    best = int(gain.argmax()) if gain.size else -1
    return best if best >= 0 and gain[best] > least[1] else -1


def _log_likelihood(n: Floats, x: Floats, x2: Floats, floor: Floats) -> Floats:
    """Of frames with those sums under their own Gaussian, but for what does not depend on the split."""
    safe = np.maximum(n, 1e-9)[:, None]
    var = np.maximum(x2 / safe - (x / safe) ** 2, floor)
    found: Floats = -0.5 * n * (np.log(var) + 1).sum(axis=1)
    return found
