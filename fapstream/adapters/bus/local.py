"""The bus of a server that is one process."""

from __future__ import annotations

from collections.abc import Callable
from time import monotonic

from fapstream.adapters.bus.channels import Channels, check, check_name
from fapstream.adapters.bus.inbox import Inbox


class LocalBus:
    """A Bus within one process; see the port."""

    connected = True

    def __init__(
        self,
        now: Callable[[], float] = monotonic,
        deserted: Callable[[str], None] = lambda _: None,
    ) -> None:
        """`deserted` is called with a channel that its last subscriber has left."""
        self._channels: Channels[Inbox] = Channels(now)
        self._deserted = deserted
        self._closed = False

    def on_state(self, tell: Callable[[bool], None]) -> None:
        """See the port: there is nothing to tell."""

    def publish(self, channel: str, entry: bytes) -> None:
        """See the port."""
        check(channel, entry)
        self.hand_on(channel, entry)

    def hand_on(self, channel: str, entry: bytes | None) -> None:
        """Publish what was checked before, or a gap."""
        if not self._closed:
            self._channels.publish(channel, entry)

    def subscribe(self, channel: str) -> Inbox:
        """See the port."""
        check_name(channel)
        inbox = Inbox(lambda inbox: self._leave(channel, inbox))
        if self._closed:
            inbox.end()
        else:
            self._channels.join(channel, inbox)
        return inbox

    def forget(self, channel: str) -> None:
        """Have no backlog of the channel."""
        self._channels.forget(channel)

    async def aclose(self) -> None:
        """See the port."""
        self._closed = True
        for inbox in self._channels.everyone():
            inbox.end()

    def _leave(self, channel: str, inbox: Inbox) -> None:
        if self._channels.leave(channel, inbox):
            self._deserted(channel)
