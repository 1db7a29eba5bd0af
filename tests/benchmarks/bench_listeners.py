"""One talk to many listeners from one core, beside a bare `websockets` broadcast of equal bytes.

Server and bare broadcast run on one core, the listeners and the speaker on the others. 25 packets a second
reach each listener. Jitter is how far a delivery lies behind the earliest pace: arrival minus the packet's
place in the sound, less the least such difference of that listener in the run. CPU is of the serving process.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

import msgpack
import numpy as np

from fapstream.protocol import generated as g
from tests.benchmarks.load import RawSocket, Talker, Tally, connect, cpu_s, raise_file_limit
from tests.benchmarks.server import server

PACKET_BYTES = 1500
CONNECTING_S = 4.0
"""What the listeners take to connect, spread out."""

BARE = """
import asyncio, os, resource, sys
from websockets.asyncio.server import broadcast, serve
hard = resource.getrlimit(resource.RLIMIT_NOFILE)[1]
resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))
clients = set()
async def handle(socket):
    clients.add(socket)
    await socket.wait_closed()
async def main():
    size = int(sys.argv[1])
    async with serve(handle, "127.0.0.1", 0, compression=None, subprotocols=["fapstream.v1"]) as server:
        print(server.sockets[0].getsockname()[1], flush=True)
        loop = asyncio.get_running_loop()
        due = loop.time()
        while True:
            due += 0.04
            await asyncio.sleep(max(0, due - loop.time()))
            broadcast(clients, bytes(size))
asyncio.run(main())
"""


class Listener:
    """Notes when packets come."""

    def __init__(self) -> None:
        self.times: list[tuple[float, float]] = []
        """(arrival, place in the sound) in seconds, since `clear`."""
        self.bytes = self.skips = 0
        self.errors: list[str] = []
        self.socket: RawSocket | None = None
        self._rate = 16000

    async def start(self, address: str) -> None:
        """Connect and listen."""
        self.socket = await connect(address, self._take)
        self.socket.send(g.Listen(channel="news"))

    def _take(self, data: bytes) -> None:
        now = time.perf_counter()
        self.bytes += len(data)
        message = msgpack.unpackb(data)
        kind = message["type"]
        if kind == "packet":
            self.times.append((now, message["turn"] * 1e6 + message["sample"] / self._rate))
        elif kind == "begin":
            self._rate = message["sample_rate"]
        elif kind == "skip":
            self.skips += 1
        elif kind == "error":
            self.errors.append(message["code"])


def jitters_ms(listeners: list[Listener]) -> np.ndarray:
    """Of every packet of every listener; turns by themselves."""
    out = []
    for one in listeners:
        times = np.array(one.times)
        for turn in np.unique(times[:, 1] // 1e6) if len(times) else ():
            of_turn = times[times[:, 1] // 1e6 == turn]
            late = of_turn[:, 0] - of_turn[:, 1]
            out.append(1000 * (late - late.min()))
    return np.concatenate(out) if out else np.zeros(0)


@contextmanager
def bare(size: int) -> Iterator[tuple[str, int]]:
    """Address and pid of a process that broadcasts so many bytes 25 times a second."""
    process = subprocess.Popen([sys.executable, "-c", BARE, str(size)], stdout=subprocess.PIPE, text=True)
    assert process.stdout
    try:
        yield f"127.0.0.1:{process.stdout.readline().strip()}", process.pid
    finally:
        process.kill()
        process.wait()


def pin(pid: int, core: int) -> None:
    """Keep a process and its threads on one core."""
    for task in os.listdir(f"/proc/{pid}/task"):
        os.sched_setaffinity(int(task), {core})


async def bare_cost(n: int, size: int, seconds: float) -> float:
    """CPU microseconds of a bare broadcast per listener-second."""
    with bare(size) as (address, pid):
        pin(pid, 0)
        sockets = []
        for _ in range(n):
            sockets.append(await connect(address, lambda data: None))
            await asyncio.sleep(CONNECTING_S / n)
        before = sum(cpu_s(pid).values())
        await asyncio.sleep(seconds)
        spent = sum(cpu_s(pid).values()) - before
        for socket in sockets:
            socket.transport.abort()
    return 1e6 * spent / seconds / n


async def ours(address: str, pid: int, n: int, seconds: float) -> dict[str, float]:
    """The same through the server, while one speaks."""
    pin(pid, 0)
    tally = Tally()
    talker = Talker(0, tally, [("us1", "en")], sentences=60, channel="news")
    listeners = [Listener() for _ in range(n)]
    for listener in listeners:
        await listener.start(address)
        await asyncio.sleep(CONNECTING_S / n)
    await talker.start(address)
    await asyncio.sleep(3.0)
    for listener in listeners:
        listener.times.clear()
        listener.bytes = listener.skips = 0
    before = sum(cpu_s(pid).values())
    await asyncio.sleep(seconds)
    spent = sum(cpu_s(pid).values()) - before
    jitter = jitters_ms(listeners)
    packets = [len(one.times) for one in listeners]
    found = {
        "us_per_listener_s": 1e6 * spent / seconds / n,
        "jitter_ms_p50": float(np.percentile(jitter, 50)),
        "jitter_ms_p99": float(np.percentile(jitter, 99)),
        "packets_per_s": float(np.mean(packets)) / seconds,
        "least_packets_per_s": min(packets) / seconds,
        "bytes_per_packet": sum(one.bytes for one in listeners) / max(1, sum(packets)),
        "skips": float(sum(one.skips for one in listeners)),
        "lost": float(sum(one.socket.closed for one in listeners if one.socket)),
        "errors": float(sum(len(one.errors) for one in listeners)),
    }
    talker.stop()
    for listener in listeners:
        assert listener.socket
        listener.socket.transport.abort()
    return found


async def measure(n: int, seconds: float) -> dict[str, float]:
    """Both, one after the other, and the ratio."""
    os.sched_setaffinity(0, set(range(1, os.cpu_count() or 2)) or {0})
    options = ("--channel", "news", "--max-listeners", str(n), "--max-listeners-per-address", str(n))
    with server(*options) as (address, pid):
        found = await ours(address, pid, n, seconds)
    size = round(found["bytes_per_packet"])
    found["bare_us_per_listener_s"] = await bare_cost(n, size, seconds)
    found["cpu_vs_bare"] = found["us_per_listener_s"] / found["bare_us_per_listener_s"]
    return found


def main() -> None:
    """Print the table, or one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--listeners", type=int, default=1000)
    parser.add_argument("--seconds", type=float, default=20.0)
    args = parser.parse_args()
    raise_file_limit()
    found = asyncio.run(measure(args.listeners, args.seconds))
    whole = found["least_packets_per_s"] > 24.5 and not (found["skips"] or found["lost"] or found["errors"])
    held = args.listeners if whole and found["jitter_ms_p99"] < 40 else 0
    if args.json:
        print(json.dumps({"listeners": held} | {k: round(v, 3) for k, v in found.items()}))
        return
    print(f"{args.listeners} listeners for {args.seconds:g} s: {'held' if held else 'NOT held'}")
    for name, value in found.items():
        print(f"  {name:<28}{value:>12.2f}")


if __name__ == "__main__":
    main()
