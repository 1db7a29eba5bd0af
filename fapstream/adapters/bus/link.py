"""One end of the connection between the hub and a process."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from time import monotonic
from typing import cast

from fapstream.adapters.bus.frames import Frame, Parser
from fapstream.adapters.bus.waiting import OUTBOX, Waiting
from fapstream.errors import RemoteProtocolError

log = logging.getLogger("fapstream.bus")

CHUNK_BYTES = 1 << 16
HIGH_BYTES = 1 << 18
"""More than that is not handed to the socket ahead of the other side's reading."""
STALL_S = 10.0
"""Who reads nothing for so long is dropped."""


class Link(asyncio.Protocol):
    """Frames in and out. What is sent waits in bounds; nothing here ever blocks."""

    def __init__(
        self,
        received: Callable[[Link, Frame], None],
        waiting: Waiting[bytes],
        now: Callable[[], float] = monotonic,
    ) -> None:
        self._received = received
        self._waiting = waiting
        self._now = now
        self._parser = Parser()
        self._transport: asyncio.Transport | None = None
        self._paused_at: float | None = None
        self._flushing = False
        self._loop = asyncio.get_running_loop()
        self.lost: asyncio.Future[Exception | None] = self._loop.create_future()
        """Done when the connection is over."""

    def put(self, frame: bytes | None) -> None:
        """Send an entry when the other side has room. (The hub knows no gaps: the numbers tell of them.)"""
        if frame is not None:
            self._waiting.put(frame, len(frame))
            self.wake()

    def wake(self) -> None:
        """See to what waits, once for everything of this turn of the loop."""
        if self._paused_at is not None and self._now() - self._paused_at > STALL_S:
            self.abort()
        elif not self._flushing:
            self._flushing = True
            self._loop.call_soon(self._flush)

    def tell(self, frame: bytes) -> None:
        """Send at once what must not be dropped; it overtakes what waits."""
        if self._transport:
            self._transport.write(frame)

    def finish(self) -> None:
        """Send what waits, and close."""
        if self._transport:
            self._transport.write(b"".join(self._waiting.take(OUTBOX.size)))
            self._transport.close()

    def abort(self) -> None:
        """Close without sending what waits."""
        if self._transport:
            self._transport.abort()

    def _flush(self) -> None:
        self._flushing = False
        while self._transport and self._paused_at is None and self._waiting:
            self._transport.write(b"".join(self._waiting.take(CHUNK_BYTES)))

    # asyncio.Protocol

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = cast(asyncio.Transport, transport)
        self._transport.set_write_buffer_limits(high=HIGH_BYTES)
        self._flush()

    def data_received(self, data: bytes) -> None:
        try:
            for frame in self._parser.feed(data):
                self._received(self, frame)
        except RemoteProtocolError as error:
            log.warning("dropped a process from the bus: %s", error)
            self.abort()

    def pause_writing(self) -> None:
        self._paused_at = self._now()

    def resume_writing(self) -> None:
        self._paused_at = None
        self._flush()

    def connection_lost(self, error: Exception | None) -> None:
        self._transport = None
        if not self.lost.done():
            self.lost.set_result(error)
