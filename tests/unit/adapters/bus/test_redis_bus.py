"""The whole of it without a server: it is away. (With one: tests/e2e/test_bus.py.)"""

from __future__ import annotations

import asyncio
import logging
from pathlib import Path

import pytest

from fapstream.adapters.bus.redis_bus import RedisBus
from fapstream.errors import InputError
from tests.unit.adapters.bus.waits import until


async def test_without_a_server_nothing_blocks_and_nothing_raises(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING):
        bus = RedisBus(f"unix://{tmp_path}/nobody?password=secret")
        told: list[bool] = []
        bus.on_state(told.append)
        subscription = bus.subscribe("a")
        bus.publish("a", b"1")
        await until(lambda: bool(caplog.records))
        waiting = asyncio.create_task(anext(subscription))
        await asyncio.sleep(0)
        await bus.aclose()
    with pytest.raises(StopAsyncIteration):
        await waiting
    assert told == []
    assert not bus.connected
    assert "away" in caplog.text
    assert "secret" not in caplog.text


async def test_after_its_end_nothing_happens(tmp_path: Path) -> None:
    bus = RedisBus(f"unix://{tmp_path}/nobody")
    await bus.aclose()
    await bus.aclose()
    bus.publish("a", b"1")
    assert [entry async for entry in bus.subscribe("a")] == []


async def test_a_cancellation_that_is_lost_on_the_way_does_not_keep_it_open(tmp_path: Path) -> None:
    """As happens when it meets the end of one of redis-py's own time limits."""
    bus = RedisBus(f"unix://{tmp_path}/nobody")
    swallowed: list[str] = []

    async def deaf() -> None:
        try:
            await asyncio.Event().wait()
        except asyncio.CancelledError:
            if swallowed:
                raise
            swallowed.append("once")

    task = asyncio.create_task(bus._keep("reading", deaf))
    bus._tasks.add(task)
    await asyncio.sleep(0)
    async with asyncio.timeout(20):
        await bus.aclose()
    assert swallowed
    assert task.done()


async def test_what_cannot_be_published(tmp_path: Path) -> None:
    bus = RedisBus(f"unix://{tmp_path}/nobody")
    with pytest.raises(InputError):
        bus.publish("", b"")
    with pytest.raises(InputError):
        bus.subscribe("")
    await bus.aclose()
