"""The middle of a server of several processes on one machine: their parent passes on what they publish."""

from __future__ import annotations

import asyncio
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import monotonic

from fapstream.adapters.bus.channels import Channels
from fapstream.adapters.bus.frames import Frame, Kind
from fapstream.adapters.bus.link import Link
from fapstream.adapters.bus.waiting import OUTBOX, Waiting


class Hub:
    """Listens on a Unix socket in a folder that only its user may enter; processes join with `HubBus(path)`.

    An entry goes to the processes that subscribe to its channel, its publisher among them, as it came.
    A process that reads too slowly misses entries, and one that reads nothing is dropped.
    """

    def __init__(self, path: str | None = None, now: Callable[[], float] = monotonic) -> None:
        """`path`: where to listen, in place of a new private folder."""
        self._folder = None if path else tempfile.mkdtemp(prefix="fapstream-")
        self.path = path or str(Path(self._folder or "", "bus"))
        self._now = now
        self._channels: Channels[Link] = Channels(now)
        self._joined: dict[Link, set[str]] = {}
        self._server: asyncio.Server | None = None

    async def start(self) -> None:
        """Listen. Raises OSError."""
        self._server = await asyncio.get_running_loop().create_unix_server(self._link, self.path)

    async def aclose(self) -> None:
        """Drop everyone, and remove the folder."""
        if self._server:
            self._server.close()
        for link in tuple(self._joined):
            link.abort()
        if self._server:
            await self._server.wait_closed()
        if self._folder:
            shutil.rmtree(self._folder, ignore_errors=True)

    def _link(self) -> Link:
        link = Link(self._received, Waiting(OUTBOX, self._now), self._now)
        self._joined[link] = set()
        link.lost.add_done_callback(lambda _: self._lost(link))
        return link

    def _received(self, link: Link, frame: Frame) -> None:
        if frame.kind == Kind.ENTRY:
            self._channels.publish(frame.channel, frame.raw)
        elif frame.kind == Kind.SUBSCRIBE:
            link.tell(frame.raw)
            self._joined[link].add(frame.channel)
            self._channels.join(frame.channel, link)
        elif frame.kind == Kind.UNSUBSCRIBE:
            self._joined[link].discard(frame.channel)
            self._channels.leave(frame.channel, link)

    def _lost(self, link: Link) -> None:
        for channel in self._joined.pop(link, ()):
            self._channels.leave(channel, link)
