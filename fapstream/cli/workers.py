"""Several processes that serve one port, and the parent that looks after them.

The parent only waits: it loads what all need, forks them, so that they share that memory, starts one anew
that has died, and passes on the wish to stop. It runs no event loop and no thread, so a fork is always safe.
"""

from __future__ import annotations

import logging
import os
import select
import signal
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

log = logging.getLogger("fapstream.workers")

STOPPING = {signal.SIGTERM, signal.SIGINT}
PASSED_ON = {signal.SIGHUP}
SHORT_LIFE_S = 5.0
"""One that dies younger is started again only after a while, ever longer."""
LONGEST_WAIT_S = 30.0
EXTRA_S = 10.0
"""Beyond the time that workers are given to end, for goodbyes, before they are killed."""

Work = Callable[[int, "Lifeline"], None]
"""What a process does: its number, and how it hears of its parent."""


@dataclass(frozen=True, slots=True)
class Lifeline:
    """`ready` is to be called once the process serves; `parent` becomes readable when the parent is gone."""

    ready: Callable[[], None]
    parent: int


@dataclass(slots=True)
class _Child:
    """One of the processes."""

    index: int
    work: Work
    pid: int = 0
    started: float = 0.0
    deaths: int = 0
    again_at: float | None = None
    """When it is to be started again."""


@dataclass(slots=True)
class Supervisor:
    """`works`: what each process does; `helpers`: what those do that go last. `all_ready` is called once,
    when every one has said that it is ready; `died` is told the index of each that ended.
    """

    works: Sequence[Work]
    helpers: Sequence[Work] = ()
    all_ready: Callable[[], None] = lambda: None
    died: Callable[[int], None] = lambda index: None
    stop_s: float = 10.0
    _children: list[_Child] = field(default_factory=list)
    _waiting: set[int] = field(default_factory=set)
    """Indices of those that are not ready yet."""

    def run(self) -> int:
        """Until asked to stop; the exit status. One that cannot start at all ends everything: 1."""
        watched = STOPPING | PASSED_ON | {signal.SIGCHLD}
        signal.pthread_sigmask(signal.SIG_BLOCK, watched)
        alive, held = os.pipe()
        ready, says_ready = os.pipe()
        self._children = [_Child(i, work) for i, work in enumerate((*self.works, *self.helpers))]
        self._waiting = {child.index for child in self._children}
        fds = (alive, held, ready, says_ready)
        try:
            for child in self._children:
                self._start(child, fds)
            return self._watch(watched, fds)
        finally:
            for fd in fds:
                os.close(fd)
            signal.pthread_sigmask(signal.SIG_UNBLOCK, watched)

    def _start(self, child: _Child, fds: tuple[int, int, int, int]) -> None:
        alive, held, ready, says_ready = fds
        sys.stdout.flush()
        sys.stderr.flush()
        child.started, child.again_at = time.monotonic(), None
        child.pid = os.fork()
        if child.pid:
            return
        status = 1
        try:
            os.close(held)
            os.close(ready)
            signal.signal(signal.SIGINT, signal.SIG_IGN)  # a terminal tells all; the parent passes it on
            signal.pthread_sigmask(signal.SIG_UNBLOCK, STOPPING | PASSED_ON | {signal.SIGCHLD})
            line = Lifeline(lambda: _say(says_ready, child.index), alive)
            child.work(child.index, line)
            status = 0
        except KeyboardInterrupt:
            status = 0
        except BaseException:
            log.exception("worker %d cannot go on", child.index)
        finally:
            sys.stdout.flush()
            os._exit(status)

    def _watch(self, watched: set[signal.Signals], fds: tuple[int, int, int, int]) -> int:
        while True:
            self._hear_ready(fds[2])
            got = signal.sigtimedwait(watched, self._patience())
            if got is None:
                for child in self._children:
                    if child.again_at is not None and child.again_at <= time.monotonic():
                        self._start(child, fds)
            elif got.si_signo in STOPPING:
                return self._stop()
            elif got.si_signo in PASSED_ON:
                _tell(self._children, got.si_signo)
            elif not self._reap():
                self._stop()
                return 1

    def _patience(self) -> float:
        if self._waiting:
            return 0.02
        due = [c.again_at for c in self._children if c.again_at is not None]
        return max(0.0, min(due, default=time.monotonic() + 3600) - time.monotonic())

    def _hear_ready(self, fd: int) -> None:
        while self._waiting and select.select([fd], [], [], 0)[0]:
            self._waiting -= set(os.read(fd, 256))
            if not self._waiting:
                self.all_ready()

    def _reap(self) -> bool:
        """Take note of those that have died. False: one died before it was ever ready."""
        for child in self._children:
            if not child.pid or not _ended(child.pid):
                continue
            self.died(child.index)
            child.pid = 0
            if child.index in self._waiting:
                return False
            young = time.monotonic() - child.started < SHORT_LIFE_S
            child.deaths = child.deaths + 1 if young else 0
            wait_s = min(LONGEST_WAIT_S, 0.5 * 2**child.deaths) if young else 0.0
            log.error("worker %d has died; it is started again", child.index)
            child.again_at = time.monotonic() + wait_s
        return True

    def _stop(self) -> int:
        working = self._children[: len(self.works)]
        self._end(working, self.stop_s + EXTRA_S)
        self._end(self._children[len(self.works) :], EXTRA_S)
        return 0

    def _end(self, children: Sequence[_Child], within_s: float) -> None:
        """Ask them to end, and see to it that they do."""
        left = [c for c in children if c.pid]
        _tell(left, signal.SIGTERM)
        deadline = time.monotonic() + within_s
        while left and time.monotonic() < deadline:
            got = signal.sigtimedwait(STOPPING | {signal.SIGCHLD}, 0.2)
            if got is not None and got.si_signo in STOPPING:
                _tell(left, signal.SIGTERM)  # asked twice: at once
            left = [c for c in left if not _ended(c.pid)]
        for child in left:
            log.error("worker %d does not end; it is killed", child.index)
            os.kill(child.pid, signal.SIGKILL)
            os.waitpid(child.pid, 0)


def _tell(children: Sequence[_Child], number: int) -> None:
    for child in children:
        if child.pid:
            os.kill(child.pid, number)


def _say(fd: int, index: int) -> None:
    os.write(fd, bytes((index,)))


def _ended(pid: int) -> bool:
    return os.waitpid(pid, os.WNOHANG)[0] != 0
