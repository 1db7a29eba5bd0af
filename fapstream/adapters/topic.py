"""What a bus does within one process: the newest entries of a channel, and queues of those who subscribe."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import AsyncGenerator
from contextlib import suppress

BACKLOG_ENTRIES = 100
BACKLOG_BYTES = 262_144
"""Who subscribes gets no more of what was before."""

QUEUE_ENTRIES = 256
"""Who does not take what comes loses the oldest of more than so many."""


class _Queue:
    """Entries for one subscriber; None where something was lost."""

    def __init__(self) -> None:
        self._entries: deque[bytes | None] = deque()
        self._came = asyncio.Event()

    def put(self, entry: bytes | None) -> None:
        if entry is None and self._entries and self._entries[-1] is None:
            return
        self._entries.append(entry)
        if len(self._entries) > QUEUE_ENTRIES:
            self._entries.popleft()
            self._entries[0] = None
        self._came.set()

    async def get(self) -> bytes | None:
        while not self._entries:
            self._came.clear()
            await self._came.wait()
        return self._entries.popleft()


class Topic:
    """One channel."""

    def __init__(self) -> None:
        self._backlog: deque[bytes] = deque()
        self._bytes = 0
        self._queues: list[_Queue] = []

    @property
    def subscribers(self) -> int:
        """How many subscribe."""
        return len(self._queues)

    @property
    def backlog(self) -> tuple[bytes, ...]:
        """The newest entries."""
        return tuple(self._backlog)

    def put(self, entry: bytes | None) -> None:
        """An entry, or None: something was lost, so that what was before is of no use to who comes now."""
        if entry is None:
            self._backlog.clear()
            self._bytes = 0
        else:
            self._backlog.append(entry)
            self._bytes += len(entry)
        while len(self._backlog) > BACKLOG_ENTRIES or self._bytes > BACKLOG_BYTES:
            self._bytes -= len(self._backlog.popleft())
        for queue in self._queues:
            queue.put(entry)

    async def subscribe(self) -> AsyncGenerator[bytes | None, None]:
        """The backlog and what comes after it, without gap or repeat."""
        queue = _Queue()
        for entry in self._backlog:
            queue.put(entry)
        self._queues.append(queue)
        try:
            while True:
                yield await queue.get()
        finally:
            with suppress(ValueError):
                self._queues.remove(queue)
