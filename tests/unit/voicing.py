"""Sound that is like speech as far as a mouth can tell: vowels of buzz and formants, with pauses between."""

from __future__ import annotations

import numpy as np

from fapstream.records import Pcm


def voicing(seconds: float, rate: int = 16000, syllable_s: float = 0.25, seed: int = 1) -> Pcm:
    """A buzz of 120 Hz through two formants that move, loud in the first half of each syllable."""
    rng = np.random.default_rng(seed)
    t = np.arange(int(seconds * rate)) / rate
    syllable = np.floor(t / syllable_s).astype(int)
    first = rng.uniform(300, 800, syllable.max() + 1)[syllable]
    second = rng.uniform(900, 2200, syllable.max() + 1)[syllable]
    harmonics = np.arange(1, int(min(3500, 0.45 * rate) / 120))[:, None]
    f = 120 * harmonics
    level = np.exp(-(((f - first) / 150) ** 2)) + 0.6 * np.exp(-(((f - second) / 250) ** 2)) + 0.02
    sound = (level * np.sin(2 * np.pi * f * t)).sum(axis=0)
    loud = np.clip(np.sin(2 * np.pi * t / syllable_s), 0, 1) ** 0.5
    return np.asarray(3000 * sound * loud + rng.normal(0, 5, len(t))).clip(-32767, 32767).astype(np.int16)
