"""Publishing to Redis Streams: entries in batches, one round trip each."""

from __future__ import annotations

import asyncio
import logging
import math
from collections.abc import Callable
from time import monotonic

from redis.asyncio import Redis

from fapstream.adapters.bus.channels import FORGET_S
from fapstream.adapters.bus.numbers import MAX_COUNTED, Numbers
from fapstream.adapters.bus.waiting import OUTBOX, Waiting

log = logging.getLogger("fapstream.bus")

PREFIX = b"fapstream:talk:"
FIELD = b"e"
STREAM_ENTRIES = 250
"""About so many a stream keeps."""
BATCH_BYTES = 1_000_000
EXPIRE_EVERY_S = 10.0


def key_of(channel: str) -> bytes:
    """The stream of a channel."""
    return PREFIX + channel.encode()


class Writer:
    """Sends what waits. A batch whose sending failed is sent again while it is worth it: what came twice is
    known by its number."""

    def __init__(self, redis: Redis, bell: bytes, now: Callable[[], float] = monotonic) -> None:
        """`bell`: the stream that `ring` adds to."""
        self._redis = redis
        self._bell = bell
        self._now = now
        self._numbers = Numbers(now)
        self._waiting: Waiting[tuple[str, bytes]] = Waiting(OUTBOX, now)
        self._batch: list[tuple[str, bytes]] = []
        self._taken_at = 0.0
        self._ringing = False
        self._refused = False
        self._expiring: dict[str, float] = {}
        """When a channel's stream was last told when to go."""
        self._work = asyncio.Event()
        self.idle = asyncio.Event()
        """Nothing waits."""
        self.idle.set()

    def put(self, channel: str, entry: bytes) -> None:
        """Have an entry sent."""
        stamped = self._numbers.stamp(channel, entry)
        self._waiting.put((channel, stamped), len(stamped))
        self._work.set()
        self.idle.clear()

    def ring(self) -> None:
        """Have the bell rung."""
        self._ringing = True
        self._work.set()

    async def step(self) -> None:
        """Wait for something to send, and send it. Raises RedisError, OSError."""
        await self._work.wait()
        if self._now() - self._taken_at > OUTBOX.age_s:
            self._batch = []
        if not self._batch:
            self._batch = self._waiting.take(BATCH_BYTES)
            self._taken_at = self._now()
        await self._send(self._batch)
        self._batch = []
        if not self._waiting:
            self.idle.set()
            if not self._ringing:
                self._work.clear()

    async def _send(self, batch: list[tuple[str, bytes]]) -> None:
        pipe = self._redis.pipeline(transaction=False)
        for channel, stamped in batch:
            pipe.execute_command("XADD", key_of(channel), "MAXLEN", "~", STREAM_ENTRIES, "*", FIELD, stamped)
        for channel in self._due({channel for channel, _ in batch}):
            pipe.expire(key_of(channel), round(FORGET_S))
        if self._ringing:
            self._ringing = False
            pipe.execute_command("XADD", self._bell, "MAXLEN", 1, "*", FIELD, b"")
            pipe.expire(self._bell, round(FORGET_S))
        try:
            self._check((await pipe.execute(raise_on_error=False))[: len(batch)])
        except BaseException:
            self._expiring.clear()  # for all we know the broker begins anew
            raise

    def _due(self, channels: set[str]) -> list[str]:
        """Those whose streams are to be told again that they live on."""
        now = self._now()
        due = [c for c in channels if now - self._expiring.get(c, -math.inf) > EXPIRE_EVERY_S]
        if len(self._expiring) + len(due) > MAX_COUNTED:
            self._expiring.clear()
        self._expiring.update(dict.fromkeys(due, now))
        return due

    def _check(self, answers: list[object]) -> None:
        """Raises what the broker said if it took nothing of a batch; one channel must not hold up others."""
        refused = [answer for answer in answers if isinstance(answer, Exception)]
        if refused and len(refused) == len(answers):
            raise refused[0]
        if refused and not self._refused:
            log.warning(
                "the bus took %d of %d entries: %s", len(answers) - len(refused), len(answers), refused[0]
            )
        self._refused = bool(refused)
