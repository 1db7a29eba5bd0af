"""Which of a voice's own phoneme events belongs to which of our phones. Pure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fapstream.records import Pcm

VOWELS = frozenset("aeiouAEIOUV@30&")
SKIP_COST = 0.9
OTHER_COST = 1.2
KIN_COST = 0.5

STOPS = ("stop", "affricate")
CLOSURE_MS = 120
"""A stop's closure is looked for this far before it opens."""
QUIET = 0.06
"""Below this part of a run's loudness a stop counts as closed."""
VOICED = 0.12
"""Above this part of the run's loudness below VOICE_HZ the voice is on."""
VOICE_HZ = 350
STEP_MS = 5


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


def refine(starts: Sequence[int], kinds: Sequence[tuple[str, bool]], pcm: Pcm, rate: int) -> list[int]:
    """Marks moved to where the sound has its boundaries.

    eSpeak NG marks a stop when it opens, and the phone after it late. A stop is moved back to where the sound
    before it falls silent, what follows a voiceless stop to where the voice comes in. `kinds`: class and
    voicing of each phone.
    """
    if not len(pcm):
        return list(starts)
    step = rate * STEP_MS // 1000
    loud = _levels(pcm.astype(np.float32), step)
    box = np.ones(rate // VOICE_HZ, np.float32)
    low = _levels(np.convolve(pcm, box / len(box), "same").astype(np.float32), step)
    out = list(starts)
    for i in range(1, len(starts)):
        (before, before_voiced), (kind, voiced) = kinds[i - 1], kinds[i]
        if kind in STOPS:
            earliest = max((out[i - 1] + starts[i]) // 2, starts[i] - CLOSURE_MS * rate // 1000)
            out[i] = _back_to(loud, starts[i], earliest, step)
        elif voiced and before in STOPS and not before_voiced:
            out[i] = max(out[i - 1], _on_to(low, starts[i - 1], starts[i], step))
    return out


def _levels(sound: NDArray[np.float32], step: int) -> NDArray[np.float32]:
    """Peak of every `step` samples, as a part of the run's usual peak."""
    whole = np.abs(sound[: len(sound) // step * step]).reshape(-1, step).max(axis=1)
    usual = np.percentile(whole, 95) if len(whole) else 0.0
    return np.asarray(whole / max(usual, 1.0), np.float32)


def _back_to(loud: NDArray[np.float32], at: int, earliest: int, step: int) -> int:
    while at - step >= earliest and loud[min(at // step, len(loud)) - 1] < QUIET:
        at -= step
    return at


def _on_to(low: NDArray[np.float32], at: int, latest: int, step: int) -> int:
    while at < latest and at // step < len(low) and low[at // step] < VOICED:
        at += step
    return min(at, latest)
