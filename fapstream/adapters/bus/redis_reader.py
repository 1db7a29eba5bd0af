"""Subscribing to Redis Streams: one connection reads all channels of a process.

Reading begins with what a stream holds now, at first and after every loss of the connection: the numbers
tell what has been seen, so it does not matter that a broker which lost its memory begins with other ids, nor
that a publisher sent again what it was sending when its connection broke.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice
from typing import Any, cast

from redis.asyncio import Redis

from fapstream.adapters.bus.channels import BACKLOG_ENTRIES, Backlog
from fapstream.adapters.bus.following import Following
from fapstream.adapters.bus.redis_writer import FIELD, STREAM_ENTRIES, key_of

READ_ENTRIES = 64
"""Of each channel at a time."""
READ_CHANNELS = 32
"""So many are looked up at a time."""
BLOCK_MS = 1000
START = b"0-0"


@dataclass(slots=True, eq=False)
class Position:
    """How far a channel has been read."""

    id: bytes | None = None
    """None: what the stream holds now is to be looked up."""
    seen: bool = False
    """It has been, once."""


class Reader:
    """Reads the wanted channels, and the bell: an entry there ends a read that waits, so that the next one
    knows what is wanted since."""

    def __init__(self, redis: Redis, bell: bytes, following: Following) -> None:
        self._redis = redis
        self._bell = bell
        self._rung = START
        self._following = following
        self._positions: dict[str, Position] = {}
        self._lost = True

    def want(self, channel: str) -> None:
        """Read it from the next step on."""
        self._positions[channel] = Position()

    def unwant(self, channel: str) -> None:
        """Read it no more."""
        self._positions.pop(channel, None)

    async def step(self) -> None:
        """Read once, or find the broker again. Raises RedisError, OSError."""
        try:
            if self._lost:
                await self._begin()
            elif fresh := [(c, p) for c, p in self._positions.items() if p.id is None]:
                await self._look_up(dict(islice(fresh, READ_CHANNELS)))
            else:
                await self._follow()
        except Exception:
            self._lost = True
            raise

    async def _begin(self) -> None:
        await self._redis.ping()
        self._lost = False
        self._rung = START
        for position in self._positions.values():
            position.id = None

    async def _look_up(self, fresh: dict[str, Position]) -> None:
        """What the streams hold: all of it after a loss, and for a new subscriber the backlog."""
        pipe = self._redis.pipeline(transaction=False)
        for channel, position in fresh.items():
            pipe.xrevrange(key_of(channel), count=STREAM_ENTRIES if position.seen else BACKLOG_ENTRIES)
        for (channel, position), newest_first in zip(fresh.items(), await pipe.execute(), strict=True):
            held = newest_first[::-1]
            entries = [fields.get(FIELD) for _, fields in held]
            self._receive(channel, position, entries if position.seen else _backlog(entries))
            position.id = held[-1][0] if held else START
            position.seen = True

    async def _follow(self) -> None:
        """Wait for the next entries of all channels."""
        asked = {key_of(channel): (channel, position) for channel, position in self._positions.items()}
        ids = {self._bell: self._rung, **{key: position.id for key, (_, position) in asked.items()}}
        answer = await self._redis.xread(cast(Any, ids), READ_ENTRIES, BLOCK_MS)
        for key, entries in cast(Any, answer):
            if key == self._bell:
                self._rung = entries[-1][0]
                continue
            channel, position = asked[key]
            self._receive(channel, position, [fields.get(FIELD) for _, fields in entries])
            position.id = entries[-1][0]

    def _receive(self, channel: str, position: Position, entries: list[object]) -> None:
        if self._positions.get(channel) is position:  # or else it was meant for an earlier subscription
            for stamped in entries:
                self._following.receive(channel, stamped)


def _backlog(entries: list[object]) -> list[object]:
    """The last of them, within the bounds of a backlog."""
    backlog = Backlog()
    for entry in entries:
        backlog.add(entry if isinstance(entry, bytes) else None)
    return [entry for entry in backlog if entry is not None]
