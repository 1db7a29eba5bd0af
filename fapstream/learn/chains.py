"""Left-to-right hidden Markov models of whole sentences: forward, backward and the best path, log domain.

Rabiner, "A tutorial on hidden Markov models" (1989), as embedded re-estimation uses it: the states of a
sentence's units stand in a row, each may stay or go on, and a silence that is optional may be jumped over.
Many sentences are walked at once, padded to one length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NEVER = -np.inf


@dataclass(frozen=True, slots=True)
class Chains:
    """The rows of states of n sentences, at most s states long.

    `state`: shape (n, s), which state of the model stands there, -1 beyond the end. `jump`: shape (n, s),
    from which earlier place it can be reached past a silence, -1 if from none. `lengths`: states and frames
    of each, shape (n, 2).
    """

    state: Ints
    jump: Ints
    lengths: Ints


@dataclass(frozen=True, slots=True)
class Arcs:
    """Logarithms of how probable a step from each place of `Chains` is, shape (n, s): to stay, and to go on,
    which where a jump begins is as probable as the jump."""

    stay: Floats
    leave: Floats


@dataclass(frozen=True, slots=True)
class Posterior:
    """`gamma`: shape (n, t, s), how probable each place is at each frame. `stays`: shape (n, s), how often a
    place is expected to be stayed in. `log_likelihood`: shape (n,), -inf where no path fits."""

    gamma: Floats
    stays: Floats
    log_likelihood: Floats


def arcs(chains: Chains, stay: Floats) -> Arcs:
    """From the probability of staying in each state of the model, shape (m,)."""
    p = stay[np.maximum(chains.state, 0)]
    leave = np.log1p(-p)
    at, to = np.nonzero(chains.jump >= 0)
    leave[at, chains.jump[at, to]] -= np.log(2)
    return Arcs(np.log(p), leave)


def posterior(chains: Chains, of: Arcs, log_b: Floats) -> Posterior:
    """What the frames say about the places; `log_b`: shape (n, t, s), log density of a frame in a place.

    A path begins in the first place and goes on from the last.
    """
    n, t, s = log_b.shape
    log_b = np.where((chains.state >= 0)[:, None], log_b, NEVER)
    frames, last = chains.lengths[:, 1], chains.lengths[:, 0] - 1
    out = of.leave[np.arange(n), last]
    alpha, beta = np.full((n, t, s), NEVER), np.full((n, t, s), NEVER)
    alpha[:, 0, 0] = log_b[:, 0, 0]
    for i in range(1, t):
        alpha[:, i] = _entered(alpha[:, i - 1], chains, of) + log_b[:, i]
    for i in range(t - 1, -1, -1):
        if i + 1 < t:
            beta[:, i] = _left(beta[:, i + 1] + log_b[:, i + 1], chains, of)
        ends = np.flatnonzero(frames == i + 1)
        beta[ends, i] = NEVER
        beta[ends, i, last[ends]] = out[ends]
    total = alpha[np.arange(n), frames - 1, last] + out
    known = np.isfinite(total)
    scale = np.where(known, total, 0.0)[:, None, None]
    inside = (np.arange(t) < frames[:, None])[..., None] & known[:, None, None]
    gamma = np.where(inside, np.exp(alpha + beta - scale), 0.0)
    after = np.where(inside[:, 1:], log_b[:, 1:] + beta[:, 1:] - scale, NEVER)
    stays = np.exp(alpha[:, :-1] + of.stay[:, None] + after).sum(axis=1)
    return Posterior(gamma, stays, total)


def _entered(alpha: Floats, chains: Chains, of: Arcs) -> Floats:
    """How the places are reached one frame later, shape (n, s)."""
    gone = alpha + of.leave
    reached = np.logaddexp(alpha + of.stay, _shifted(gone))
    at, to = np.nonzero(chains.jump >= 0)
    reached[at, to] = np.logaddexp(reached[at, to], gone[at, chains.jump[at, to]])
    return reached


def _left(after: Floats, chains: Chains, of: Arcs) -> Floats:
    """What the places lead to, given what each place is worth one frame later."""
    onward = np.full_like(after, NEVER)
    onward[:, :-1] = after[:, 1:]
    at, to = np.nonzero(chains.jump >= 0)
    origin = chains.jump[at, to]
    onward[at, origin] = np.logaddexp(onward[at, origin], after[at, to])
    return np.logaddexp(after + of.stay, onward + of.leave)


def _shifted(values: Floats) -> Floats:
    moved = np.full_like(values, NEVER)
    moved[:, 1:] = values[:, :-1]
    return moved


def best_path(chains: Chains, of: Arcs, log_b: Floats) -> Ints:
    """The most probable place at each frame (Viterbi), shape (n, t), -1 beyond the end or if no path fits."""
    n, t, s = log_b.shape
    log_b = np.where((chains.state >= 0)[:, None], log_b, NEVER)
    best = np.full((n, s), NEVER)
    best[:, 0] = log_b[:, 0, 0]
    origin = np.zeros((n, t, s), np.int64)
    here = np.broadcast_to(np.arange(s), (n, s))
    before = np.maximum(here - 1, 0)
    jump = np.maximum(chains.jump, 0)
    frames, last = chains.lengths[:, 1], chains.lengths[:, 0] - 1
    ended = np.full(n, NEVER)
    for i in range(t):
        if i:
            gone = best + of.leave
            ways = np.stack(
                [
                    best + of.stay,
                    _shifted(gone),
                    np.where(chains.jump >= 0, np.take_along_axis(gone, jump, 1), NEVER),
                ]
            )
            which = ways.argmax(axis=0)
            origin[:, i] = np.choose(which, [here, before, jump])
            best = ways.max(axis=0) + log_b[:, i]
        ends = frames == i + 1
        ended[ends] = best[ends, last[ends]]
    return _traced(origin, chains, np.isfinite(ended))


def _traced(origin: Ints, chains: Chains, found: NDArray[np.bool_]) -> Ints:
    n, t, _ = origin.shape
    frames, place = chains.lengths[:, 1], chains.lengths[:, 0] - 1
    path = np.full((n, t), -1)
    for i in range(t - 1, -1, -1):
        inside = (frames > i) & found
        path[inside, i] = place[inside]
        place = np.where(inside, origin[np.arange(n), i, place], place)
    return path
