"""Programs kept running for the next one who needs one, and never more of them than the machine bears."""

from __future__ import annotations

import asyncio
import os
import sys
from collections import deque
from collections.abc import Awaitable, Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar

from fapstream.errors import SynthesisError, VoiceOverloaded

OnEvent = Callable[[str], None]
"""Is told: `start` and `refused` of a program, `wait` of one who has to, and what a program's user finds."""

READ_BYTES = 1 << 20
"""More than asyncio ever holds for a reader: what has come is taken whole."""

END_S = 5.0
"""A program that was killed and whose pipes somebody else keeps open is waited for no longer."""


class Program(Protocol):
    """What is kept."""

    @property
    def alive(self) -> bool:
        """Whether it still runs."""

    async def aclose(self) -> None:
        """End it."""


P = TypeVar("P", bound=Program)


def ignore(_: str) -> None:
    """Nobody counts."""


def watch_by_descriptor() -> None:
    """The ends of programs are noticed by the event loop itself, as from Python 3.12 on.

    The usual way before is a thread for each of them, and more than half of the time to start one. For the
    loop that runs now, in the main thread, and where the system has such descriptors.
    """
    if sys.version_info < (3, 12) and hasattr(os, "pidfd_open"):
        with suppress(OSError):
            os.close(os.pidfd_open(os.getpid()))
            watcher = asyncio.PidfdChildWatcher()
            watcher.attach_loop(asyncio.get_running_loop())
            asyncio.get_event_loop_policy().set_child_watcher(watcher)


async def end_program(process: asyncio.subprocess.Process) -> None:
    """End a program. What it still had to say is read: asyncio waits for the end of its pipes."""
    assert process.stdout is not None
    if process.returncode is None:
        with suppress(ProcessLookupError):
            process.kill()
    with suppress(TimeoutError):
        async with asyncio.timeout(END_S):
            while await process.stdout.read(READ_BYTES):
                pass
            await process.wait()


@dataclass(frozen=True, slots=True)
class Limits:
    """Of one kind of program: how many may run, how many idle ones are kept, and how long the second and
    further ones of these."""

    most: int = 256
    keep: int = 16
    idle_s: float = 60.0


class Budget:
    """How many programs of all kinds may run, and start at once. Who has to wait is served in order of
    asking; only those who wait for a kind that has reached its own limit are passed."""

    def __init__(self, most: int = 256, at_once: int = 4, on_event: OnEvent = ignore) -> None:
        self.most, self.at_once, self.on_event = most, at_once, on_event
        self.running = self.starting = 0
        self._kinds: list[Spares[Any]] = []
        self._waiting: deque[tuple[Spares[Any], asyncio.Future[Any]]] = deque()

    def join(self, kind: Spares[Any]) -> None:
        """A kind of program that counts."""
        self._kinds.append(kind)

    async def turn(self, kind: Spares[P]) -> P | None:
        """An idle program of that kind, or None: one may be started. Whoever is cancelled loses neither."""
        if not self._waiting and (granted := kind.grant()):
            return granted[0]
        future: asyncio.Future[P | None] = asyncio.get_running_loop().create_future()
        self._waiting.append((kind, future))
        self.serve()
        if not future.done():
            self.on_event("wait")
        try:
            return await future
        except asyncio.CancelledError:
            if future.done() and not future.cancelled():
                kind.ungrant(future.result())
            raise

    def place(self) -> bool:
        """Take the place of a program that is going to be started, if there is one."""
        if self.running >= self.most or self.starting >= self.at_once:
            return False
        self.running += 1
        self.starting += 1
        return True

    def serve(self) -> None:
        """Something became free."""
        self._waiting = deque(entry for entry in self._waiting if not entry[1].done())
        for kind, future in self._waiting:
            if granted := kind.grant():
                future.set_result(granted[0])
            elif self.running >= self.most and not kind.full:
                self._make_room()
                return

    def _make_room(self) -> None:
        """Somebody waits while idle programs of another kind take the room: the one idle longest goes."""
        idle = [kind for kind in self._kinds if kind.idle_since is not None]
        if idle and not any(kind.ending for kind in self._kinds):
            min(idle, key=lambda kind: kind.idle_since or 0.0).end_oldest()


