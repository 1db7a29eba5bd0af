"""Waiting for what another task does, without a clock of one's own."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable

PATIENCE_S = 20.0


async def until(holds: Callable[[], bool]) -> None:
    """Let the loop run until something holds. Raises TimeoutError long after it should have."""
    async with asyncio.timeout(PATIENCE_S):
        while not holds():
            await asyncio.sleep(0.001)


async def got(subscription: AsyncIterator[bytes | None], last: bytes) -> list[bytes | None]:
    """Everything up to an entry."""
    found: list[bytes | None] = []
    async with asyncio.timeout(PATIENCE_S):
        async for entry in subscription:
            found.append(entry)
            if entry == last:
                break
    return found
