"""How far a long piece of work has come, on stderr."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import TextIO

TERMINAL_S = 0.2
LOG_S = 10.0


class Progress:
    """Call it with what is done and how much there is: a terminal has one line of it that changes, and goes
    at the end; what is no terminal has a line every ten seconds.
    """

    def __init__(
        self, what: str, stream: TextIO | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._what, self._stream, self._clock = what, stream or sys.stderr, clock
        self._live = self._stream.isatty()
        self._every = TERMINAL_S if self._live else LOG_S
        self._next = clock() + self._every

    def __call__(self, done: int, total: int) -> None:
        """`done` of `total`."""
        now = self._clock()
        if done < total and now < self._next:
            return
        self._next = now + self._every
        text = f"{done} of {total} {self._what}"
        if self._live:
            print(f"\r{text if done < total else ''}\x1b[K", end="", file=self._stream, flush=True)
        elif done < total:
            print(text, file=self._stream, flush=True)