class Spares(Generic[P]):
    """Programs of one kind; an idle one is used again, one that was lost is replaced while nobody waits."""

    def __init__(
        self, start: Callable[[], Awaitable[P]], limits: Limits | None = None, budget: Budget | None = None
    ) -> None:
        self._start = start
        self._limits = limits or Limits()
        self._budget = budget or Budget()
        self._budget.join(self)
        self._running = 0
        self._idle: deque[tuple[float, P]] = deque()
        """Since when, and which."""
        self.ending: set[asyncio.Task[None]] = set()
        self._refill: asyncio.Task[None] | None = None
        self._trim: asyncio.TimerHandle | None = None
        self._closed = False

    async def warm(self) -> None:
        """Have one running. Raises SynthesisError."""
        if not self._idle:
            await self.give_back(await self.take(), reusable=True)

    async def take(self) -> P:
        """A running program, a spare if there is one. Raises SynthesisError."""
        program = await self._budget.turn(self)
        return program if program is not None else await self._started()

    async def give_back(self, program: P, reusable: bool) -> None:
        """Keep it for the next, or end it and see to it that there is another."""
        if reusable and program.alive and not self._closed:
            self._rest(program)
            return
        await self._end(program)
        if not (self._idle or self._closed) and (self._refill is None or self._refill.done()):
            self._refill = asyncio.create_task(self._refilled())

    async def replaced(self, program: P) -> P:
        """Another in the place of one that died. Raises SynthesisError."""
        if self._idle:
            _, spare = self._idle.pop()
            await self._end(program)
            return spare
        try:
            await program.aclose()
        except BaseException:
            self._left()
            raise
        self._budget.starting += 1
        return await self._started()

    async def aclose(self) -> None:
        """End every idle program, and from now on all that are given back."""
        self._closed = True
        if self._trim:
            self._trim.cancel()
        if self._refill:
            await asyncio.gather(self._refill, return_exceptions=True)
        while self._idle:
            self.end_oldest()
        await asyncio.gather(*self.ending, return_exceptions=True)

    # for the budget

    @property
    def idle_since(self) -> float | None:
        """Of the program that has been idle longest; None if there is none."""
        return self._idle[0][0] if self._idle else None

    @property
    def full(self) -> bool:
        """No more of this kind may run."""
        return self._running >= self._limits.most

    def grant(self) -> tuple[P | None] | None:
        """(an idle program,); (None,), and the place for one is taken; None if there is neither."""
        while self._idle:
            _, program = self._idle.pop()
            if program.alive:
                return (program,)
            self._end_later(program)
        if self.full or not self._budget.place():
            return None
        self._running += 1
        return (None,)

    def ungrant(self, program: P | None) -> None:
        """What was granted is not wanted."""
        if program is not None:
            self._rest(program)
        else:
            self._budget.starting -= 1
            self._left()

    def end_oldest(self) -> None:
        """End the program that has been idle longest."""
        self._end_later(self._idle.popleft()[1])

    # a program's life

    async def _started(self) -> P:
        """In a place that was granted."""
        try:
            program = await self._start()
        except OSError as error:
            self._left()
            self._budget.on_event("refused")
            raise VoiceOverloaded(f"no program can be started for the voice: {error}") from error
        except BaseException:
            self._left()
            raise
        finally:
            self._budget.starting -= 1
            self._budget.serve()
        self._budget.on_event("start")
        return program

    def _rest(self, program: P) -> None:
        loop = asyncio.get_running_loop()
        self._idle.append((loop.time(), program))
        self._budget.serve()
        if len(self._idle) > self._limits.keep:
            self.end_oldest()
        if len(self._idle) > 1 and self._trim is None:
            self._trim = loop.call_later(self._limits.idle_s, self._trimmed)

    def _trimmed(self) -> None:
        """Of those that nobody has wanted for long, one is kept warm."""
        loop, self._trim = asyncio.get_running_loop(), None
        while len(self._idle) > 1 and self._idle[0][0] <= loop.time() - self._limits.idle_s:
            self.end_oldest()
        if len(self._idle) > 1:
            self._trim = loop.call_at(self._idle[0][0] + self._limits.idle_s, self._trimmed)

    async def _end(self, program: P) -> None:
        try:
            await program.aclose()
        finally:
            self._left()

    def _end_later(self, program: P) -> None:
        task = asyncio.create_task(self._end(program))
        self.ending.add(task)
        task.add_done_callback(self.ending.discard)

    def _left(self) -> None:
        self._running -= 1
        self._budget.running -= 1
        self._budget.serve()

    async def _refilled(self) -> None:
        with suppress(SynthesisError):  # whoever asks next is told
            await self.warm()
