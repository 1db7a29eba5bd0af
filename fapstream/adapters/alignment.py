"""Which of a voice's own phoneme events belongs to which of our phones. Pure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

VOWELS = frozenset("aeiouAEIOUV@30&")
SKIP_COST = 0.9
OTHER_COST = 1.2
KIN_COST = 0.5


def align(names: Sequence[str], events: Sequence[tuple[str, int]], end: int) -> list[int]:
    """The sample at which each of our phones begins, ascending.

    `names`: the mnemonics we sent; `events`: the mnemonics that were spoken and where each began; both in
    order. Matched by least edit cost (Needleman-Wunsch). A phone without an event shares the time of
    those around it.
    """
    starts: list[int | None] = [None] * len(names)
    for i, j in _matches(names, [name for name, _ in events]):
        starts[i] = events[j][1]
    if starts:
        starts[0] = 0
    known = [(i, s) for i, s in enumerate(starts) if s is not None] + [(len(names), end)]
    filled = np.interp(range(len(names)), [i for i, _ in known], [s for _, s in known])
    return [int(s) for s in np.maximum.accumulate(filled)] if len(names) else []


def _matches(ours: Sequence[str], theirs: Sequence[str]) -> list[tuple[int, int]]:
    n, m = len(ours), len(theirs)
    cost = [[SKIP_COST * (i + j) if not (i and j) else 0.0 for j in range(m + 1)] for i in range(n + 1)]
    for i in range(1, n + 1):
        for j in range(1, m + 1):
            cost[i][j] = min(
                cost[i - 1][j - 1] + _difference(ours[i - 1], theirs[j - 1]),
                cost[i - 1][j] + SKIP_COST,
                cost[i][j - 1] + SKIP_COST,
            )
    pairs = []
    i, j = n, m
    while i and j:
        if cost[i][j] == cost[i - 1][j - 1] + _difference(ours[i - 1], theirs[j - 1]):
            i, j = i - 1, j - 1
            pairs.append((i, j))
        elif cost[i][j] == cost[i - 1][j] + SKIP_COST:
            i -= 1
        else:
            j -= 1
    return pairs[::-1]


def _difference(ours: str, theirs: str) -> float:
    a, b = ours.lstrip("',%="), theirs.lstrip("',%=")
    if a == b:
        return 0.0
    if not a or not b:
        return OTHER_COST
    if a[0] == b[0]:
        return 0.1
    return KIN_COST if (a[0] in VOWELS) == (b[0] in VOWELS) else OTHER_COST
