"""Whether a bus is connected, who wants to know, and how long to wait before the next attempt."""

from __future__ import annotations

import asyncio
import logging
import random
from collections.abc import Callable, Iterator

log = logging.getLogger("fapstream.bus")

FIRST_WAIT_S = 0.05
LONGEST_WAIT_S = 2.0
GOODBYE_S = 1.0
"""So long a bus that is being closed may take to send what waits."""


def waits() -> Iterator[float]:
    """Seconds before each attempt: longer and longer, and not the same for everyone at once."""
    wait = FIRST_WAIT_S
    while True:
        yield wait * random.uniform(0.5, 1.0)
        wait = min(2 * wait, LONGEST_WAIT_S)


class State:
    """Connected or not. `name`: what the bus is connected to, for the log."""

    def __init__(self, name: str) -> None:
        self._name = name
        self.connected = False
        self._known = False
        self._tell: list[Callable[[bool], None]] = []

    def watch(self, tell: Callable[[bool], None]) -> None:
        """Have it called with every change."""
        self._tell.append(tell)

    def up(self) -> None:
        """It is connected."""
        if not self.connected:
            log.info("the bus at %s is connected", self._name)
            self._change(True)

    def down(self, reason: object) -> None:
        """It is not, or still not; the log says so once."""
        if self.connected or not self._known:
            log.warning("the bus at %s is away: %s", self._name, reason)
        self._known = True
        if self.connected:
            self._change(False)

    def _change(self, connected: bool) -> None:
        self.connected = connected
        for tell in self._tell:
            asyncio.get_running_loop().call_soon(tell, connected)
