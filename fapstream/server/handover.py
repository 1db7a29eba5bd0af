"""A session may live in another worker process than the one a client comes back to: its messages are passed
on there and back over that process's private socket.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from pathlib import Path

from websockets.asyncio.client import ClientConnection, unix_connect
from websockets.exceptions import ConnectionClosed, WebSocketException
from websockets.typing import Subprotocol

from fapstream.protocol import generated as g
from fapstream.server.link import Link, drained


def socket_of(folder: Path, index: int) -> Path:
    """The private socket of a process."""
    return folder / f"worker-{index}.sock"


async def hand_over(link: Link, first: bytes, path: Path, address: str) -> bool:
    """Join a client, whose first message is `first`, to another process until either leaves.

    False if that process is not there.
    """
    try:
        there = await unix_connect(
            str(path), uri="ws://localhost/ws", subprotocols=[Subprotocol(g.SUBPROTOCOL)], compression=None,
            max_size=g.MAX_MESSAGE_BYTES, additional_headers={"X-Forwarded-For": address},
        )  # fmt: skip
    except (OSError, WebSocketException, TimeoutError):
        return False
    async with there:
        await there.send(first)
        pumps = {asyncio.create_task(_inwards(link, there)), asyncio.create_task(_outwards(there, link))}
        _, left = await asyncio.wait(pumps, return_when=asyncio.FIRST_COMPLETED)
        for task in left:
            task.cancel()
        await asyncio.gather(*pumps, return_exceptions=True)
    await link.close(there.close_code or 1000, there.close_reason or "")
    return True


async def _inwards(link: Link, there: ClientConnection) -> None:
    with suppress(ConnectionClosed):
        while True:
            await there.send(await link.recv())


async def _outwards(there: ClientConnection, link: Link) -> None:
    with suppress(ConnectionClosed, TimeoutError):
        while True:
            data = await there.recv()
            assert isinstance(data, bytes)
            link.write(data)
            await drained(link)
