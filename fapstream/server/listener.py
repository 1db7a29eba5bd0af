"""One who only listens: gets what its connection can take, and never holds anybody up."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from fapstream.protocol import generated as g
from fapstream.protocol.codec import encode
from fapstream.server.channel import Channel, Item
from fapstream.server.link import Link

THIN_BYTES = 16_384
"""With so much waiting to go, packets are sent without what is preferred less: half a second of sound."""

SKIP_BYTES = 49_152
"""With so much waiting nothing more is sent until it has gone."""

GIVE_UP_S = 10.0
"""Who has not caught up after so long is let go."""

Level = Literal["thin", "skipped"]


class Listening:
    """`count` is told of every packet that is not sent whole. `now`: the server's clock."""

    def __init__(
        self,
        link: Link,
        prefer: Literal["sound", "face"],
        now: Callable[[], float],
        count: Callable[[Level], None] = lambda _: None,
    ) -> None:
        self.channel: Channel | None = None
        self._link = link
        self._sound = prefer == "sound"
        self._now = now
        self._count = count
        self._stuck_since: float | None = None

    def offer(self, item: Item) -> None:
        """See channel.Listener."""
        link = self._link
        if self._stuck_since is None:
            backlog = link.backlog
            if backlog <= THIN_BYTES or not isinstance(item.message, g.Packet):
                link.write_framed(item.whole)
                return
            if backlog <= SKIP_BYTES:
                self._count("thin")
                link.write_framed(item.without_face if self._sound else item.without_sound)
                return
            self._stuck_since = self._now()
        if isinstance(item.message, g.Packet):
            self._catch_up(item)
        else:
            link.write_framed(item.whole)

    @property
    def hopeless(self) -> bool:
        """It takes too little, and has for too long."""
        return self._stuck_since is not None and self._now() - self._stuck_since > GIVE_UP_S

    def _catch_up(self, item: Item) -> None:
        """Go on with a key once everything has gone."""
        begin = self.channel.begin_at(item) if self.channel and not self._link.backlog else None
        if begin is None:
            self._count("skipped")
            return
        self._stuck_since = None
        self._link.write(encode(g.Skip(reason="slow")))
        self._link.write_framed(begin.whole)
        self._link.write_framed(item.whole)
