"""Addresses of buses."""

from __future__ import annotations

import importlib.util

import pytest

from fapstream.adapters.bus import LocalBus, open_bus
from fapstream.adapters.bus.redis_bus import RedisBus
from fapstream.errors import InputError


async def test_no_address_is_this_process() -> None:
    assert isinstance(open_bus(None), LocalBus)


@pytest.mark.parametrize("url", ["redis://127.0.0.1:1", "rediss://127.0.0.1:1/0", "unix:///nowhere"])
async def test_a_redis_server(url: str) -> None:
    bus = open_bus(url)
    assert isinstance(bus, RedisBus)
    await bus.aclose()


@pytest.mark.parametrize("url", ["", "localhost:6379", "http://h", "amqp://user:secret@h", "redis:h"])
async def test_other_addresses(url: str) -> None:
    with pytest.raises(InputError, match="redis://HOST") as caught:
        open_bus(url)
    assert "secret" not in str(caught.value)


@pytest.mark.parametrize(
    "url", ["redis://:secret@h:port", "redis://:secret@h?colour=red", "redis://:secret@h?db=x"]
)
async def test_wrong_addresses(url: str) -> None:
    with pytest.raises(InputError, match="cannot be at redis://h") as caught:
        open_bus(url)
    assert "secret" not in str(caught.value)


async def test_without_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"fapstream\[bus\]"):
        open_bus("redis://localhost")
