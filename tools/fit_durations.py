#!/usr/bin/env python3
"""Fits the English duration rules to a speaker's measured phones; prints the tables with the values found.

usage: tools/fit_durations.py path/to/grid-s1 [--rounds 12] [--firm 1.0]

Klatt's rules keep their form; their factors and the mean durations of phones are moved, one after the other,
to where the squared difference to the recordings is least (coordinate descent on logarithms), the plan
scaled to their mean. The speaker says quick commands, not news: so every value is held near the one it has
by a penalty, `--firm` times as strong as one that lets a value move by a fifth for a hundredth of the error.
The hundred sentences kept apart in split.json are measured before and after.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from cmudict import token

from fapstream.tts import FrontEnd, phone_set
from fapstream.tts.durations import DurationModel
from fapstream.tts.prosody import _table
from fapstream.tts.sounds import Sound, sounds

LANG = "en"
STEPS = (0.12, 0.05, 0.02)
GIVES = 0.2
"""A change of this size in the logarithm costs a hundredth of the error."""


@dataclass
class Spoken:
    """A word as the front-end plans it, and the measured lengths of its phones, ms."""

    tokens: tuple[str, ...]
    function: bool
    final: bool
    measured: list[float]


def words_of(clips: Mapping[str, Any], names: Sequence[str]) -> list[Spoken]:
    """Words whose phones are the recorded ones."""
    found = []
    for name in names:
        spoken = [w for w in clips[name] if not w[0].startswith("<")]
        text = " ".join(w[0].upper() if len(w[0]) == 1 else w[0] for w in spoken) + "."
        front = FrontEnd(LANG)
        utterances = front.feed(text) + front.end()
        plans = [(u, i) for u in utterances for i in range(len(u.words))]
        if len(plans) != len(spoken):
            continue
        for place, ((utterance, i), said) in enumerate(zip(plans, spoken, strict=True)):
            phones = [p for p in utterance.phones if p.word == i]
            if [p.name for p in phones] == [token(p).rstrip("012") for p, _, _ in said[3]]:
                vowel = {n for n, p in phone_set(LANG).items() if p.kind == "vowel"}
                tokens = tuple(p.name + str(p.stress) if p.name in vowel else p.name for p in phones)
                weak = said[0] in ("at", "by", "in", "with")
                if place:  # the first phone of a recording may have silence in it
                    last = place + 1 == len(plans)
                    found.append(Spoken(tokens, weak, last, [1000 * ms for _, _, ms in said[3]]))
    return found


class Fit:
    """The logarithms of every factor and mean, and the error that they make."""

    def __init__(self, words: Sequence[Spoken], firm: float) -> None:
        self.words = words
        self.firm = firm
        factors = _table()["durations"][LANG]
        self.factors = {k: v for k, v in factors.items() if not isinstance(v, dict)} | {
            f"vowel.{k}": v for k, v in factors["vowel"].items()
        }
        used = {t.rstrip("012") for w in words for t in w.tokens}
        self.means = {n: p.mean_ms for n, p in phone_set(LANG).items() if n in used}
        self.x = dict.fromkeys([*self.factors, *self.means], 0.0)

    def tables(self) -> tuple[dict[str, Any], dict[str, float]]:
        """The factors as in prosody.toml, and means by phone."""
        flat = {k: v * math.exp(self.x[k]) for k, v in self.factors.items()}
        vowel = {k.partition(".")[2]: v for k, v in flat.items() if k.startswith("vowel.")}
        plain = {k: v for k, v in flat.items() if not k.startswith("vowel.")}
        return plain | {"vowel": vowel}, {k: v * math.exp(self.x[k]) for k, v in self.means.items()}

    def planned(self, words: Sequence[Spoken]) -> tuple[np.ndarray, np.ndarray]:
        """Planned and measured ms of every phone, each shape (n,)."""
        factors, means = self.tables()
        model, table = DurationModel(LANG, factors), sounds(LANG, means)
        ours: list[float] = []
        for word in words:
            plan: list[Sound] = [table[t] for t in word.tokens]
            ours += model.word(plan, sum(s.vowel for s in plan), word.function, word.final)
        return np.array(ours), np.array([ms for w in words for ms in w.measured])

    def error(self, words: Sequence[Spoken]) -> float:
        """Root mean square of the differences in measured ms, the plan scaled to the recordings' mean."""
        ours, real = self.planned(words)
        return float(np.sqrt(np.mean((ours * real.mean() / ours.mean() - real) ** 2)))

    def cost(self) -> float:
        """The error, and what the changes cost."""
        changes = sum(v * v for v in self.x.values()) / GIVES**2 * 0.01 * self.firm
        return math.log(self.error(self.words)) + changes / 4

    def fit(self, rounds: int) -> Fit:
        """Moves one value after the other as long as that helps."""
        best = self.cost()
        for step in STEPS:
            for _ in range(rounds):
                before = best
                for name in self.x:
                    for change in (step, -step):
                        self.x[name] += change
                        if (cost := self.cost()) < best:
                            best = cost
                            break
                        self.x[name] -= change
                if before - best < 1e-5:
                    break
            print(f"step {step}: {self.error(self.words):.2f} ms", flush=True)
        return self


def report(name: str, fit: Fit, words: Sequence[Spoken]) -> None:
    """Error and correlation."""
    ours, real = fit.planned(words)
    print(
        f"{name}: RMSE {fit.error(words):.1f} ms, r {np.corrcoef(ours, real)[0, 1]:.3f}, {len(ours)} phones"
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--rounds", type=int, default=12)
    parser.add_argument("--firm", type=float, default=1.0)
    args = parser.parse_args()
    clips = json.loads((args.folder / "phones.json").read_text(encoding="utf-8"))
    split = json.loads((args.folder / "split.json").read_text(encoding="utf-8"))
    other = next(key for key in split if key != "train")
    train, held = words_of(clips, split["train"]), words_of(clips, split[other])
    fit = Fit(train, args.firm)
    report("before, held out", fit, held)
    fit.fit(args.rounds)
    report("after, fitted", fit, train)
    report("after, held out", fit, held)
    factors, means = fit.tables()
    for name, value in factors.items():
        print(
            f"{name} = {value:.2f}"
            if not isinstance(value, dict)
            else f"{name} = { {k: round(v, 2) for k, v in value.items()} }"
        )
    for name, mean in means.items():
        print(f"{name}\t{phone_set(LANG)[name].mean_ms:.0f}\t{mean:.0f}")


if __name__ == "__main__":
    main()
