"""Processes' buses around a hub; here they are all in one process."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from pathlib import Path

import pytest
import pytest_asyncio

from fapstream.adapters.bus.channels import BACKLOG_ENTRIES
from fapstream.adapters.bus.frames import Frame
from fapstream.adapters.bus.hub import Hub
from fapstream.adapters.bus.worker import HubBus
from fapstream.errors import InputError
from tests.unit.adapters.bus.waits import got, until


class Place:
    """A path where a hub comes and goes, and buses that go with the test."""

    def __init__(self, path: Path) -> None:
        self.path = str(path / "bus")
        self.hub: Hub | None = None
        self.buses: list[HubBus] = []

    async def start(self) -> None:
        self.hub = Hub(self.path)
        await self.hub.start()

    async def stop(self) -> None:
        if self.hub:
            await self.hub.aclose()
            self.hub = None

    async def bus(self, connected: bool = True) -> HubBus:
        bus = HubBus(self.path)
        self.buses.append(bus)
        await until(lambda: bus.connected == connected)
        return bus


@pytest_asyncio.fixture
async def place(tmp_path: Path) -> AsyncIterator[Place]:
    made = Place(tmp_path)
    await made.start()
    yield made
    for bus in made.buses:
        await bus.aclose()
    await made.stop()


def numbered(first: int, end: int) -> list[bytes]:
    return [b"%d" % number for number in range(first, end)]


async def test_in_order_to_everyone_the_publisher_too(place: Place) -> None:
    one, two = await place.bus(), await place.bus()
    subscriptions = [one.subscribe("a"), two.subscribe("a"), two.subscribe("a")]
    for entry in numbered(0, 50):
        one.publish("a", entry)
    for subscription in subscriptions:
        assert await got(subscription, b"49") == numbered(0, 50)


async def test_who_comes_late_gets_the_backlog(place: Place) -> None:
    one, two = await place.bus(), await place.bus()
    first = one.subscribe("a")
    for entry in numbered(0, BACKLOG_ENTRIES + 10):
        one.publish("a", entry)
    await got(first, b"%d" % (BACKLOG_ENTRIES + 9))
    late = [two.subscribe("a"), two.subscribe("a"), one.subscribe("a")]
    one.publish("a", b"live")
    for subscription in late:
        assert await got(subscription, b"live") == [*numbered(10, BACKLOG_ENTRIES + 10), b"live"]


async def test_who_comes_back_gets_the_backlog_again(place: Place) -> None:
    """What was under way for the earlier subscription is not mistaken for the later one's."""
    one, two = await place.bus(), await place.bus()
    before = two.subscribe("a")
    assert two._link
    frames: list[Frame] = []
    receive = two._received
    two._link._received = lambda link, frame: (frames.append(frame), receive(link, frame))[1]
    for entry in numbered(0, 30):
        one.publish("a", entry)
    await got(before, b"29")
    await before.aclose()
    after = two.subscribe("a")
    receive(two._link, frames[-1])
    one.publish("a", b"30")
    assert await got(after, b"30") == numbered(0, 31)


async def test_a_hub_that_was_away_a_moment_costs_a_gap_at_most(place: Place) -> None:
    one, two = await place.bus(), await place.bus()
    told: list[bool] = []
    two.on_state(told.append)
    subscription = two.subscribe("a")
    one.publish("a", b"0")
    await got(subscription, b"0")
    await place.stop()
    await until(lambda: not one.connected and not two.connected)
    for entry in numbered(1, 4):
        one.publish("a", entry)
    await place.start()
    await until(lambda: one.connected and two.connected)
    one.publish("a", b"4")
    assert await got(subscription, b"4") == numbered(1, 5)
    assert told == [False, True]


async def test_what_the_dead_hub_had_not_passed_on_is_a_gap(place: Place) -> None:
    one, two = await place.bus(), await place.bus()
    subscription = two.subscribe("a")
    one.publish("a", b"0")
    await got(subscription, b"0")
    await place.stop()
    await until(lambda: not one.connected and not two.connected)
    one._numbers.stamp("a", b"lost in the hub")
    await place.start()
    one.publish("a", b"2")
    assert await got(subscription, b"2") == [None, b"2"]


async def test_one_that_was_dropped_misses_nothing_that_is_in_the_backlog(place: Place) -> None:
    one, two = await place.bus(), await place.bus()
    subscription = two.subscribe("a")
    one.publish("a", b"0")
    await got(subscription, b"0")
    assert two._link
    two._link.abort()
    for entry in numbered(1, 20):
        one.publish("a", entry)
    assert await got(subscription, b"19") == numbered(1, 20)


async def test_no_hub_at_the_start(place: Place) -> None:
    await place.stop()
    one = await place.bus(connected=False)
    subscription = one.subscribe("a")
    for entry in numbered(0, 3):
        one.publish("a", entry)
    await place.start()
    assert await got(subscription, b"2") == numbered(0, 3)


async def test_the_hub_is_told_what_is_listened_to(place: Place) -> None:
    one = await place.bus()
    assert place.hub
    [joined] = place.hub._joined.values()
    first, second = one.subscribe("a"), one.subscribe("a")
    await until(lambda: joined == {"a"})
    await first.aclose()
    await second.aclose()
    await until(lambda: not joined)


async def test_what_waits_is_sent_before_the_end(place: Place) -> None:
    one, two = await place.bus(), await place.bus()
    subscription = two.subscribe("a")
    for entry in numbered(0, 200):
        one.publish("a", entry)
    await one.aclose()
    one.publish("a", b"too late")
    assert await got(subscription, b"199") == numbered(0, 200)
    assert [entry async for entry in one.subscribe("a")] == []


@pytest.mark.parametrize("away", [False, True])
async def test_the_end_of_the_bus_ends_its_subscriptions(place: Place, away: bool) -> None:
    one = await place.bus()
    subscription = one.subscribe("a")
    if away:
        await place.stop()
    waiting = asyncio.create_task(anext(subscription))
    await asyncio.sleep(0)
    await one.aclose()
    await one.aclose()
    with pytest.raises(StopAsyncIteration):
        await waiting


async def test_what_cannot_be_published(place: Place) -> None:
    one = await place.bus()
    wrong: list[Callable[[], object]] = [lambda: one.publish("", b""), lambda: one.subscribe("")]
    for call in wrong:
        with pytest.raises(InputError):
            call()
