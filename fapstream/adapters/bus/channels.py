"""Who listens to which channel of this process, and what those who come late still get."""

from __future__ import annotations

from collections import OrderedDict, deque
from collections.abc import Callable, Iterator
from time import monotonic
from typing import Generic, Protocol, TypeVar

from fapstream.errors import InputError

MAX_ENTRY = 1 << 20
"""Bytes."""
MAX_NAME = 200
"""Bytes of a channel's name in UTF-8."""

BACKLOG_ENTRIES = 100
BACKLOG_BYTES = 256_000
"""About the last four seconds of a talk."""
FORGET_S = 180.0
"""A channel that has been silent for so long has no backlog."""
MAX_BACKLOGS = 2048
"""More channels than anyone speaks in at one time; those that were silent longest are forgotten."""


def check_name(channel: str) -> None:
    """Raises InputError."""
    try:
        size = len(channel.encode())
    except UnicodeEncodeError as error:
        raise InputError(f"a channel's name is no Unicode text: {channel[:40]!r}") from error
    if not 0 < size <= MAX_NAME:
        raise InputError(f"a channel's name has {size} bytes; 1 to {MAX_NAME} are allowed: {channel[:40]!r}")


def check(channel: str, entry: bytes) -> None:
    """Raises InputError."""
    check_name(channel)
    if len(entry) > MAX_ENTRY:
        raise InputError(f"an entry for channel {channel!r} has {len(entry)} bytes; the limit is {MAX_ENTRY}")


class Backlog:
    """The last entries of a channel; None stands where some may be missing."""

    def __init__(self) -> None:
        self.last_at = 0.0
        self._entries: deque[bytes | None] = deque()
        self._size = 0

    def __iter__(self) -> Iterator[bytes | None]:
        return iter(self._entries)

    def add(self, entry: bytes | None) -> None:
        """Keep it, and let go of the oldest beyond the bounds. It never begins with a gap."""
        self._entries.append(entry)
        self._size += len(entry or b"")
        while (self._entries and self._entries[0] is None) or self._beyond():
            self._size -= len(self._entries.popleft() or b"")

    def _beyond(self) -> bool:
        return len(self._entries) > BACKLOG_ENTRIES or self._size > BACKLOG_BYTES


class Sink(Protocol):
    """Where entries go; it takes each at once."""

    def put(self, entry: bytes | None) -> None:
        """The next entry, or a gap."""


S = TypeVar("S", bound=Sink)


class Channels(Generic[S]):
    """Channels by name, each with a backlog and the sinks that joined it."""

    def __init__(self, now: Callable[[], float] = monotonic) -> None:
        self._now = now
        self._backlogs: OrderedDict[str, Backlog] = OrderedDict()
        """The channel that was silent longest comes first."""
        self._sinks: dict[str, dict[S, None]] = {}

    def publish(self, name: str, entry: bytes | None) -> None:
        """Hand an entry, or a gap, to everyone who joined, and keep it for those who will."""
        backlog = self._backlogs.get(name)
        if backlog is None:
            backlog = self._backlogs[name] = Backlog()
        else:
            self._backlogs.move_to_end(name)
        backlog.last_at = self._now()
        backlog.add(entry)
        self._forget_silent()
        for sink in self._sinks.get(name, ()):
            sink.put(entry)

    def join(self, name: str, sink: S) -> None:
        """From now on the sink gets what is published; the backlog comes first."""
        self._forget_silent()
        for entry in self._backlogs.get(name, ()):
            sink.put(entry)
        self._sinks.setdefault(name, {})[sink] = None

    def leave(self, name: str, sink: S) -> bool:
        """Whether it was the last one there."""
        sinks = self._sinks.get(name, {})
        if sink not in sinks:
            return False
        del sinks[sink]
        if sinks:
            return False
        del self._sinks[name]
        return True

    def forget(self, name: str) -> None:
        """Drop what the channel carried."""
        self._backlogs.pop(name, None)

    def everyone(self) -> list[S]:
        """All who joined, once for each channel."""
        return [sink for sinks in self._sinks.values() for sink in sinks]

    def _forget_silent(self) -> None:
        while self._backlogs:
            name, backlog = next(iter(self._backlogs.items()))
            if len(self._backlogs) <= MAX_BACKLOGS and self._now() - backlog.last_at <= FORGET_S:
                return
            del self._backlogs[name]
