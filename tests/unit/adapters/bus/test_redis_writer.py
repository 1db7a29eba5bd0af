"""Publishing to streams, over connections that fail."""

from __future__ import annotations

import asyncio
import logging
from contextlib import suppress

import pytest
from redis.exceptions import ConnectionError as Away

from fapstream.adapters.bus.numbers import Follower
from fapstream.adapters.bus.redis_writer import EXPIRE_EVERY_S, Writer, key_of
from fapstream.adapters.bus.waiting import OUTBOX
from tests.unit.adapters.bus.fake_redis import FakeRedis


class Desk:
    """A writer with its server and its time."""

    def __init__(self) -> None:
        self.now = 100.0
        self.server = FakeRedis()
        self.writer = Writer(self.server.redis, b"bell", lambda: self.now)
        self.follower = Follower()

    def received(self, channel: str = "a") -> list[bytes | None]:
        """What a reader of everything makes of the stream."""
        return [e for stamped in self.server.entries(key_of(channel)) for e in self.follower.take(stamped)]


async def test_batches_in_order_and_every_stream_told_when_to_go() -> None:
    desk = Desk()
    for channel, entry in (("a", b"1"), ("b", b"2"), ("a", b"3")):
        desk.writer.put(channel, entry)
    assert not desk.writer.idle.is_set()
    await desk.writer.step()
    assert desk.received() == [b"1", b"3"]
    assert sorted(desk.server.expiring) == [key_of("a"), key_of("b")]
    assert desk.writer.idle.is_set()


async def test_it_waits_when_there_is_nothing() -> None:
    desk = Desk()
    step = asyncio.create_task(desk.writer.step())
    await asyncio.sleep(0)
    assert not step.done()
    desk.writer.put("a", b"1")
    await step
    assert desk.received() == [b"1"]


async def test_streams_are_told_again_now_and_then() -> None:
    desk = Desk()
    for wait in (0.0, 1.0, EXPIRE_EVERY_S):
        desk.now += wait
        desk.writer.put("a", b"1")
        await desk.writer.step()
    assert desk.server.expiring == [key_of("a")] * 2


async def test_and_again_after_a_failure() -> None:
    desk = Desk()
    desk.writer.put("a", b"1")
    await desk.writer.step()
    desk.server.away = True
    desk.writer.put("a", b"2")
    with pytest.raises(Away):
        await desk.writer.step()
    desk.server.away = False
    await desk.writer.step()
    assert desk.server.expiring == [key_of("a")] * 2


@pytest.mark.parametrize("done", [False, True])
async def test_a_batch_that_failed_is_sent_again_and_heard_once(done: bool) -> None:
    desk = Desk()
    desk.writer.put("a", b"1")
    desk.server.away, desk.server.forgets_to_answer = not done, done
    with pytest.raises(Away):
        await desk.writer.step()
    desk.server.away = desk.server.forgets_to_answer = False
    desk.writer.put("a", b"2")
    assert not desk.writer.idle.is_set()
    await desk.writer.step()
    await desk.writer.step()
    assert desk.received() == [b"1", b"2"]


async def test_after_a_long_outage_only_the_live_edge_is_sent_and_the_rest_is_a_gap() -> None:
    desk = Desk()
    desk.writer.put("a", b"0")
    await desk.writer.step()
    desk.server.away = True
    for _ in range(20):
        desk.now += 1.0
        desk.writer.put("a", b"%d" % desk.now)
        with suppress(Away):
            await desk.writer.step()
    desk.server.away = False
    desk.writer.put("a", b"now")
    while not desk.writer.idle.is_set():
        await desk.writer.step()
    got = desk.received()
    assert got[:2] == [b"0", None]
    assert got[-1] == b"now"
    assert 2 <= len(got) - 2 <= 2 * OUTBOX.age_s + 2


async def test_one_channel_that_is_refused_does_not_hold_up_another(caplog: pytest.LogCaptureFixture) -> None:
    desk = Desk()
    desk.server.refuse = lambda key: key == key_of("b")
    with caplog.at_level(logging.WARNING):
        for entry in (b"1", b"2"):
            desk.writer.put("a", entry)
            desk.writer.put("b", entry)
            await desk.writer.step()
    assert desk.received() == [b"1", b"2"]
    assert desk.received("b") == []
    assert len(caplog.records) == 1


async def test_a_server_that_refuses_everything_is_away() -> None:
    desk = Desk()
    desk.server.refuse = lambda key: True
    desk.writer.put("a", b"1")
    with pytest.raises(ValueError, match="OOM"):
        await desk.writer.step()
    desk.server.refuse = lambda key: False
    await desk.writer.step()
    assert desk.received() == [b"1"]


async def test_the_bell() -> None:
    desk = Desk()
    desk.writer.ring()
    await desk.writer.step()
    assert desk.server.entries(b"bell") == [b""]
    assert desk.server.expiring == [b"bell"]
    step = asyncio.create_task(desk.writer.step())
    await asyncio.sleep(0)
    assert not step.done()
    step.cancel()
