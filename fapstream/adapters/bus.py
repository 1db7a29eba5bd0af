"""The Bus port within one process, and the choice of a bus by its address."""

from __future__ import annotations

from collections.abc import AsyncGenerator

from fapstream.adapters.topic import Topic
from fapstream.errors import InputError
from fapstream.ports import Bus

REDIS = ("redis://", "rediss://", "unix://")


class LocalBus:
    """Speakers and listeners in the same process."""

    def __init__(self) -> None:
        self._topics: dict[str, Topic] = {}

    def publish(self, channel: str, entry: bytes) -> None:
        """See the port."""
        self._topics.setdefault(channel, Topic()).put(entry)

    async def subscribe(self, channel: str) -> AsyncGenerator[bytes | None, None]:
        """See the port."""
        topic = self._topics.setdefault(channel, Topic())
        async for entry in topic.subscribe():
            yield entry

    async def aclose(self) -> None:
        """See the port."""


def open_bus(url: str | None) -> Bus:
    """The bus at an address; None is within this process. Raises InputError."""
    if url is None:
        return LocalBus()
    if not url.startswith(REDIS):
        raise InputError(f"{url!r} is no bus: it begins with {', '.join(REDIS)}")
    try:
        from fapstream.adapters.bus_redis import RedisBus
    except ModuleNotFoundError as e:
        if (e.name or "").partition(".")[0] != "redis":
            raise
        raise InputError("a bus on Redis needs its client: pip install 'fapstream[bus]'") from None
    return RedisBus(url)
