"""Entries are numbered where they are published, so that whoever receives them sees what was lost on the
way and what came twice, whichever way they came.

Before each entry: 8 random bytes that stand for one publisher of the channel, and the number of the entry,
from 0 on, as 64 bits, big-endian.
"""

from __future__ import annotations

import secrets
import struct
from collections import OrderedDict
from collections.abc import Callable
from time import monotonic

from fapstream.adapters.bus.channels import MAX_ENTRY
from fapstream.errors import InputError

HEADER = struct.Struct("!8sQ")
MAX_STAMPED = HEADER.size + MAX_ENTRY
MAX_COUNTED = 4096
"""Channels whose numbers a publisher knows; in another it begins anew, as another publisher."""
AFRESH_S = 1.5
"""Who was silent in a channel for so long begins anew as well: those who came meanwhile may have been told
what others published, and would take entries from before they came for lost."""
MAX_ORIGINS = 16
"""Publishers of one channel that a follower tells apart."""


class Numbers:
    """Numbers what one process publishes."""

    def __init__(self, now: Callable[[], float] = monotonic) -> None:
        self._now = now
        self._next: OrderedDict[str, tuple[bytes, int, float]] = OrderedDict()
        """Of each channel who publishes, the next number, and until when that holds."""

    def stamp(self, channel: str, entry: bytes) -> bytes:
        """The entry with its number before it."""
        now = self._now()
        origin, number, until = self._next.get(channel) or (b"", 0, now)
        if until <= now:
            origin, number = secrets.token_bytes(8), 0
        self._next[channel] = origin, number + 1, now + AFRESH_S
        self._next.move_to_end(channel)
        if len(self._next) > MAX_COUNTED:
            self._next.popitem(last=False)
        return HEADER.pack(origin, number) + entry


class Follower:
    """Receives the numbered entries of one channel."""

    def __init__(self) -> None:
        self._last: OrderedDict[bytes, int] = OrderedDict()
        """Of each publisher; who was heard last is last."""

    def take(self, stamped: object) -> tuple[bytes | None, ...]:
        """The entry, after None if some before it are missing; nothing if it has been seen.

        `stamped` comes from outside. Raises InputError: it is no numbered entry.
        """
        if not isinstance(stamped, bytes) or not HEADER.size <= len(stamped) <= MAX_STAMPED:
            what = f"{len(stamped)} bytes" if isinstance(stamped, bytes) else type(stamped).__name__
            raise InputError(f"no entry of a bus: {what} in place of {HEADER.size} to {MAX_STAMPED} bytes")
        origin, number = HEADER.unpack_from(stamped)
        last = self._last.get(origin)
        if last is not None and number <= last:
            return ()
        expected = (0 if self._last else number) if last is None else last + 1
        self._last[origin] = number
        self._last.move_to_end(origin)
        if len(self._last) > MAX_ORIGINS:
            self._last.popitem(last=False)
        entry = stamped[HEADER.size :]
        return (entry,) if number == expected else (None, entry)
