"""Two readings of the same text put side by side."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field


def aligned(left: Sequence[str], right: Sequence[str]) -> Iterator[tuple[int, int]]:
    """Index pairs of equal names on a path of least edits through both sequences."""
    n, m = len(left), len(right)
    cost = [list(range(m + 1))]
    for i in range(1, n + 1):
        row, before = [i], cost[-1]
        for j in range(1, m + 1):
            row.append(min(before[j] + 1, row[-1] + 1, before[j - 1] + 2 * (left[i - 1] != right[j - 1])))
        cost.append(row)
    pairs = []
    i, j = n, m
    while i and j:
        if left[i - 1] == right[j - 1] and cost[i][j] == cost[i - 1][j - 1]:
            pairs.append((i - 1, j - 1))
            i, j = i - 1, j - 1
        elif cost[i][j] == cost[i - 1][j] + 1:
            i -= 1
        else:
            j -= 1
    return reversed(pairs)


@dataclass
class Agreement:
    """Values of the one and the other reading, phone by phone."""

    ours: list[float] = field(default_factory=list)
    theirs: list[float] = field(default_factory=list)

    def add(self, ours: float, theirs: float) -> None:
        """A pair."""
        self.ours.append(ours)
        self.theirs.append(theirs)

    @property
    def n(self) -> int:
        """How many pairs."""
        return len(self.ours)

    def rmse(self, scale: float) -> float:
        """Root mean square of the differences, `ours` multiplied by `scale`."""
        total = sum((scale * a - b) ** 2 for a, b in zip(self.ours, self.theirs, strict=True))
        return math.sqrt(total / self.n)

    def correlation(self) -> float:
        """Pearson's, nan where one side does not vary."""
        ma, mb = sum(self.ours) / self.n, sum(self.theirs) / self.n
        pairs = [(a - ma, b - mb) for a, b in zip(self.ours, self.theirs, strict=True)]
        va, vb = sum(a * a for a, _ in pairs), sum(b * b for _, b in pairs)
        return sum(a * b for a, b in pairs) / math.sqrt(va * vb) if va * vb > 0 else math.nan
