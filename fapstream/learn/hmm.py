"""Training hidden Markov models of facial motion, as speech-enabled-avatars has it (3.3, 3.4)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fapstream.errors import ClipError
from fapstream.learn.chains import arcs, best_path, posterior
from fapstream.learn.clustering import grow
from fapstream.learn.gaussians import Counts, Gaussians
from fapstream.learn.network import Names, batches, chains, densities, dynamic, starts
from fapstream.learn.sentences import Sentence
from fapstream.motion.questions import answers
from fapstream.motion.trees import N_TREES, TiedStates, Tree, tree_number

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FIRST_STAY = 0.6
LEAST_VARIANCE = 1e-9
"""Of numbers that never change."""
Progress = Callable[[str], None]
"""Is told what is done before each step."""


@dataclass(frozen=True, slots=True)
class Recipe:
    """How many iterations each step has, and when trees stop.

    `slack`: how many frames a unit may lie outside the times that the sound has it at. In the paper it may
    lie anywhere (None), as if there were no sound; then states settle where they fit and not where the phones
    are, and what is made from the phones' times is much further from what was measured. `floor`: the least
    variance, as a part of that of all frames. `min_frames`, `min_gain`: see clustering. Raises ValueError for
    steps without iterations.
    """

    flat: int = 6
    realigned: int = 2
    cloned: int = 2
    tied: int = 2
    slack: int | None = 3
    floor: float = 0.01
    min_frames: float = 50.0
    min_gain: float = 40.0

    def __post_init__(self) -> None:
        if min(self.flat, self.realigned, self.cloned, self.tied) < 1:
            raise ValueError("every step has to have an iteration")

    @property
    def steps(self) -> int:
        """How often progress is told."""
        return self.flat + 1 + self.realigned + self.cloned + 1 + self.tied


class HmmTrainer:
    """Trains tied states of triphones. After `fit`: `model_`, and `log_likelihood_`: of each step, a frame in
    each iteration."""

    def __init__(self, recipe: Recipe | None = None, progress: Progress = lambda _: None) -> None:
        self.recipe = recipe or Recipe()
        self.progress = progress

    def fit(self, sentences: Sequence[Sentence]) -> HmmTrainer:
        """Flat start, silences found, units in context, tied states. Raises ClipError."""
        if not sentences:
            raise ClipError("there are no sentences to learn from")
        recipe = self.recipe
        self.log_likelihood_: dict[str, list[float]] = {}
        frames = np.concatenate([dynamic(s.parameters) for s in sentences])
        self._floor = np.maximum(recipe.floor * frames.var(axis=0), LEAST_VARIANCE)
        plain = [s.without([i for i, may in enumerate(s.optional) if may]) for s in sentences]
        single = Names.single(sentences)
        gaussians, _ = self._train(plain, single, flat_start(frames, len(single.index)), "flat")
        plain = self._with_silences(sentences, single, gaussians)
        gaussians, _ = self._train(plain, single, gaussians, "realigned")
        wide = Names.in_context(plain)
        gaussians, counts = self._train(plain, wide, wide.cloned(single, gaussians), "cloned")
        trees, tied = self._tie(wide, counts)
        gaussians = counts.pooled(
            np.array(list(tied.index.values())), sum(t.n_leaves for t in trees)
        ).gaussians(self._floor, flat_start(frames, sum(t.n_leaves for t in trees)))
        gaussians, _ = self._train(plain, tied, gaussians, "tied")
        n = sentences[0].parameters.shape[1]
        self.model_ = TiedStates(trees, gaussians.mean[:, :n], gaussians.var[:, :n], gaussians.stay)
        return self

    def _train(
        self, sentences: Sequence[Sentence], names: Names, gaussians: Gaussians, step: str
    ) -> tuple[Gaussians, Counts]:
        """Embedded Baum-Welch; what was counted last is given back as well."""
        self.log_likelihood_[step] = []
        for _ in range(getattr(self.recipe, step)):
            self.progress(step)
            counts, total, frames = Counts.none(*gaussians.mean.shape), 0.0, 0
            for batch in batches(sentences):
                likelihood, known = _count(batch, names, gaussians, (self.recipe.slack, counts))
                total, frames = total + likelihood, frames + known
            if not frames:
                raise ClipError("no sentence is long enough for the phones that are said in it")
            self.log_likelihood_[step].append(total / frames)
            gaussians = counts.gaussians(self._floor, gaussians)
        return gaussians, counts

    def _with_silences(
        self, sentences: Sequence[Sentence], names: Names, gaussians: Gaussians
    ) -> list[Sentence]:
        """The sentences with those optional silences that their best path goes through."""
        self.progress("silences")
        found = []
        for batch in batches(sentences):
            walked = chains(batch, names)
            log_b = densities(batch, walked, gaussians, self.recipe.slack)
            paths = best_path(walked, arcs(walked, gaussians.stay), log_b)
            for sentence, path in zip(batch, paths, strict=True):
                first = starts(sentence)
                unused = [i for i, may in enumerate(sentence.optional) if may and first[i] not in path]
                found.append(sentence.without(unused))
        return found

    def _tie(self, names: Names, counts: Counts) -> tuple[tuple[Tree, ...], Names]:
        """The trees, and every state's leaf."""
        self.progress("trees")
        keys = list(names.index)
        given = np.array([answers(context) for context, _ in keys])
        number = np.array([tree_number(context.unit, k) for context, k in keys])
        trees, tied, first = [], np.zeros(len(keys), np.int64), 0
        for k in range(N_TREES):
            mine = np.flatnonzero(number == k)
            limits = (self.recipe.min_frames, self.recipe.min_gain)
            tree = grow(counts.of(mine), given[mine], limits, self._floor)
            tied[mine] = [first + tree.leaf(row) for row in given[mine]]
            trees.append(tree)
            first += tree.n_leaves
        return tuple(trees), Names(dict(zip(keys, tied.tolist(), strict=True)), wide=True)


def flat_start(frames: Floats, n: int) -> Gaussians:
    """n states that all look like all the frames (t, d)."""
    mean, var = frames.mean(axis=0), np.maximum(frames.var(axis=0), LEAST_VARIANCE)
    return Gaussians(np.tile(mean, (n, 1)), np.tile(var, (n, 1)), np.full(n, FIRST_STAY))


def _count(
    batch: Sequence[Sentence], names: Names, gaussians: Gaussians, into: tuple[int | None, Counts]
) -> tuple[float, int]:
    """Count a batch, with that slack; its log likelihood, and of how many frames it is."""
    slack, counts = into
    walked = chains(batch, names)
    found = posterior(walked, arcs(walked, gaussians.stay), densities(batch, walked, gaussians, slack))
    total, frames = 0.0, 0
    for i in np.flatnonzero(np.isfinite(found.log_likelihood)).tolist():
        s, t = walked.lengths[i]
        states, x = walked.state[i, :s], dynamic(batch[i].parameters)
        counts.add(states, found.gamma[i, :t, :s], found.stays[i, :s], x)
        total, frames = total + float(found.log_likelihood[i]), frames + int(t)
    return total, frames
