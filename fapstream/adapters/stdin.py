"""Standard input as it comes, without holding up the program's end.

A thread of its own does the reading, because a read can be neither awaited (regular files) nor cancelled;
it is a daemon, so that a program that is done or interrupted need not wait for another line.
"""

from __future__ import annotations

import asyncio
import os
import threading
from collections.abc import AsyncIterator
from contextlib import suppress

READ_BYTES = 4096
AHEAD = 4
"""Reads that may lie waiting."""


async def chunks(fd: int = 0) -> AsyncIterator[bytes]:
    """What is read from a file descriptor, until its end. Raises OSError."""
    loop = asyncio.get_running_loop()
    queue: asyncio.Queue[bytes | OSError] = asyncio.Queue()
    room = threading.Semaphore(AHEAD)

    def read() -> None:
        with suppress(RuntimeError):  # the loop is closed: nobody wants it any more
            while True:
                room.acquire()
                data = _read(fd)
                loop.call_soon_threadsafe(queue.put_nowait, data)
                if not isinstance(data, bytes) or not data:
                    return

    threading.Thread(target=read, daemon=True).start()
    while data := await queue.get():
        if isinstance(data, OSError):
            raise data
        yield data
        room.release()


def _read(fd: int) -> bytes | OSError:
    try:
        return os.read(fd, READ_BYTES)
    except OSError as e:
        return e
