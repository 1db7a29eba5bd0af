"""Processes around a bus: the hub, and listeners that say what they heard.

`hub [PATH]`: prints its socket. `listen ADDRESS NAME CHANNEL...`: prints `ready`, and at the end of all its
channels what it heard, as JSON. Both end with their input. An address is `hub:PATH` or a Redis server's.
"""

from __future__ import annotations

import asyncio
import json
import os
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from typing import IO, Any

from fapstream.adapters.bus import Hub, HubBus, open_bus
from fapstream.ports import Bus

MARK = struct.Struct("!QQ")
END = (1 << 64) - 1
SIZE = 1500
ACKS = "acks"
ACK_EVERY = 50


def entry(number: int) -> bytes:
    """An entry of a talk's size that knows when it was made."""
    return MARK.pack(time.monotonic_ns(), number).ljust(SIZE, b"\0")


def bus_at(address: str) -> Bus:
    """The bus of a process."""
    return HubBus(address[4:]) if address.startswith("hub:") else open_bus(address or None)


@dataclass
class Heard:
    """What came over the channels together."""

    entries: int = 0
    gaps: int = 0
    wrong: int = 0
    """Entries out of order, repeated, or missing without a gap."""
    first: list[int] = field(default_factory=list)
    """Number of the first entry of each channel."""
    latencies_ms: list[float] = field(default_factory=list)


async def listen(bus: Bus, channel: str, name: str, heard: Heard) -> None:
    """Until the end of a channel; every so often the others are told how many entries came."""
    last, gap = -1, True
    subscription = bus.subscribe(channel)
    async for got in subscription:
        if got is None:
            heard.gaps += 1
            gap = True
            continue
        made, number = MARK.unpack_from(got)
        if number == END:
            break
        heard.latencies_ms.append((time.monotonic_ns() - made) / 1e6)
        heard.wrong += not (number == last + 1 or (gap and number > last))
        if last < 0:
            heard.first.append(number)
        last, gap = number, False
        heard.entries += 1
        if heard.entries % ACK_EVERY == 0:
            bus.publish(ACKS, f"{name} {heard.entries}".encode())
    await subscription.aclose()


async def _listening(address: str, name: str, channels: list[str]) -> None:
    bus = bus_at(address)
    asyncio.get_running_loop().run_in_executor(None, _end_with_input)
    heard = Heard()
    tasks = [asyncio.create_task(listen(bus, channel, name, heard)) for channel in channels]
    while not bus.connected:
        await asyncio.sleep(0.01)
    print("ready", flush=True)
    await asyncio.gather(*tasks)
    await bus.aclose()
    print(json.dumps(asdict(heard)), flush=True)


def _end_with_input() -> None:
    sys.stdin.read()
    os._exit(0)


async def _hub(path: str | None) -> None:
    hub = Hub(path)
    await hub.start()
    print(hub.path, flush=True)
    await asyncio.to_thread(sys.stdin.read)
    await hub.aclose()


class Process:
    """One of these, from outside."""

    def __init__(self, *arguments: str) -> None:
        command = [sys.executable, "-m", "tests.benchmarks.bus_process", *arguments]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.pid = self._process.pid
        self.line = self._out.readline().strip()
        """What it printed first."""

    @property
    def _out(self) -> IO[str]:
        assert self._process.stdout
        return self._process.stdout

    def heard(self) -> Heard:
        """What a listener heard, when it is done."""
        found: dict[str, Any] = json.loads(self._out.readline())
        return Heard(**found)

    def end(self) -> None:
        """End it, if it has not ended: a hub by the end of its input, so that it tidies up."""
        assert self._process.stdin
        self._process.stdin.close()
        try:
            self._process.wait(2.0)
        except subprocess.TimeoutExpired:
            self.kill()
        self._out.close()

    def kill(self) -> None:
        """As a crash would."""
        self._process.kill()
        self._process.wait()


@contextmanager
def process(*arguments: str) -> Iterator[Process]:
    """One that ends with the block."""
    made = Process(*arguments)
    try:
        yield made
    finally:
        made.end()


if __name__ == "__main__":
    if sys.argv[1] == "hub":
        asyncio.run(_hub(sys.argv[2] if len(sys.argv) > 2 else None))
    else:
        asyncio.run(_listening(sys.argv[2], sys.argv[3], sys.argv[4:]))
