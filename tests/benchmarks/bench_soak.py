"""Treat a server as the internet does, for as long as you like: talkers, listeners, visitors, interruptions,
connections that break, killed voices. Prints a line a minute; fails on any leak, stutter or untyped error.

    tools/bench soak [--minutes 30] [--talkers 60]
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import random
import signal
import sys
import time
from pathlib import Path

import numpy as np

from fapstream.client import ServerError, connect
from fapstream.client import Talker as Client
from fapstream.protocol import generated as g
from tests.benchmarks.bench_listeners import Listener
from tests.benchmarks.bench_memory import visit
from tests.benchmarks.bench_talkers import VOICES
from tests.benchmarks.load import Talker, Tally, pss_kb, raise_file_limit, tree
from tests.benchmarks.server import server
from tests.e2e.link import Link

LATE_MS = 120.0
"""99 in 100 packets have to be earlier, while voices are killed and connections break."""
WARM_S = 300.0
"""After so long all workers have touched what they have in common, and sessions that linger end as fast as
they come."""
SETTLED_S = g.LINGER_MS / 1000 + 5
"""After so long the first sessions that linger have ended; measuring begins."""
GROWTH, SHORT_GROWTH = 1.05, 1.10
"""How much memory may grow once workers are warm; in a run that is over before, since measuring began."""
TEXT = "This is said while much else goes on, and it is interrupted, revised, paused and said again. " * 2


class Soak:
    """What goes on at the same time, and what went wrong."""

    def __init__(self, address: str, pid: int, chance: random.Random) -> None:
        self.address, self.pid, self.chance = address, pid, chance
        self.tally = Tally()
        self.wrong: list[str] = []
        self.turns = self.visits = self.resumed = self.killed = 0

    async def visitors(self) -> None:
        """Sessions that come and go."""
        while True:
            try:
                await visit(self.address)
                self.visits += 1
            except (OSError, ConnectionError) as e:
                self.wrong.append(f"a visit: {e!r}")
            await asyncio.sleep(0.2)

    async def fickle(self) -> None:
        """A client that changes its mind, over a connection that breaks."""
        async with Link(self.address) as link:
            while True:
                try:
                    async with connect(f"ws://{link.address}/ws") as talker:
                        await self._change_mind(talker, link)
                        self.resumed += talker.connections - 1
                except (ServerError, OSError) as e:
                    if getattr(e, "code", "") != "busy":
                        self.wrong.append(f"a fickle client: {e!r}")
                    await asyncio.sleep(1)

    async def _change_mind(self, talker: Client, link: Link) -> None:
        for _ in range(4):
            turn = await talker.say(TEXT)
            await asyncio.sleep(self.chance.uniform(0.2, 1.5))
            what = self.chance.randrange(5)
            if what == 0:
                await turn.splice(20, "something else. ")
                await turn.end()
            elif what == 1:
                await turn.seek(0)
            elif what == 2:
                await turn.pause()
                await asyncio.sleep(0.5)
                await turn.go_on()
            elif what == 3:
                link.cut()
            await asyncio.sleep(self.chance.uniform(0.2, 1.5))
            await turn.interrupt()
            self.turns += 1

    async def killer(self) -> None:
        """Now and then a voice dies."""
        while True:
            await asyncio.sleep(self.chance.uniform(2, 6))
            voices = [pid for pid in tree(self.pid) if _name(pid) == "mbrola"]
            if voices:
                os.kill(self.chance.choice(voices), signal.SIGKILL)
                self.killed += 1

    def zombies(self) -> int:
        """Ended processes that nobody has taken note of."""
        return sum(_state(pid) == "Z" for pid in tree(self.pid))

    def files(self) -> int:
        """Open files of the server's processes."""
        return sum(len(os.listdir(f"/proc/{pid}/fd")) for pid in tree(self.pid) if _name(pid) != "mbrola")


def _name(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/comm").read_text().strip()
    except OSError:
        return ""


def _state(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return ""


async def soak(address: str, pid: int, seconds: float, talkers: int) -> list[str]:
    """Everything at once; what went wrong."""
    run = Soak(address, pid, random.Random(1))
    load = [Talker(number, run.tally, VOICES) for number in range(talkers)]
    listeners = [Listener() for _ in range(50)]
    speaker = Talker(0, Tally(), [("us1", "en")], channel="news")
    for one in (*load, *listeners, speaker):
        await one.start(address)
        await asyncio.sleep(0.05)
    tasks = [asyncio.create_task(work()) for work in (run.visitors, run.fickle, run.fickle, run.killer)]
    await asyncio.sleep(SETTLED_S)
    run.tally.clear()
    memory, files, start = pss_kb(pid), run.files(), time.monotonic()
    growth = SHORT_GROWTH
    step = min(60.0, seconds / 3)
    while (left := seconds - (time.monotonic() - start)) > 0:
        await asyncio.sleep(min(step, left))
        if growth != GROWTH and time.monotonic() - start >= WARM_S:
            growth, memory = GROWTH, pss_kb(pid)
        late = float(np.percentile(run.tally.lateness_ms or [0.0], 99))
        print(
            f"{time.monotonic() - start:7.0f} s  late p99 {late:6.1f} ms  underruns {run.tally.underruns}  "
            f"visits {run.visits}  turns {run.turns}  resumed {run.resumed}  killed {run.killed}  "
            f"memory {pss_kb(pid) / 1024:.0f} MB  files {run.files()}  zombies {run.zombies()}",
            flush=True,
        )
        if late > LATE_MS:
            run.wrong.append(f"packets were {late:.0f} ms late")
        run.tally.lateness_ms.clear()
    for task in tasks:
        if task.done() and not task.cancelled():
            run.wrong.append(f"a client broke: {task.exception()!r}")
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    if pss_kb(pid) > growth * memory:
        run.wrong.append(f"memory grew from {memory} to {pss_kb(pid)} kB")
    if run.files() > files + 20:
        run.wrong.append(f"open files grew from {files} to {run.files()}")
    await asyncio.sleep(1)
    if run.zombies():
        run.wrong.append(f"{run.zombies()} zombies")
    if run.tally.underruns:
        run.wrong.append(f"{run.tally.underruns} underruns")
    run.wrong += [f"an error: {code}" for code in run.tally.errors]
    run.wrong += [f"a listener was told {code}" for one in listeners for code in one.errors]
    for one in (*load, speaker):
        one.stop()
    await asyncio.sleep(0.5)
    return run.wrong


def main() -> int:
    """0 if nothing went wrong."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--talkers", type=int, default=60)
    parser.add_argument("--json", action="store_true", help="nothing but whether it held, at the end")
    args = parser.parse_args()
    raise_file_limit()
    most = ("--max-sessions-per-address", "999", "--max-listeners-per-address", "999")
    with server("--channel", "news", "--workers", str(os.cpu_count() or 1), *most) as (address, pid):
        wrong = asyncio.run(soak(address, pid, 60 * args.minutes, args.talkers))
    for line in wrong:
        print(f"soak: {line}", file=sys.stderr)
    if args.json:
        print(json.dumps({"held": not wrong, "wrong": wrong[:20]}))
    else:
        print("held" if not wrong else f"NOT held: {len(wrong)} things went wrong")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
