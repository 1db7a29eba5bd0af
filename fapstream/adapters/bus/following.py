"""The channels of other processes that are listened to in this one."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from time import monotonic

from fapstream.adapters.bus.channels import check_name
from fapstream.adapters.bus.inbox import Inbox
from fapstream.adapters.bus.local import LocalBus
from fapstream.adapters.bus.numbers import Follower
from fapstream.errors import InputError

log = logging.getLogger("fapstream.bus")


class Following:
    """Hands what is received on to this process's subscribers, each entry once and in order.

    A channel is fetched from outside once, however many listen.
    """

    def __init__(
        self,
        wanted: Callable[[str], None],
        unwanted: Callable[[str], None],
        now: Callable[[], float] = monotonic,
    ) -> None:
        """`wanted`, `unwanted`: called with a channel before its first and after its last subscriber."""
        self._wanted = wanted
        self._unwanted = unwanted
        self._local = LocalBus(now, self._deserted)
        self._followers: dict[str, Follower] = {}
        self._refused: set[str] = set()
        """Channels of which something was left out."""

    def __iter__(self) -> Iterator[str]:
        return iter(self._followers)

    def subscribe(self, channel: str) -> Inbox:
        """See the port."""
        check_name(channel)
        if channel not in self._followers:
            self._local.forget(channel)
            self._followers[channel] = Follower()
            self._wanted(channel)
        return self._local.subscribe(channel)

    def receive(self, channel: str, stamped: object) -> None:
        """What came from outside: a numbered entry, if the other side is in order; else it is left out."""
        follower = self._followers.get(channel)
        if follower is None:
            return
        try:
            entries = follower.take(stamped)
        except InputError as error:
            if channel not in self._refused:
                log.warning(
                    "channel %r: %s; more of the kind will be left out without a word", channel, error
                )
                self._refused.add(channel)
            return
        for entry in entries:
            self._local.hand_on(channel, entry)

    async def aclose(self) -> None:
        """End every subscription."""
        self._followers.clear()
        await self._local.aclose()

    def _deserted(self, channel: str) -> None:
        self._refused.discard(channel)
        if self._followers.pop(channel, None):
            self._unwanted(channel)
