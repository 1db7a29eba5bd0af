"""Sessions that speak at the same time, each with its own text and voice, on the processors of this machine.

The load runs on the same processors. A packet's lateness is its arrival after the time that the server's
schedule gives it (at most 1.5 s ahead of what is heard); a level holds if 99 in 100 are less than 40 ms late
and no simulated sound card ran dry. The floor is what MBROLA itself takes for the same speech in that run.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import time
from collections import Counter
from dataclasses import dataclass

import numpy as np

from tests.benchmarks.adapting import adapt
from tests.benchmarks.load import Talker, Tally, cpu_s, raise_file_limit
from tests.benchmarks.server import server

VOICES = [("us1", "en"), ("us2", "en"), ("en1", "en"), ("gr2", "el")]
RAMP_PER_S = 25.0
SETTLE_S = 4.0
REACH_MS = 40.0


@dataclass(frozen=True, slots=True)
class Level:
    """What was measured with so many talkers."""

    talkers: int
    lateness_ms: tuple[float, float, float]
    """p50, p99, most."""
    first_ms: tuple[float, float]
    """Text to first packet, p50 and p99."""
    underruns: int
    errors: Counter[str]
    """By code, from this level's first newcomer on."""
    sound_share: float
    """Sound that came for each second of each talker; some time passes between turns."""
    cpu_ms: dict[str, float]
    """By program, for each second of speech."""
    load_ms: float
    """The same of the clients."""

    @property
    def holds(self) -> bool:
        """Whether nobody stuttered."""
        return self.lateness_ms[1] < REACH_MS and not self.underruns and not self.errors


async def measure(address: str, pid: int, levels: list[int], seconds: float, pages: int) -> list[Level]:
    """Ever more talkers, until a level does not hold; so many pages make heads all the while."""
    tally, talkers, out = Tally(), list[Talker](), list[Level]()
    adapting = [asyncio.create_task(adapt(address)) for _ in range(pages)]
    for level in levels:
        tally.errors.clear()
        for number in range(len(talkers), level):
            talkers.append(Talker(number, tally, VOICES))
            await talkers[-1].start(address)
            await asyncio.sleep(1 / RAMP_PER_S)
        await asyncio.sleep(SETTLE_S)
        tally.clear()
        before, load, start = cpu_s(pid), time.process_time(), time.perf_counter()
        await asyncio.sleep(seconds)
        out.append(_level(level, tally, (before, cpu_s(pid)), time.process_time() - load, start))
        if not out[-1].holds:
            break
    for talker in talkers:
        talker.stop()
    for page in adapting:
        page.cancel()
    await asyncio.gather(*adapting, return_exceptions=True)
    await asyncio.sleep(0.5)
    return out


def _level(
    level: int,
    tally: Tally,
    cpu: tuple[dict[str, float], dict[str, float]],
    load: float,
    start: float,
) -> Level:
    late = np.percentile(tally.lateness_ms, [50, 99, 100])
    first = np.percentile(tally.first_ms or [0.0], [50, 99])
    spent = {name: 1000 * (value - cpu[0].get(name, 0.0)) / tally.sound_s for name, value in cpu[1].items()}
    share = tally.sound_s / (time.perf_counter() - start) / level
    return Level(
        level, (late[0], late[1], late[2]), (first[0], first[1]), tally.underruns, Counter(tally.errors),
        share, spent,
        1000 * load / tally.sound_s,
    )  # fmt: skip


def main() -> None:
    """Print the table, or one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--levels", default="100,200,300,350,400", help="numbers of talkers, ascending")
    parser.add_argument("--seconds", type=float, default=15.0, help="measured at each level")
    parser.add_argument("--adapting", type=int, default=0, help="pages that make heads at the same time")
    args = parser.parse_args()
    raise_file_limit()
    levels = [int(text) for text in args.levels.split(",")]
    most = str(10 * levels[-1])
    cores = str(os.cpu_count() or 1)
    options = ("--workers", cores, "--max-sessions", most, "--max-sessions-per-address", most)
    with server(*options) as (address, pid):
        found = asyncio.run(measure(address, pid, levels, args.seconds, args.adapting))
    held = [level for level in found if level.holds]
    if args.json:
        print(json.dumps(_figures(found, held)))
        return
    print(f"{'talkers':>8}{'late p50':>10}{'p99':>8}{'most':>8}{'first p99':>11}{'underruns':>11}"
          f"{'server':>9}{'mbrola':>8}{'clients':>9}  ms; CPU ms per second of speech")  # fmt: skip
    for x in found:
        print(f"{x.talkers:>8}{x.lateness_ms[0]:>10.1f}{x.lateness_ms[1]:>8.1f}{x.lateness_ms[2]:>8.1f}"
              f"{x.first_ms[1]:>11.1f}{x.underruns:>11}{x.cpu_ms.get('python', 0.0):>9.2f}"
              f"{x.cpu_ms.get('mbrola', 0.0):>8.2f}{x.load_ms:>9.2f}"
              f"{'' if x.holds else '  NOT held'} {dict(x.errors) or ''}")  # fmt: skip


def _figures(found: list[Level], held: list[Level]) -> dict[str, float]:
    best = held[-1] if held else found[0]
    return {
        "talkers": held[-1].talkers if held else 0,
        "lateness_ms_p99": round(best.lateness_ms[1], 2),
        "first_ms_p99": round(best.first_ms[1], 2),
        "underruns": best.underruns,
        "server_cpu_ms_per_talker_s": round(best.cpu_ms.get("python", 0.0), 3),
        "mbrola_cpu_ms_per_talker_s": round(best.cpu_ms.get("mbrola", 0.0), 3),
        "clients_cpu_ms_per_talker_s": round(best.load_ms, 3),
        "times_mbrola": round(
            sum(best.cpu_ms.values()) / max(1e-9, best.cpu_ms.get("mbrola", 0.0)), 1
        ),
    }  # fmt: skip


if __name__ == "__main__":
    main()
