"""Learning to say what is heard: a small network from the sound around an instant to articulatory
parameters."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from fapstream.errors import ClipError
from fapstream.motion.hearing import APART, BANDS, DEEP, REACH, STACKED, Heard, Listener, centres
from fapstream.records import Pcm

Floats = NDArray[np.float64]

RATE = 16_000
UNITS = 64
DECAY = 2e-5
"""How much large weights cost."""
ITERATIONS = 250
TILT_NATS, NOISE, QUIETER = 1.5, (2.0, 60.0), (0.05, 1.0)
"""How other microphones may differ: by a slope of the spectrum to either side, by noise (its size, from
samples of 16 bits, spread evenly as logarithms), by how loud they are."""
TRACT = 0.12
"""By how much other vocal tracts may be longer or shorter (the logarithm): formants are as much lower or
higher."""


def stacked(pcm: Pcm, rng: np.random.Generator | None = None) -> Floats:
    """What the network is given at instants 20 ms apart, shape (n, STACKED x BANDS). With `rng` somebody else
    at another microphone is made up."""
    tilt, tract = np.zeros(BANDS), np.eye(BANDS)
    if rng is not None:
        noise = np.exp(rng.uniform(*np.log(NOISE)))
        level = np.exp(rng.uniform(*np.log(QUIETER)))
        pcm = (pcm * level + rng.normal(0, noise, len(pcm))).clip(-32768, 32767).astype(np.int16)
        tilt = rng.uniform(-TILT_NATS, TILT_NATS) * np.linspace(-1, 1, BANDS)
        tract = warp(np.exp(rng.uniform(-TRACT, TRACT)))
    listener = Listener(RATE)
    listener.add(pcm)
    frames = np.concatenate([bands for bands, _ in listener.frames(last=True)])
    frames = np.where(frames > -DEEP, np.maximum(frames + tilt, -DEEP), frames) @ tract
    padded = np.pad(frames, ((REACH, REACH + 1), (0, 0)), constant_values=-DEEP)
    at = np.arange(0, len(frames), 2)[:, None] + np.arange(0, 2 * REACH + 1, APART)
    found: Floats = padded[at].reshape(len(at), STACKED * BANDS)
    return found


def warp(times: float) -> Floats:
    """What turns bands (n, BANDS) into those of sound whose formants are so many times as high."""
    centre = centres()
    at = np.interp(centre / times, centre, np.arange(BANDS))
    below = np.minimum(at.astype(int), BANDS - 2)
    found = np.zeros((BANDS, BANDS))
    found[below, np.arange(BANDS)] = 1 - (at - below)
    found[below + 1, np.arange(BANDS)] = at - below
    return found


class HearingFit:
    """Fits `Heard`. After `fit`: `heard_`, and `error_`, the mean squared error."""

    def __init__(self, units: int = UNITS, iterations: int = ITERATIONS, seed: int = 0) -> None:
        self.units, self.iterations, self.seed = units, iterations, seed

    def fit(self, x: Floats, y: Floats) -> HearingFit:
        """Of what is heard, (n, in), and the parameters then, (n, parameters). Raises ClipError."""
        if not len(x):
            raise ClipError("there is no sound to learn from")
        mean, scale = x.mean(axis=0), np.maximum(x.std(axis=0), 1e-3)
        inputs = ((x - mean) / scale).astype(np.float32)
        rng = np.random.default_rng(self.seed)
        shapes = (x.shape[1] + 1, self.units), (self.units + 1, y.shape[1])
        start = np.concatenate([rng.normal(0, 1 / np.sqrt(a), (a, b)).ravel() for a, b in shapes])
        found = minimize(
            _error, start, (inputs, y.astype(np.float32), shapes), jac=True, method="L-BFGS-B",
            options={"maxiter": self.iterations},
        )  # fmt: skip
        self.error_ = float(found.fun)
        self.heard_ = Heard(mean, scale, *_split(found.x, shapes))
        return self


Shapes = tuple[tuple[int, int], tuple[int, int]]


def _split(weights: Floats, shapes: Shapes) -> tuple[Floats, Floats]:
    first = shapes[0][0] * shapes[0][1]
    return weights[:first].reshape(shapes[0]), weights[first:].reshape(shapes[1])


def _error(
    weights: Floats, x: NDArray[np.float32], y: NDArray[np.float32], shapes: Shapes
) -> tuple[float, Floats]:
    """Mean squared error with decay, and its gradient."""
    hidden, out = (w.astype(np.float32) for w in _split(weights, shapes))
    inner = np.tanh(x @ hidden[:-1] + hidden[-1])
    wrong = inner @ out[:-1] + out[-1] - y
    n = wrong.size
    back = 2 * wrong / n
    to_inner = (back @ out[:-1].T) * (1 - inner**2)
    gradient = np.concatenate(
        [(x.T @ to_inner).ravel(), to_inner.sum(axis=0), (inner.T @ back).ravel(), back.sum(axis=0)]
    ).astype(np.float64)
    error = float((wrong.astype(np.float64) ** 2).sum() / n + DECAY * (weights @ weights))
    return error, gradient + 2 * DECAY * weights


def paired(
    sounds: Sequence[Pcm], parameters: Sequence[Floats], speech: Sequence[slice], seed: int = 0
) -> tuple[Floats, Floats]:
    """What is heard in clips and what the faces did, 20 ms apart: each clip as it is and as somebody
    else at another microphone would have said it. `parameters`: of whole clips, (t, n), 100 a second;
    `speech`: the frames of them that count."""
    rng = np.random.default_rng(seed)
    x, y = [], []
    for pcm, made, frames in zip(sounds, parameters, speech, strict=True):
        wanted = made[::2]
        counts = slice(frames.start // 2, frames.stop // 2)
        for other in (None, rng):
            given = stacked(pcm, other)
            n = min(len(given), len(wanted))
            x.append(given[:n][counts])
            y.append(wanted[:n][counts])
    return np.concatenate(x), np.concatenate(y)
