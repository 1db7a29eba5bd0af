"""The Link over real loopback sockets."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import ConnectionClosed

from fapstream.server.link import WebSocketLink, drained, framed


@asynccontextmanager
async def joined() -> AsyncIterator[tuple[WebSocketLink, ClientConnection]]:
    """Both ends of a connection."""
    made: asyncio.Future[WebSocketLink] = asyncio.get_running_loop().create_future()
    over = asyncio.Event()

    async def handle(socket: ServerConnection) -> None:
        made.set_result(WebSocketLink(socket))
        await over.wait()

    async with serve(handle, "127.0.0.1", 0, compression=None, close_timeout=0.2) as server:
        port = server.sockets[0].getsockname()[1]
        async with connect(f"ws://127.0.0.1:{port}", compression=None, close_timeout=0.2) as client:
            yield await made, client
            over.set()


@pytest.mark.parametrize("size", [0, 1, 125, 126, 65535, 65536, 100_000])
async def test_messages_arrive_however_they_are_written(size: int) -> None:
    async with joined() as (link, client):
        data = bytes(i % 251 for i in range(size))
        link.write(data)
        link.write_framed(framed(data))
        assert await client.recv() == await client.recv() == data
        await client.send(data)
        assert await link.recv() == data


async def test_the_backlog_tells_that_the_other_side_does_not_read() -> None:
    async with joined() as (link, client):
        link.keep_little()
        client.transport.pause_reading()
        for _ in range(400):
            link.write_framed(framed(bytes(10_000)))
        assert link.backlog > 1_000_000
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.05):
                await drained(link)
        client.transport.resume_reading()
        for _ in range(400):
            await client.recv()
        await drained(link)
        assert link.backlog == 0


async def test_what_is_written_to_a_lost_connection_goes_nowhere() -> None:
    async with joined() as (link, client):
        client.transport.abort()
        with pytest.raises(ConnectionClosed):
            await link.recv()
        link.write(b"x")
        link.write_framed(framed(b"x"))
        with pytest.raises(ConnectionClosed):
            await drained(link)
        await link.close()
