"""Entries of 1.5 kB over each bus, to one subscriber and to ten, each a process of its own (tasks, for the
bus that is within a process): how many a second when they are published as fast as all subscribers keep up,
how long one takes when twenty talks of 25 entries a second are under way, and what the process in the middle
computes for each entry meanwhile.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager

import numpy as np

from fapstream.ports import Bus
from tests.benchmarks.broker import broker, cpu_s, installed
from tests.benchmarks.bus_process import ACKS, END, Heard, Process, bus_at, entry, listen, process

BUSES = ("local", "hub", "redis")
SUBSCRIBERS = (1, 10)
TALKS = 20
RATE_HZ = 25
WINDOW = 200
"""Entries that the slowest subscriber may be behind."""


@contextmanager
def middle(kind: str) -> Iterator[tuple[str, int | None]]:
    """The address of a bus, and the process in its middle."""
    if kind == "hub":
        with process("hub") as hub:
            yield f"hub:{hub.line}", hub.pid
    elif kind == "redis":
        with broker() as redis:
            redis.start()
            yield redis.url, redis.pid
    else:
        yield "", None


class Audience:
    """Subscribers of some channels, and what they heard."""

    def __init__(self, address: str, bus: Bus, size: int, channels: list[str]) -> None:
        self._stack = ExitStack()
        self._heard: list[Heard] = []
        self._tasks: list[asyncio.Task[None]] = []
        self._processes: list[Process] = []
        for name in map(str, range(size)):
            if address:
                made = process("listen", address, name, *channels)
                self._processes.append(self._stack.enter_context(made))
            else:
                self._heard.append(Heard())
                each = [listen(bus, channel, name, self._heard[-1]) for channel in channels]
                self._tasks += [asyncio.create_task(one) for one in each]

    async def heard(self) -> list[Heard]:
        """When all channels have ended."""
        await asyncio.gather(*self._tasks)
        return self._heard + [await asyncio.to_thread(p.heard) for p in self._processes]

    def close(self) -> None:
        """End the processes."""
        self._stack.close()


async def hurry(bus: Bus, channel: str, size: int, count: int) -> float:
    """Entries a second that all subscribers keep up with."""
    behind = dict.fromkeys(map(str, range(size)), 0)
    acks = bus.subscribe(ACKS)
    await asyncio.sleep(0.3)

    async def hear() -> None:
        async for ack in acks:
            if ack is not None:
                name, number = ack.decode().split()
                behind[name] = int(number)

    hearing = asyncio.create_task(hear())
    start = time.perf_counter()
    for number in range(count):
        while number - min(behind.values()) > WINDOW:
            await asyncio.sleep(0)
        bus.publish(channel, entry(number))
    while min(behind.values()) < count:
        await asyncio.sleep(0)
    taken = time.perf_counter() - start
    bus.publish(channel, entry(END))
    await acks.aclose()
    await hearing
    return count / taken


async def talk(bus: Bus, channels: list[str], seconds: float) -> int:
    """All channels at the pace of talks; how many entries there were."""
    start = time.perf_counter()
    total = round(seconds * RATE_HZ) * len(channels)
    for k in range(total):
        due = start + k / (RATE_HZ * len(channels))
        if (early := due - time.perf_counter()) > 0:
            await asyncio.sleep(early)
        bus.publish(channels[k % len(channels)], entry(k // len(channels)))
    for channel in channels:
        bus.publish(channel, entry(END))
    return total


async def measure(kind: str, size: int, args: argparse.Namespace) -> dict[str, float]:
    """The figures of one bus with so many subscribers."""
    talks = [f"talk{k}" for k in range(args.talks)]
    with middle(kind) as (address, pid):
        bus = bus_at(address)
        computed: Callable[[], float] = lambda: cpu_s(pid) if pid else 0.0  # noqa: E731
        fast = Audience(address, bus, size, ["fast"])
        rate = await hurry(bus, "fast", size, args.count // (1 if kind != "redis" else 4))
        lost = sum(h.gaps + h.wrong for h in await fast.heard())
        fast.close()
        steady = Audience(address, bus, size, talks)
        await asyncio.sleep(0.3)
        before = computed()
        entries = await talk(bus, talks, args.seconds)
        after = computed()
        heard = await steady.heard()
        steady.close()
        await bus.aclose()
    waited = np.concatenate([h.latencies_ms for h in heard])
    return {
        "per_s": round(rate),
        "p50_ms": round(float(np.percentile(waited, 50)), 3),
        "p99_ms": round(float(np.percentile(waited, 99)), 3),
        "middle_us": round(1e6 * (after - before) / entries, 1),
        "lost": lost + sum(h.gaps + h.wrong for h in heard),
    }


def main() -> None:
    """Print the table, or one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--count", type=int, default=20_000, help="entries at full speed")
    parser.add_argument("--talks", type=int, default=TALKS)
    parser.add_argument("--seconds", type=float, default=4.0, help="of talks")
    args = parser.parse_args()
    kinds = [kind for kind in BUSES if kind != "redis" or installed()]
    rows = {(k, n): asyncio.run(measure(k, n, args)) for k in kinds for n in SUBSCRIBERS}
    if args.json:
        print(json.dumps({f"{k}_{n}_{what}": x for (k, n), row in rows.items() for what, x in row.items()}))
        return
    print(
        f"{'bus':<8}{'listeners':>12}{'entries/s':>12}{'p50 ms':>9}{'p99 ms':>9}{'middle us':>11}{'lost':>6}"
    )
    for (kind, size), row in rows.items():
        print(
            f"{kind:<8}{size:>12}{row['per_s']:>12.0f}{row['p50_ms']:>9.2f}{row['p99_ms']:>9.2f}"
            f"{row['middle_us']:>11.1f}{row['lost']:>6.0f}"
        )


if __name__ == "__main__":
    main()
