"""What a session costs in memory, and whether any of it stays when sessions come and go.

Proportional set size of the server and its voices: shared pages count by share. The baseline is the
same server before they came.
"""

from __future__ import annotations

import argparse
import asyncio
import json

import msgpack

from fapstream.protocol import generated as g
from tests.benchmarks.bench_listeners import Listener
from tests.benchmarks.bench_talkers import VOICES
from tests.benchmarks.load import Talker, Tally, connect, pss_kb, raise_file_limit
from tests.benchmarks.server import server

AT_ONCE = 40
SETTLE_S = 3.0


async def visit(address: str) -> None:
    """A session that says one word and leaves."""
    over: asyncio.Future[None] = asyncio.get_running_loop().create_future()

    def take(data: bytes) -> None:
        kind = msgpack.unpackb(data)["type"]
        if kind == "ready":
            socket.send(g.Speak(turn=1, text=b"Yes.", voice="us1"))
            socket.send(g.End(turn=1))
        elif kind in ("done", "error") and not over.done():
            over.set_result(None)

    def lost() -> None:
        if not over.done():
            over.set_exception(ConnectionError("lost"))

    socket = await connect(address, take, lost)
    socket.send(g.Hello(client="load"))
    await over
    socket.send(g.Bye())
    socket.transport.close()


async def visits(address: str, n: int) -> None:
    """So many, some at a time."""
    left = n

    async def several() -> None:
        nonlocal left
        while left > 0:
            left -= 1
            await visit(address)

    await asyncio.gather(*(several() for _ in range(AT_ONCE)))


async def idle(address: str, n: int) -> list[object]:
    """Sessions that say nothing."""
    sockets: list[object] = []
    for _ in range(n):
        socket = await connect(address, lambda data: None)
        socket.send(g.Hello(client="load"))
        sockets.append(socket)
    return sockets


async def one_idle(address: str, pid: int, n: int) -> float:
    """kB of a session that says nothing."""
    base = pss_kb(pid)
    sockets = await idle(address, n)
    await asyncio.sleep(SETTLE_S)
    cost = (pss_kb(pid) - base) / n
    for socket in sockets:
        socket.transport.abort()  # type: ignore[attr-defined]
    return cost


async def one_talker(address: str, pid: int, n: int) -> float:
    """kB of a session that speaks, its share of the voices with it."""
    base = pss_kb(pid)
    talkers = [Talker(number, Tally(), VOICES) for number in range(n)]
    for talker in talkers:
        await talker.start(address)
        await asyncio.sleep(0.05)
    await asyncio.sleep(10.0)
    cost = (pss_kb(pid) - base) / n
    for talker in talkers:
        talker.stop()
    await asyncio.sleep(0.5)
    return cost


async def one_listener(address: str, pid: int, n: int) -> float:
    """kB of a listener, while somebody speaks."""
    speaker = Talker(0, Tally(), [("us1", "en")], sentences=60, channel="news")
    await speaker.start(address)
    await asyncio.sleep(12.0)  # the ring of the channel is full
    base = pss_kb(pid)
    listeners = [Listener() for _ in range(n)]
    for listener in listeners:
        await listener.start(address)
    await asyncio.sleep(SETTLE_S)
    cost = (pss_kb(pid) - base) / n
    speaker.stop()
    for listener in listeners:
        assert listener.socket
        listener.socket.transport.abort()
    await asyncio.sleep(0.5)
    return cost


async def growth(address: str, pid: int, sessions: int) -> dict[str, float]:
    """What stays when so many have come and gone; the first tenth warms up."""
    await visits(address, sessions // 10)
    await asyncio.sleep(SETTLE_S)
    before = pss_kb(pid)
    await visits(address, sessions)
    await asyncio.sleep(SETTLE_S)
    after = pss_kb(pid)
    return {
        "before_mb": before / 1024,
        "after_mb": after / 1024,
        "growth_percent": 100 * (after - before) / before,
        "sessions": sessions,
    }


def main() -> None:
    """Print the table, or one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--sessions", type=int, default=10_000, help="that come and go")
    parser.add_argument("--each", type=int, default=1000, help="of a kind, to measure one")
    args = parser.parse_args()
    raise_file_limit()
    most = (
        "--max-sessions",
        "9999",
        "--max-sessions-per-address",
        "9999",
        "--max-listeners-per-address",
        "9999",
    )
    found: dict[str, float] = {}
    for name, cost, n in (
        ("idle_kb", one_idle, args.each),
        ("talker_kb", one_talker, args.each // 10),
        ("listener_kb", one_listener, args.each),
    ):
        with server("--channel", "news", "--drain", "0", *most) as (address, pid):
            found[name] = asyncio.run(cost(address, pid, n))
    with server("--drain", "0", *most) as (address, pid):
        found |= asyncio.run(growth(address, pid, args.sessions))
    if args.json:
        print(json.dumps({name: round(value, 2) for name, value in found.items()}))
        return
    for name, value in found.items():
        print(f"{name:<18}{value:>12.1f}")


if __name__ == "__main__":
    main()
