"""What was sent and may have to be sent again when the connection is lost."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple


class _Entry(NamedTuple):
    data: bytes
    weight: int


class Sent:
    """Counted messages, the first of a session being number 1, until the other side is known to have them.

    Weights are what the ring is measured in: ms of sound at the server's end, bytes at the client's.
    """

    def __init__(self) -> None:
        self.count = 0
        """Messages sent in all."""
        self.weight = 0
        """Of what is kept."""
        self._kept: deque[_Entry] = deque()

    def append(self, data: bytes, weight: int) -> None:
        """One more was sent."""
        self.count += 1
        self.weight += weight
        self._kept.append(_Entry(data, weight))

    def forget(self, received: int) -> None:
        """The other side has so many. A number that cannot be is clamped."""
        while self._kept and self.count - len(self._kept) < received:
            self.weight -= self._kept.popleft().weight

    def shrink(self, most: int) -> None:
        """Keep no more than so much; the oldest go first."""
        while self._kept and self.weight > most:
            self.weight -= self._kept.popleft().weight

    def after(self, received: int) -> list[bytes] | None:
        """The messages after number `received`; None if they are kept no longer, or there are not so many."""
        missing = self.count - received
        if not 0 <= missing <= len(self._kept):
            return None
        kept = list(self._kept)
        return [entry.data for entry in kept[len(kept) - missing :]]
