"""The bus of servers on several machines: Redis Streams (the extra `bus`).

A channel is the stream `fapstream:talk:<channel>`; each of its entries has one field, `e`, that holds the
numbered entry. A cluster that spreads keys over several nodes cannot be read with one command and is not
supported.
"""

from __future__ import annotations

import asyncio
import secrets
from collections.abc import Awaitable, Callable
from contextlib import suppress
from time import monotonic
from typing import Any, cast
from urllib.parse import urlsplit

from redis.asyncio import ConnectionPool, Redis
from redis.asyncio.connection import parse_url
from redis.asyncio.retry import Retry
from redis.backoff import NoBackoff

from fapstream.adapters.bus.channels import check
from fapstream.adapters.bus.following import Following
from fapstream.adapters.bus.inbox import Inbox
from fapstream.adapters.bus.redis_reader import Reader
from fapstream.adapters.bus.redis_writer import Writer
from fapstream.adapters.bus.state import GOODBYE_S, State, waits
from fapstream.errors import InputError

ANSWER_S = 3.0
"""A broker that has not answered for so long is away."""
CANCEL_S = 0.1
PACE_S = 0.004
"""Between one command and the next: with many talks each then carries more, which halves what they cost; an
entry that comes by itself does not wait for it."""


class RedisBus:
    """A Bus through a Redis server, version 5 or newer; see the port. To be made where an event loop runs."""

    def __init__(self, url: str, now: Callable[[], float] = monotonic) -> None:
        """`url` as redis-py spells it. Connects in its own time. Raises InputError."""
        self._redis = _client(url)
        self._state = State(_shown(url))
        self._failing = {"reading"}
        self._closed = False
        bell = f"fapstream:wake:{secrets.token_hex(8)}".encode()
        self._following = Following(self._wanted, self._unwanted, now)
        self._reader = Reader(self._redis, bell, self._following)
        self._writer = Writer(self._redis, bell, now)
        steps = {"reading": self._reader.step, "writing": self._writer.step}
        loop = asyncio.get_running_loop()
        self._tasks = {loop.create_task(self._keep(name, step)) for name, step in steps.items()}

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
        if not self._closed:
            self._writer.put(channel, entry)

    def subscribe(self, channel: str) -> Inbox:
        """See the port."""
        return self._following.subscribe(channel)

    async def aclose(self) -> None:
        """See the port."""
        self._closed = True
        if self.connected:
            with suppress(TimeoutError):
                async with asyncio.timeout(GOODBYE_S):
                    await self._writer.idle.wait()
        while self._tasks:  # a cancellation is lost when it meets one of redis-py's own time limits
            for task in self._tasks:
                task.cancel()
            _, self._tasks = await asyncio.wait(self._tasks, timeout=CANCEL_S)
        await self._redis.connection_pool.disconnect()
        await self._following.aclose()

    def _wanted(self, channel: str) -> None:
        self._reader.want(channel)
        self._writer.ring()

    def _unwanted(self, channel: str) -> None:
        self._reader.unwant(channel)

    async def _keep(self, name: str, step: Callable[[], Awaitable[None]]) -> None:
        """One step after the other, whatever the broker does."""
        attempts = waits()
        while True:
            try:
                await step()
            except Exception as error:  # an answer that makes no sense must not end the bus either
                self._failing.add(name)
                self._state.down(f"{name} failed: {error or type(error).__name__}")
                await asyncio.sleep(next(attempts))
                continue
            if name in self._failing:
                self._failing.discard(name)
                attempts = waits()
            if not self._failing:
                self._state.up()
            await asyncio.sleep(PACE_S)


def _shown(url: str) -> str:
    """The address without what is secret in it."""
    parts = urlsplit(url)
    return f"{parts.scheme}://{parts.path if parts.scheme == 'unix' else parts.netloc.rpartition('@')[2]}"


def _client(url: str) -> Redis:
    ours = {
        "protocol": 2,
        "decode_responses": False,
        "socket_timeout": ANSWER_S,
        "socket_connect_timeout": ANSWER_S,
        "retry": Retry(NoBackoff(), 0),
    }
    try:
        pool = ConnectionPool(**cast(Any, {**parse_url(url), **ours}))
        cast(Any, pool).make_connection()  # says whether the options of the address are known
    except (TypeError, ValueError) as error:
        raise InputError(f"the bus cannot be at {_shown(url)}: {error}") from error
    return Redis(connection_pool=pool)
