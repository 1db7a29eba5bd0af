"""Which bus an address means."""

from __future__ import annotations

import importlib.util

from fapstream.adapters.bus.local import LocalBus
from fapstream.errors import InputError
from fapstream.ports import Bus

SCHEMES = ("redis", "rediss", "unix")


def open_bus(url: str | None) -> Bus:
    """The bus at `redis://HOST:PORT/DB`, `rediss://...` (TLS) or `unix://PATH` of a Redis server; without an
    address, one within this process. To be called where an event loop runs; connects in its own time.

    Raises InputError: another kind of address, a wrong one, or the extra `bus` is not installed.
    """
    if url is None:
        return LocalBus()
    scheme, separator, _ = url.partition("://")
    if not separator or scheme not in SCHEMES:
        wrong = f"{scheme[:20]}://" if separator else "what has no scheme"
        raise InputError(f"a bus is at redis://HOST:PORT, rediss://HOST:PORT or unix://PATH; not at {wrong}")
    if importlib.util.find_spec("redis") is None:
        raise InputError("a bus through Redis needs redis-py: pip install 'fapstream[bus]'")
    from fapstream.adapters.bus.redis_bus import RedisBus

    return RedisBus(url)
