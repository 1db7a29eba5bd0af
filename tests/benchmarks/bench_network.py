"""What a listener's player makes of bad networks: the viewer's own code on a made-up link and clock.

usage: tools/bench network [--json]

Each pattern once as an own turn (sent up to 1.5 s ahead) and once as a live talk (sent as it is said),
beside what a fixed prebuffer of 80 ms does with the same packets. Underruns; dry: how long the sound was
missing; store: the mean of what lies in the player, which is latency in a live talk; stretched: of the
sound, in percent; skew: picture minus sound, p95 of the absolute value over pictures at 60 Hz, the sound
being found again in what the card was given.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import random
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray

from fapstream.records import Packet, Pcm
from fapstream.stream import Pacer, Playback
from fapstream.stream.jitter import Jitter
from fapstream.stream.voice import Voice
from tests.benchmarks.speech import spoken

TEXT = Path(__file__).parent / "data" / "udhr_en.txt"
CHARACTERS = 900
STEP_S, BLOCK_S, ACK_S = 0.005, 0.02, 0.25
LATENCY_S = 0.04
"""From the card to the ear."""
DRAWN_S = 0.008
"""How long a picture takes, which the viewer knows."""
PICTURES_PER_S = 60
LOOKED_AT = 4
"""Every so many pictures the sound is sought."""
SOUGHT_S, COMPARED_S = 0.08, 0.04
ALIKE = 0.6
LOUD = 0.01
PREBUFFER_S = 0.08

Delay = Callable[[float, random.Random], float]
"""(when it is sent, chance): how long the network keeps it, s."""


def lan(_: float, chance: random.Random) -> float:
    return 0.001 + chance.uniform(0, 0.001)


def wifi(at: float, chance: random.Random) -> float:
    held = 0.2 * (at % 0.2 < 0.04) * chance.uniform(0, 0.5)
    return 0.003 + held + chance.uniform(0, 0.003)


def mobile(_: float, chance: random.Random) -> float:
    spike = chance.uniform(0.1, 0.34) if chance.random() < 0.012 else 0.0
    return 0.06 + spike + chance.uniform(0, 0.015)


def away(start: float, seconds: float) -> Delay:
    """A network that delivers nothing for a while, and then all of it."""
    return lambda at, chance: lan(at, chance) + max(0.0, start + seconds - at) * (at >= start)


def bursts(at: float, _: random.Random) -> float:
    return 1.0 - at % 1.0


@dataclass(frozen=True, slots=True)
class Pattern:
    """How a network behaves. `ppm`: the sender's clock is so much slower than the card's."""

    delay: Delay
    ppm: float = 0.0
    seconds: float = 40.0


PATTERNS = {
    "good LAN": Pattern(lan),
    "home wifi": Pattern(wifi),
    "4G": Pattern(mobile),
    "stall of 300 ms": Pattern(away(12.0, 0.3)),
    "2 s lost": Pattern(away(12.0, 2.0)),
    "bursts, one a second": Pattern(bursts),
    "clock +200 ppm": Pattern(lan, 200.0, 240.0),
    "clock -200 ppm": Pattern(lan, -200.0, 240.0),
}


@dataclass(slots=True)
class Sender:
    """A server: packets of a talk that repeats itself, when they arrive. `now` passes in steps."""

    rate: int
    packets: list[Packet]
    pattern: Pattern
    live: bool
    chance: random.Random
    pacer: Pacer = field(init=False)
    sent: int = 0
    _number: int = 0
    _arrived: float = 0.0
    _link: list[tuple[float, Packet]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.pacer = Pacer(self.rate)

    def arriving(self, now: float) -> list[Packet]:
        """What comes until `now`, in order."""
        clock = now * (1 - 1e-6 * self.pattern.ppm)
        while self._due(clock):
            packet = self.packets[self._number % len(self.packets)]
            start, self._number = self.sent, self._number + 1
            self.sent += len(packet.pcm)
            self.pacer.sent(start, self.sent, clock)
            self._arrived = max(self._arrived, now + self.pattern.delay(now, self.chance))
            self._link.append((self._arrived, Packet(1, start, packet.pcm)))
        there = [packet for at, packet in self._link if at <= now]
        del self._link[: len(there)]
        return there

    def _due(self, clock: float) -> bool:
        ready = clock if self.live else np.inf
        length = len(self.packets[self._number % len(self.packets)].pcm)
        return (self.sent + length) / self.rate <= ready and self.pacer.due(self.sent, clock) <= clock


class Fixed(Jitter):
    """What was before: so much in store, whatever the network is like."""

    def __init__(self) -> None:
        super().__init__()
        self.target_s = PREBUFFER_S

    def observe(self, end_s: float, arrival_s: float) -> float:
        return 0.0

    def underrun(self, dry_s: float) -> None:
        """No matter."""

    def ease(self, now_s: float) -> None:
        """No matter."""


@dataclass(slots=True)
class Watched:
    """One talk as it was played: what the card was given, what pictures showed when, and stores in ms."""

    out: Pcm
    pictures: list[tuple[float, float]]
    stores: list[float]
    dry_s: float
    playback: Playback


def watch(sender: Sender, fixed: bool) -> Watched:
    """Play it all."""
    playback = Playback(sender.rate)
    if fixed:
        playback.player._jitter = Fixed()
    playback.player.begin(1, sender.live)
    chance, blocks = random.Random(9), list[Pcm]()
    pictures, stores, dry = list[tuple[float, float]](), list[float](), 0.0
    for k in range(round(sender.pattern.seconds / STEP_S)):
        now = k * STEP_S
        for packet in sender.arriving(now):
            playback.player.push(1, packet.start, packet.pcm)
        if k % round(BLOCK_S / STEP_S) == 0:
            at = now + LATENCY_S + chance.uniform(-0.001, 0.001)
            blocks.append(playback.render(round(BLOCK_S * sender.rate), at))
            heard = playback.heard(now)
            if heard is not None:
                stores.append(playback.player.stats.store_ms)
                dry += BLOCK_S * (heard.state == "starved")
        if k % round(ACK_S / STEP_S) == 0 and (heard := playback.heard(now)) and heard.state == "playing":
            sender.pacer.acknowledge(int(heard.sample), now)
        if int(now * PICTURES_PER_S) != int((now - STEP_S) * PICTURES_PER_S):
            shown = playback.heard(now + DRAWN_S)
            if shown is not None and shown.state == "playing":
                pictures.append((now, shown.sample))
    return Watched(np.concatenate(blocks), pictures, stores, dry, playback)


def skews_ms(watched: Watched, source: NDArray[np.float64], rate: int) -> list[float]:
    """Picture minus sound where there is sound to be found, in the middle of the time that a picture is seen.

    Sound that is nowhere near counts as all that was looked at.
    """
    found, half, reach = [], round(COMPARED_S * rate / 2), round(SOUGHT_S * rate)
    for at, sample in watched.pictures[::LOOKED_AT]:
        middle = round((at + DRAWN_S + 0.5 / PICTURES_PER_S - LATENCY_S) * rate)
        heard = watched.out[max(0, middle - half) : middle + half] / 32_768
        if len(heard) < 2 * half or heard @ heard < LOUD**2 * len(heard):
            continue
        center = round(sample)
        where = np.arange(center - reach - half, center + reach + half) % len(source)
        near = source[where]
        likeness = np.correlate(near, heard, "valid")
        power = np.convolve(near**2, np.ones(2 * half), "valid")
        likeness /= np.sqrt(np.maximum(1e-9, power) * (heard @ heard))
        best = int(np.argmax(likeness))
        off = best - reach if likeness[best] > ALIKE else reach
        found.append(-1000 * off / rate)
    return found


def measure(sender: Sender, source: NDArray[np.float64], fixed: bool) -> dict[str, float]:
    """One talk."""
    if fixed:
        with patch.object(Voice, "fit", lambda self, frame: 0):
            watched = watch(sender, fixed)
    else:
        watched = watch(sender, fixed)
    stats = watched.playback.player.stats
    skews = np.abs(skews_ms(watched, source, sender.rate))
    return {
        "underruns": stats.underruns,
        "dry_ms": round(1000 * watched.dry_s),
        "added_delay_ms": round(float(np.mean(watched.stores)), 1),
        "stretched_percent": round(0.1 * stats.stretched_ms / sender.pattern.seconds, 2),
        "skew_ms_p95": round(float(np.percentile(skews, 95)), 1),
    }


def run(rate: int, packets: list[Packet]) -> dict[str, Any]:
    """All patterns, and the worst or mean of them."""
    source = np.concatenate([packet.pcm for packet in packets]) / 32_768
    patterns: dict[str, Any] = {}
    for name, pattern in PATTERNS.items():
        patterns[name] = {}
        for kind in ("own", "live"):
            for how in ("", "_fixed"):
                sender = Sender(rate, packets, pattern, kind == "live", random.Random(name))
                patterns[name][kind + how] = measure(sender, source, how == "_fixed")

    def all_of(how: str) -> dict[str, float]:
        runs = [p[kind + how] for p in patterns.values() for kind in ("own", "live")]
        return {
            "skew_ms_p95": max(r["skew_ms_p95"] for r in runs),
            "underruns": sum(r["underruns"] for r in runs),
            "dry_ms": sum(r["dry_ms"] for r in runs),
            "added_delay_ms": round(
                float(np.mean([p["live" + how]["added_delay_ms"] for p in patterns.values()])), 1
            ),
        }

    return {**all_of(""), "fixed": all_of("_fixed"), "patterns": patterns}


def main() -> None:
    """Print the table, or one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    args = parser.parse_args()
    rate, packets = asyncio.run(spoken(TEXT.read_text(encoding="utf-8")[:CHARACTERS]))
    packets = [packet for packet in packets if len(packet.pcm) == len(packets[0].pcm)]
    figures = run(rate, packets)
    if args.json:
        print(json.dumps(figures))
        return
    heads = ("underruns", "dry ms", "store ms", "stretched %", "skew p95 ms")
    print(f"{'':<36}{''.join(f'{head:>13}' for head in heads)}")
    for name, kinds in figures["patterns"].items():
        for kind, found in kinds.items():
            values = "".join(f"{value:>13}" for value in found.values())
            print(f"{name:<22}{kind.replace('_', ', '):<14}{values}")
    for name, found in (("all", figures), ("all, fixed", figures["fixed"])):
        skew, u, dry, store = (found[key] for key in ("skew_ms_p95", "underruns", "dry_ms", "added_delay_ms"))
        print(f"{name}: skew at most {skew} ms, {u} underruns, {dry} ms dry, live store {store} ms")


if __name__ == "__main__":
    main()
