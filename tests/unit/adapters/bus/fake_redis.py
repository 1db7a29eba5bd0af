"""As much of a Redis server, and of redis-py, as the bus uses: streams in memory, which can be broken."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any, cast

from redis.asyncio import Redis
from redis.exceptions import ConnectionError as Away

Entries = list[tuple[bytes, dict[bytes, Any]]]


class FakeRedis:
    """Ids count upwards from `next_id`. While `away` every command fails; `refuse` has some fail alone."""

    def __init__(self) -> None:
        self.streams: dict[bytes, Entries] = {}
        self.expiring: list[bytes] = []
        self.next_id = 1
        self.away = False
        self.forgets_to_answer = False
        """The next commands are done, but the connection breaks before the answer."""
        self.refuse: Callable[[bytes], bool] = lambda key: False
        self.reads: list[dict[bytes, bytes]] = []
        self.ranges: list[tuple[bytes, int]] = []

    @property
    def redis(self) -> Redis:
        """As redis-py's, to the type checker."""
        return cast(Redis, self)

    def add(self, key: bytes, fields: dict[bytes, Any]) -> None:
        """What XADD does."""
        self.streams.setdefault(key, []).append((b"%d-0" % self.next_id, fields))
        self.next_id += 1

    def entries(self, key: bytes) -> list[Any]:
        """What a stream holds."""
        return [fields.get(b"e") for _, fields in self.streams.get(key, ())]

    def restart(self) -> None:
        """With an empty memory and ids that begin anew."""
        self.streams.clear()
        self.next_id = 1

    def check(self) -> None:
        """Raises Away."""
        if self.away:
            raise Away("refused")

    async def ping(self) -> bool:
        self.check()
        return True

    async def xread(self, ids: dict[bytes, bytes], count: int, block: int) -> list[Any]:
        """Waits for two turns of the loop at most."""
        self.reads.append(dict(ids))
        for _ in range(2):
            self.check()
            found = [[key, self._after(key, start)[:count]] for key, start in ids.items()]
            if any(entries for _, entries in found):
                break
            await asyncio.sleep(0)
        return [[key, entries] for key, entries in found if entries]

    def _after(self, key: bytes, start: bytes) -> Entries:
        return [e for e in self.streams.get(key, ()) if int(e[0][:-2]) > int(start[:-2])]

    def pipeline(self, transaction: bool) -> Pipeline:
        assert not transaction
        return Pipeline(self)


class Pipeline:
    """Commands that are done together."""

    def __init__(self, server: FakeRedis) -> None:
        self._server = server
        self._commands: list[Callable[[], Any]] = []

    def execute_command(self, *command: Any) -> None:
        name, key, _, *_, field, value = command
        assert name == "XADD"
        self._commands.append(lambda: self._add(key, field, value))

    def _add(self, key: bytes, field: bytes, value: bytes) -> Any:
        if self._server.refuse(key):
            return ValueError("OOM")
        self._server.add(key, {field: value})
        return b"id"

    def expire(self, key: bytes, seconds: int) -> None:
        assert seconds >= 60
        self._commands.append(lambda: self._server.expiring.append(key))

    def xrevrange(self, key: bytes, count: int) -> None:
        self._server.ranges.append((key, count))
        self._commands.append(lambda: self._server.streams.get(key, [])[::-1][:count])

    async def execute(self, raise_on_error: bool = True) -> list[Any]:
        await asyncio.sleep(0)
        self._server.check()
        answers = [command() for command in self._commands]
        if self._server.forgets_to_answer:
            raise Away("broken off")
        return answers
