"""One subscriber's queue."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from fapstream.adapters.bus.waiting import Bounds, Waiting

INBOX = Bounds(256, 4_000_000)
"""Ten seconds of a talk."""


class Inbox:
    """A Subscription; see the port. `left` is called once, when it is closed."""

    def __init__(self, left: Callable[[Inbox], None], bounds: Bounds = INBOX) -> None:
        self._left = left
        self._waiting: Waiting[bytes | None] = Waiting(bounds)
        self._ready = asyncio.Event()
        self._missed = False
        """Some went before the oldest that waits."""
        self._after_gap = False
        self._ended = False

    def put(self, entry: bytes | None) -> None:
        """The next entry, or a gap; older ones go when there are too many."""
        if self._waiting.put(entry, len(entry or b"")):
            self._missed = True
        self._ready.set()

    def end(self) -> None:
        """Nothing follows what waits."""
        self._ended = True
        self._ready.set()

    def __aiter__(self) -> Inbox:
        return self

    async def __anext__(self) -> bytes | None:
        """See the port."""
        while True:
            while not self._waiting:
                if self._ended:
                    raise StopAsyncIteration
                self._ready.clear()
                await self._ready.wait()
            if (entry := self._next()) is not None or not self._after_gap:
                self._after_gap = entry is None
                return entry

    def _next(self) -> bytes | None:
        if self._missed:
            self._missed = False
            return None
        return self._waiting.pop()

    async def aclose(self) -> None:
        """See the port."""
        self._waiting.clear()
        if not self._ended:
            self.end()
            self._left(self)
