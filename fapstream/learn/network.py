"""Sentences as rows of states: which Gaussian stands where, and at which frames it may."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fapstream.learn.chains import NEVER, Chains
from fapstream.learn.gaussians import Gaussians
from fapstream.learn.sentences import Sentence
from fapstream.motion.questions import Context
from fapstream.motion.trees import n_states
from fapstream.motion.units import SIL

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

BATCH = 56
"""Sentences walked at once."""

Key = tuple[Context, int]
"""A state: a unit in context, and which of its states."""


@dataclass(slots=True)
class Names:
    """Which Gaussian belongs to which state; units know their neighbours if `wide`."""

    index: dict[Key, int] = field(default_factory=dict)
    wide: bool = False

    @classmethod
    def single(cls, sentences: Sequence[Sentence]) -> Names:
        """Every unit by itself."""
        names = cls()
        for unit in sorted({u for s in sentences for u in s.units}):
            names._enter(Context(SIL, unit, SIL))
        return names

    @classmethod
    def in_context(cls, sentences: Sequence[Sentence]) -> Names:
        """Every unit between every two neighbours that it has in the sentences."""
        names = cls(wide=True)
        for context in sorted({c for s in sentences for c in contexts(s.units)}):
            names._enter(context)
        return names

    def _enter(self, context: Context) -> None:
        for k in range(n_states(context.unit)):
            self.index[context, k] = len(self.index)

    def cloned(self, names: Names, gaussians: Gaussians) -> Gaussians:
        """These, as they are under other names, which know no neighbours."""
        of = np.array([names.index[Context(SIL, c.unit, SIL), k] for c, k in self.index])
        return Gaussians(gaussians.mean[of], gaussians.var[of], gaussians.stay[of])

    def row(self, units: Sequence[str]) -> Ints:
        """The Gaussians of the states of a sentence."""
        found = contexts(units) if self.wide else [Context(SIL, u, SIL) for u in units]
        return np.array([self.index[c, k] for c in found for k in range(n_states(c.unit))])


def contexts(units: Sequence[str]) -> list[Context]:
    """Every unit with its neighbours; silence lies before the first and after the last."""
    padded = [SIL, *units, SIL]
    return [Context(*padded[i : i + 3]) for i in range(len(units))]


def batches(sentences: Sequence[Sentence]) -> Iterator[Sequence[Sentence]]:
    """As many as are walked at once."""
    for i in range(0, len(sentences), BATCH):
        yield sentences[i : i + BATCH]


def starts(sentence: Sentence) -> list[int]:
    """The first place of each unit in the row, and where the row ends."""
    found = [0]
    for unit in sentence.units:
        found.append(found[-1] + n_states(unit))
    return found


def chains(batch: Sequence[Sentence], names: Names) -> Chains:
    """The rows of a few sentences, padded."""
    rows = [names.row(sentence.units) for sentence in batch]
    s = max(map(len, rows))
    state, jump = np.full((len(rows), s), -1), np.full((len(rows), s), -1)
    for i, (row, sentence) in enumerate(zip(rows, batch, strict=True)):
        state[i, : len(row)] = row
        first = starts(sentence)
        for u, optional in enumerate(sentence.optional):
            if optional:
                jump[i, first[u + 1]] = first[u] - 1
    lengths = [(len(row), len(sentence.parameters)) for row, sentence in zip(rows, batch, strict=True)]
    return Chains(state, jump, np.array(lengths))


def densities(batch: Sequence[Sentence], walked: Chains, gaussians: Gaussians, slack: int | None) -> Floats:
    """Log densities of the frames in the places, shape (n, t, s).

    `slack`: how many frames a unit may lie outside the times that the sound has it at, None for any number.
    """
    log_b = np.full((len(batch), int(walked.lengths[:, 1].max()), walked.state.shape[1]), NEVER)
    for i, sentence in enumerate(batch):
        frames = dynamic(sentence.parameters)
        row = walked.state[i, : walked.lengths[i, 0]]
        found = gaussians.log_density(frames, row)
        if slack is not None:
            found[~near(sentence, slack)] = NEVER
        log_b[i, : len(frames), : len(row)] = found
    return log_b


def near(sentence: Sentence, slack: int) -> NDArray[np.bool_]:
    """Whether a frame may be in a place, shape (t, s): where the sound has its unit, or nearly.

    What lies between two units belongs to both, as a silence there may not have been asked for.
    """
    n = len(sentence.parameters)
    begin, end = sentence.times.T.copy()
    begin[0], end[-1] = 0, n
    earliest = np.minimum(begin, np.concatenate([[0], end[:-1]])) - slack
    latest = np.maximum(end, np.concatenate([begin[1:], [n]])) + slack
    unit = np.repeat(np.arange(len(sentence.units)), [n_states(u) for u in sentence.units])
    t = np.arange(n)[:, None]
    return np.asarray((t >= earliest[unit]) & (t < latest[unit]))


def dynamic(parameters: Floats) -> Floats:
    """Parameters (t, n) with their first and second differences, a frame each, shape (t, 3 n).

    Differences are slopes of a line through five frames, as in HTK (Young et al., "The HTK Book", 5.9).
    """
    first = _slopes(parameters)
    return np.hstack([parameters, first, _slopes(first)])


def _slopes(values: Floats) -> Floats:
    padded = np.pad(values, ((2, 2), (0, 0)), mode="edge")
    found: Floats = (2 * (padded[4:] - padded[:-4]) + padded[3:-1] - padded[1:-3]) / 10
    return found
