"""Programs kept running for the next one who needs one."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Awaitable, Callable
from contextlib import suppress
from typing import Generic, Protocol, TypeVar

from fapstream.errors import VoiceUnavailable


class Program(Protocol):
    """What is kept."""

    @property
    def alive(self) -> bool:
        """Whether it still runs."""

    async def aclose(self) -> None:
        """End it."""


P = TypeVar("P", bound=Program)


READ_BYTES = 1 << 16


async def end_program(process: asyncio.subprocess.Process) -> None:
    """End a program. What it still had to say is read: asyncio waits for the end of its pipes."""
    assert process.stdout is not None
    if process.returncode is None:
        with suppress(ProcessLookupError):
            process.kill()
    while await process.stdout.read(READ_BYTES):
        pass
    await process.wait()


class Spares(Generic[P]):
    """At most `keep` idle programs of one kind; one that was lost is replaced while nobody waits."""

    def __init__(self, start: Callable[[], Awaitable[P]], keep: int = 2) -> None:
        self._start = start
        self._keep = keep
        self._idle: deque[P] = deque()
        self._refill: asyncio.Task[None] | None = None

    async def warm(self) -> None:
        """Have one running. Raises VoiceUnavailable."""
        if not self._idle:
            self._idle.append(await self._start())

    async def take(self) -> P:
        """A running program, a spare if there is one. Raises VoiceUnavailable."""
        while self._idle:
            program = self._idle.popleft()
            if program.alive:
                return program
            await program.aclose()
        return await self._start()

    async def give_back(self, program: P, reusable: bool) -> None:
        """Keep it for the next, or end it and see to it that there is another."""
        if reusable and program.alive and len(self._idle) < self._keep:
            self._idle.append(program)
            return
        await program.aclose()
        if not self._idle and (self._refill is None or self._refill.done()):
            self._refill = asyncio.create_task(self._refilled())

    async def _refilled(self) -> None:
        try:
            await self.warm()
        except (VoiceUnavailable, OSError):
            return  # whoever asks next is told

    async def aclose(self) -> None:
        """End every idle program."""
        if self._refill:
            await asyncio.gather(self._refill, return_exceptions=True)
        while self._idle:
            await self._idle.popleft().aclose()
