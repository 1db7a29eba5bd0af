"""Writes protocol/vectors/jitter.json and stretch.json: arrival patterns and the targets that follow, sounds
and the periods found in them, for both languages.

python tools/build_jitter_vectors.py
"""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from fapstream.stream import stretch
from fapstream.stream.jitter import Jitter

OUT = Path(__file__).parents[1] / "protocol/vectors"
PACKET_S = 0.04
STEPS = 240


def delays(pattern: str, chance: random.Random) -> Iterator[float]:
    """How long each packet is held up, s; those behind one that is late wait for it."""
    for k in range(STEPS):
        if pattern == "steady":
            yield 0.02
        elif pattern == "wifi":
            yield 0.003 + (chance.expovariate(20) if chance.random() < 0.1 else chance.uniform(0, 0.004))
        elif pattern == "mobile":
            yield 0.06 + (chance.uniform(0.1, 0.4) if chance.random() < 0.03 else chance.uniform(0, 0.02))
        elif pattern == "bursts":
            yield PACKET_S * (24 - k % 25)
        else:
            yield 0.3 if k == 120 else 0.0


def arrivals(pattern: str) -> list[list[Any]]:
    """Steps: ["packet", end, arrival], and an underrun, a restart and a packet of no live talk."""
    chance, steps, now = random.Random(pattern), [], 0.0
    for k, delay in enumerate(delays(pattern, chance)):
        end = round((k + 1) * PACKET_S, 6)
        now = max(now, round(end + delay, 6))
        steps.append(["packet", end, now])
        if k == 150:
            steps.append(["underrun", 0.13])
        if k == 180:
            steps += [["restart"], ["ease", round(now + 0.02, 6)]]
    return steps


def case(pattern: str) -> dict[str, Any]:
    """The target after every step, to a millionth of a second."""
    jitter, targets = Jitter(), []
    steps = arrivals(pattern)
    for name, *times in steps:
        {
            "packet": jitter.observe,
            "underrun": jitter.underrun,
            "restart": jitter.restart,
            "ease": jitter.ease,
        }[name](*times)
        targets.append(round(jitter.target_s, 6))
    return {"pattern": pattern, "steps": steps, "targets": targets}


def voice(f0: float, rate: int, seconds: float) -> list[int]:
    """A voice of three partials that grows weaker, as int16."""
    t = np.arange(round(rate * seconds)) / rate
    sound = sum(a * np.sin(2 * np.pi * k * f0 * t + k) for k, a in ((1, 0.3), (3, 0.2), (7, 0.1)))
    return [int(v) for v in np.rint(32_768 * np.asarray(sound) * np.exp(-3 * t))]


def period_case(f0: float, rate: int, way: int) -> dict[str, Any]:
    """A sound, the period found in its middle, and what follows when it breaks off."""
    pcm = voice(f0, rate, 0.08)
    sound, at = np.array(pcm) / 32_768, len(pcm) // 2
    lag, alike = stretch.period(sound, at, way, rate)
    fall = stretch.fall(sound, rate, 0.04)
    return {
        "rate": rate, "pcm": {"i16": pcm}, "at": at, "way": way, "lag": lag, "alike": round(alike, 6),
        "fall": [round(float(v), 6) for v in fall[::16]],
    }  # fmt: skip


def write(name: str, cases: list[dict[str, Any]]) -> None:
    lines = ",\n".join(json.dumps(c, separators=(", ", ": ")) for c in cases)
    (OUT / name).write_text(f"[\n{lines}\n]\n", encoding="utf-8")


def main() -> None:
    write("jitter.json", [case(p) for p in ("steady", "wifi", "mobile", "bursts", "stall")])
    sounds = [(97.0, 16_000), (171.0, 22_050)]
    write("stretch.json", [period_case(f0, rate, way) for f0, rate in sounds for way in (1, -1)])


if __name__ == "__main__":
    main()
