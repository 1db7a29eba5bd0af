"""What a session costs in memory, and whether any of it stays when sessions come and go.

Proportional set size of the server and its voices: shared pages count by share. The baseline is the same
server before anybody came.
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


async def measure(address: str, pid: int, sessions: int, each: int) -> dict[str, float]:
    """kB for each, and the growth."""
    await visits(address, 400)  # what is only needed once is there
    await asyncio.sleep(SETTLE_S)
    base = pss_kb(pid)
    found: dict[str, float] = {"base_mb": base / 1024}
    sockets = await idle(address, each)
    await asyncio.sleep(SETTLE_S)
    found["idle_kb"] = (pss_kb(pid) - base) / each
    for socket in sockets:
        socket.transport.close()  # type: ignore[attr-defined]
    await asyncio.sleep(35.0)  # sessions without a goodbye are kept for half a minute
    base = pss_kb(pid)
    talkers = [Talker(number, Tally(), VOICES) for number in range(each // 4)]
    for talker in talkers:
        await talker.start(address)
        await asyncio.sleep(0.05)
    await asyncio.sleep(10.0)
    found["talker_kb"] = (pss_kb(pid) - base) / len(talkers)
    for talker in talkers:
        talker.stop()
    await asyncio.sleep(SETTLE_S)
    base = pss_kb(pid)
    speaker = Talker(0, Tally(), [("us1", "en")], sentences=30, channel="news")
    listeners = [Listener() for _ in range(each)]
    for listener in listeners:
        await listener.start(address)
    await speaker.start(address)
    await asyncio.sleep(5.0)
    found["listener_kb"] = (pss_kb(pid) - base) / each
    speaker.stop()
    for listener in listeners:
        assert listener.socket
        listener.socket.transport.close()
    await asyncio.sleep(SETTLE_S)
    before = pss_kb(pid)
    await visits(address, sessions)
    await asyncio.sleep(SETTLE_S)
    found["after_mb"] = pss_kb(pid) / 1024
    found["growth_percent"] = 100 * (pss_kb(pid) - before) / before
    found["sessions"] = sessions
    return found


def main() -> None:
    """Print the table, or one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--sessions", type=int, default=10_000, help="that come and go")
    parser.add_argument("--each", type=int, default=200, help="of a kind, to measure one")
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
    with server("--channel", "news", *most) as (address, pid):
        found = asyncio.run(measure(address, pid, args.sessions, args.each))
    if args.json:
        print(json.dumps({name: round(value, 2) for name, value in found.items()}))
        return
    for name, value in found.items():
        print(f"{name:<18}{value:>12.1f}")


if __name__ == "__main__":
    main()
