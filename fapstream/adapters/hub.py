"""A bus for the worker processes of one machine: a hub behind a Unix socket, in a process of its own.

Frames both ways: a length (4 bytes, big-endian), then a MessagePack array [operation, channel, entry].
"""

from __future__ import annotations

import asyncio
import logging
import signal
from collections import deque
from collections.abc import AsyncGenerator, Callable
from contextlib import suppress
from pathlib import Path

import msgpack

from fapstream.adapters.topic import Topic

log = logging.getLogger("fapstream.bus")

SUBSCRIBE, UNSUBSCRIBE, ENTRY = 0, 1, 2
LONGEST = 1 << 20
MOST_WAITING = 4 << 20
"""Bytes that may wait for a worker; one that takes nothing is cut off and comes back."""
RECONNECT_S = 0.2
OUTBOX_ENTRIES = 256
"""What is kept for a hub that is away."""


def frame(operation: int, channel: str, entry: bytes = b"") -> bytes:
    """As it goes over the socket."""
    body: bytes = msgpack.packb((operation, channel, entry))
    return len(body).to_bytes(4, "big") + body


async def read_frame(reader: asyncio.StreamReader) -> tuple[int, str, bytes]:
    """The next frame. Raises IncompleteReadError, ValueError."""
    length = int.from_bytes(await reader.readexactly(4), "big")
    if length > LONGEST:
        raise ValueError(f"a frame of {length} bytes")
    operation, channel, entry = msgpack.unpackb(await reader.readexactly(length))
    return operation, channel, entry


class Hub:
    """Passes entries on to those who subscribe to their channel."""

    def __init__(self) -> None:
        self._topics: dict[str, Topic] = {}
        self._workers: dict[str, set[asyncio.StreamWriter]] = {}

    async def serve(self, path: Path) -> asyncio.Server:
        """Begin to listen. Raises OSError."""
        path.unlink(missing_ok=True)
        return await asyncio.start_unix_server(self._worker, str(path))

    async def _worker(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with suppress(asyncio.IncompleteReadError, asyncio.CancelledError, ConnectionError, ValueError):
            while True:
                self._take(*await read_frame(reader), writer)
        for writers in self._workers.values():
            writers.discard(writer)
        writer.transport.abort()

    def _take(self, operation: int, channel: str, entry: bytes, writer: asyncio.StreamWriter) -> None:
        topic = self._topics.setdefault(channel, Topic())
        writers = self._workers.setdefault(channel, set())
        if operation == ENTRY:
            topic.put(entry)
            data = frame(ENTRY, channel, entry)
            for one in tuple(writers):
                self._pass(one, data, writers)
        elif operation == SUBSCRIBE:
            writer.write(b"".join(frame(ENTRY, channel, old) for old in topic.backlog))
            writers.add(writer)
        else:
            writers.discard(writer)

    def _pass(self, writer: asyncio.StreamWriter, data: bytes, writers: set[asyncio.StreamWriter]) -> None:
        if writer.transport.get_write_buffer_size() > MOST_WAITING:
            log.warning("a worker takes nothing from the hub and is cut off")
            writers.discard(writer)
            writer.transport.abort()
        else:
            writer.write(data)


class HubBus:
    """A worker's end. A hub that is away is looked for again; what is lost meanwhile shows as a gap."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._topics: dict[str, Topic] = {}
        self._writer: asyncio.StreamWriter | None = None
        self._outbox: deque[bytes] = deque(maxlen=OUTBOX_ENTRIES)
        self._task: asyncio.Task[None] = asyncio.get_running_loop().create_task(self._run())

    def publish(self, channel: str, entry: bytes) -> None:
        """See the port."""
        self._send(frame(ENTRY, channel, entry))

    async def subscribe(self, channel: str) -> AsyncGenerator[bytes | None, None]:
        """See the port. The hub sends the backlog to the first who subscribes here, we to those after."""
        topic = self._topics.get(channel)
        if topic is None:
            topic = self._topics[channel] = Topic()
            self._send(frame(SUBSCRIBE, channel))
        try:
            async for entry in topic.subscribe():
                yield entry
        finally:
            if not topic.subscribers and self._topics.get(channel) is topic:
                del self._topics[channel]
                self._send(frame(UNSUBSCRIBE, channel))

    async def aclose(self) -> None:
        """See the port."""
        self._task.cancel()
        await asyncio.gather(self._task, return_exceptions=True)
        if self._writer:
            self._writer.close()

    def _send(self, data: bytes) -> None:
        if self._writer is None:
            self._outbox.append(data)
        elif self._writer.transport.get_write_buffer_size() < MOST_WAITING:
            self._writer.write(data)

    async def _run(self) -> None:
        lost = False
        while True:
            with suppress(OSError, asyncio.IncompleteReadError, ValueError):
                reader, writer = await asyncio.open_unix_connection(str(self._path))
                self._greet(writer, lost)
                lost = True
                await self._read(reader)
            self._writer = None
            await asyncio.sleep(RECONNECT_S)

    def _greet(self, writer: asyncio.StreamWriter, lost: bool) -> None:
        """Subscribe to everything again, unless the wish for it still waits."""
        if lost:
            for channel, topic in self._topics.items():
                topic.put(None)
                writer.write(frame(SUBSCRIBE, channel))
        for data in self._outbox:
            writer.write(data)
        self._outbox.clear()
        self._writer = writer

    async def _read(self, reader: asyncio.StreamReader) -> None:
        while True:
            _, channel, entry = await read_frame(reader)
            if topic := self._topics.get(channel):
                topic.put(entry)


def run_hub(path: Path, parent: int, ready: Callable[[], None]) -> None:
    """Be the hub until the parent is gone or a signal comes."""

    async def run() -> None:
        stop = asyncio.Event()
        loop = asyncio.get_running_loop()
        loop.add_reader(parent, stop.set)
        loop.add_signal_handler(signal.SIGTERM, stop.set)
        server = await Hub().serve(path)
        ready()
        await stop.wait()
        server.close()

    asyncio.run(run())
