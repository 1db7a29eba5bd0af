"""The bus of one process among several on a machine, joined by the hub in their parent."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from time import monotonic

from fapstream.adapters.bus.channels import check
from fapstream.adapters.bus.following import Following
from fapstream.adapters.bus.frames import Frame, Kind, packed
from fapstream.adapters.bus.inbox import Inbox
from fapstream.adapters.bus.link import Link
from fapstream.adapters.bus.numbers import Numbers
from fapstream.adapters.bus.state import GOODBYE_S, State, waits
from fapstream.adapters.bus.waiting import OUTBOX, Waiting


class HubBus:
    """A Bus through a hub; see the port. To be made where an event loop runs.

    What this process publishes comes back to its own subscribers by way of the hub, so that everyone sees one
    order. When the hub is lost it is called again and again; what it did not pass on shows as a gap.
    """

    def __init__(self, path: str, now: Callable[[], float] = monotonic) -> None:
        """`path`: the hub's socket."""
        self._path = path
        self._state = State(path)
        self._numbers = Numbers(now)
        self._waiting: Waiting[bytes] = Waiting(OUTBOX, now)
        self._following = Following(self._wanted, self._unwanted, now)
        self._open: set[str] = set()
        """Channels whose subscription the hub has taken notice of."""
        self._link: Link | None = None
        self._closed = False
        self._task = asyncio.get_running_loop().create_task(self._run())

    @property
    def connected(self) -> bool:
        """See the port."""
        return self._state.connected

    def on_state(self, tell: Callable[[bool], None]) -> None:
        """See the port."""
        self._state.watch(tell)

    def publish(self, channel: str, entry: bytes) -> None:
        """See the port."""
        check(channel, entry)
        if self._closed:
            return
        frame = packed(Kind.ENTRY, channel, self._numbers.stamp(channel, entry))
        self._waiting.put(frame, len(frame))
        if self._link:
            self._link.wake()

    def subscribe(self, channel: str) -> Inbox:
        """See the port."""
        return self._following.subscribe(channel)

    async def aclose(self) -> None:
        """See the port."""
        self._closed = True
        self._task.cancel()
        await asyncio.wait({self._task})
        if self._link:
            self._link.finish()
            await asyncio.wait({self._link.lost}, timeout=GOODBYE_S)
            self._link.abort()
        await self._following.aclose()

    def _wanted(self, channel: str) -> None:
        if self._link:
            self._link.tell(packed(Kind.SUBSCRIBE, channel))

    def _unwanted(self, channel: str) -> None:
        self._open.discard(channel)
        if self._link:
            self._link.tell(packed(Kind.UNSUBSCRIBE, channel))

    def _received(self, link: Link, frame: Frame) -> None:
        if frame.kind == Kind.SUBSCRIBE:
            self._open.add(frame.channel)
        elif frame.kind == Kind.ENTRY and frame.channel in self._open:
            self._following.receive(frame.channel, frame.body)

    async def _run(self) -> None:
        attempts = waits()
        while True:
            try:
                self._link = await self._connected()
            except OSError as error:
                self._state.down(error.strerror or error)
            else:
                attempts = waits()
                self._state.up()
                await asyncio.wait({self._link.lost})
                self._state.down(self._link.lost.result() or "it closed the connection")
                self._link = None
            await asyncio.sleep(next(attempts))

    async def _connected(self) -> Link:
        """A new connection that asks for everything that is listened to here; what has been seen already is
        known by its numbers."""
        loop = asyncio.get_running_loop()
        _, link = await loop.create_unix_connection(lambda: Link(self._received, self._waiting), self._path)
        self._open.clear()
        for channel in self._following:
            link.tell(packed(Kind.SUBSCRIBE, channel))
        return link
