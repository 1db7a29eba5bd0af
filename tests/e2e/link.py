"""A bad network between browser and server: a TCP proxy on loopback that can be told to stall."""

from __future__ import annotations

import asyncio
from contextlib import suppress


class Link:
    """Forwards to one server. `stall` holds back, once, what the server sends after so many bytes."""

    def __init__(self, target: str) -> None:
        host, _, port = target.rpartition(":")
        self._target = (host, int(port))
        self._server: asyncio.Server | None = None
        self._bytes_left: int | None = None
        self._stall_s = 0.0
        self.stalls = 0
        self.joined = 0
        """Connections open now."""
        self._writers: set[asyncio.StreamWriter] = set()

    async def __aenter__(self) -> Link:
        self._server = await asyncio.start_server(self._join, "127.0.0.1", 0)
        return self

    async def __aexit__(self, *_: object) -> None:
        assert self._server is not None
        self._server.close()

    @property
    def address(self) -> str:
        """Where to connect to."""
        assert self._server is not None
        return f"127.0.0.1:{self._server.sockets[0].getsockname()[1]}"

    def cut(self) -> None:
        """Break every connection off."""
        for writer in self._writers:
            writer.transport.abort()

    def stall(self, after_bytes: int, seconds: float) -> None:
        """From now on count what the server sends; hold everything behind `after_bytes` for `seconds`."""
        self._bytes_left, self._stall_s = after_bytes, seconds

    async def _join(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        there, back = await asyncio.open_connection(*self._target)
        self.joined += 1
        self._writers |= {writer, back}
        with suppress(ConnectionError, asyncio.CancelledError):
            await asyncio.gather(self._copy(reader, back), self._copy(there, writer, from_server=True))
        self._writers -= {writer, back}
        self.joined -= 1

    async def _copy(
        self, source: asyncio.StreamReader, sink: asyncio.StreamWriter, from_server: bool = False
    ) -> None:
        while data := await source.read(65536):
            if from_server and self._bytes_left is not None:
                data = await self._count(data, sink)
            sink.write(data)
            await sink.drain()
        sink.close()

    async def _count(self, data: bytes, sink: asyncio.StreamWriter) -> bytes:
        """Forward what may go, wait if the limit is reached; what is left of `data`."""
        assert self._bytes_left is not None
        if len(data) <= self._bytes_left:
            self._bytes_left -= len(data)
            return data
        sink.write(data[: self._bytes_left])
        await sink.drain()
        rest = data[self._bytes_left :]
        self._bytes_left = None
        self.stalls += 1
        await asyncio.sleep(self._stall_s)
        return rest
