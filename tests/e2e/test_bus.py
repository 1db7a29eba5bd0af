"""The bus between processes: through a real Redis server that is killed and started again, and a real hub."""

from __future__ import annotations

import asyncio
import shutil
import socket
import subprocess
from collections.abc import AsyncIterator, Iterator
from contextlib import ExitStack
from pathlib import Path
from urllib.parse import quote

import pytest
import pytest_asyncio
from redis.asyncio import Redis

from fapstream.adapters.bus import Hub, HubBus, open_bus
from fapstream.adapters.bus.channels import BACKLOG_ENTRIES, FORGET_S
from fapstream.ports import Bus
from tests.benchmarks import broker as brokers
from tests.benchmarks.broker import Broker
from tests.benchmarks.bus_process import END, Process, entry, process
from tests.unit.adapters.bus.waits import got, until

pytestmark = pytest.mark.skipif(not brokers.installed(), reason="redis-server is not installed")
KEY = "fapstream:talk:a"


@pytest.fixture
def stopped() -> Iterator[Broker]:
    """A broker that does not run yet."""
    with brokers.broker() as made:
        yield made


@pytest.fixture
def broker(stopped: Broker) -> Broker:
    """One that runs."""
    stopped.start()
    return stopped


class Buses:
    """Made for a test, and closed after it."""

    def __init__(self) -> None:
        self._open: list[Bus] = []

    async def open(self, url: str, connected: bool = True) -> Bus:
        bus = open_bus(url)
        self._open.append(bus)
        await until(lambda: bus.connected or not connected)
        return bus

    async def aclose(self) -> None:
        for bus in self._open:
            await bus.aclose()


@pytest_asyncio.fixture
async def buses() -> AsyncIterator[Buses]:
    made = Buses()
    yield made
    await made.aclose()


def numbered(first: int, end: int) -> list[bytes]:
    return [b"%d" % number for number in range(first, end)]


async def subscribed(one: Bus, other: Bus) -> AsyncIterator[bytes | None]:
    """A subscription of the other's that is known to work."""
    subscription = other.subscribe("a")
    one.publish("a", b"0")
    assert await got(subscription, b"0") == [b"0"]
    return subscription


async def restarted(broker: Broker, *watching: Bus) -> None:
    """Killed, found away by all, started with an empty memory, found again."""
    broker.kill()
    await until(lambda: not any(bus.connected for bus in watching))
    broker.start()
    await until(lambda: all(bus.connected for bus in watching))


async def test_in_order_to_everyone(broker: Broker, buses: Buses) -> None:
    one, two = await buses.open(broker.url), await buses.open(broker.url)
    subscriptions = [bus.subscribe(channel) for bus in (one, two, two) for channel in "ab"]
    for first in (0, BACKLOG_ENTRIES):
        for number in numbered(first, first + BACKLOG_ENTRIES):
            one.publish("a", number)
            one.publish("b", number)
        for subscription in subscriptions:
            last = first + BACKLOG_ENTRIES
            assert await got(subscription, b"%d" % (last - 1)) == numbered(first, last)


async def test_who_comes_late_gets_the_backlog_and_then_the_live_entries(
    broker: Broker, buses: Buses
) -> None:
    one, two = await buses.open(broker.url), await buses.open(broker.url)
    first = one.subscribe("a")
    for number in numbered(0, 150):
        one.publish("a", number)
    await got(first, b"149")
    late = two.subscribe("a")
    assert await anext(late) == b"50"
    one.publish("a", b"150")
    assert await got(late, b"150") == numbered(51, 151)


async def test_a_new_subscription_does_not_wait_for_a_read_that_blocks(broker: Broker, buses: Buses) -> None:
    """Ten in turn take no longer than a few of the reads that they interrupt would."""
    bus = await buses.open(broker.url)
    start = asyncio.get_running_loop().time()
    for number in range(10):
        subscription = bus.subscribe(f"c{number}")
        bus.publish(f"c{number}", b"1")
        assert await got(subscription, b"1") == [b"1"]
        await asyncio.sleep(0.02)  # so that the reader waits again
    assert asyncio.get_running_loop().time() - start < 5.0


async def test_memory_is_bounded_and_goes_in_the_end(broker: Broker, buses: Buses) -> None:
    bus = await buses.open(broker.url)
    subscription = bus.subscribe("a")
    for number in numbered(0, 3000):
        bus.publish("a", number)
        if number.endswith(b"00"):
            await got(subscription, number)
    await got(subscription, b"2999")
    async with Redis(unix_socket_path=broker.socket) as redis:
        assert 250 <= await redis.xlen(KEY) < 500
        assert FORGET_S - 60 < await redis.ttl(KEY) <= FORGET_S
        for key in await redis.keys("*"):
            assert await redis.ttl(key) > 0, key


async def test_a_broker_that_loses_its_memory_in_the_middle(broker: Broker, buses: Buses) -> None:
    one, two = await buses.open(broker.url), await buses.open(broker.url)
    told: list[bool] = []
    two.on_state(told.append)
    subscription = await subscribed(one, two)
    broker.kill()
    await until(lambda: not one.connected and not two.connected)
    for number in numbered(1, 20):
        one.publish("a", number)
    broker.start()
    assert await got(subscription, b"19") == numbered(1, 20), "what waited meanwhile comes"
    await until(lambda: one.connected and two.connected)
    assert told == [False, True]


async def test_what_was_lost_with_the_broker_is_one_gap(broker: Broker, buses: Buses) -> None:
    one, two = await buses.open(broker.url), await buses.open(broker.url)
    subscription = await subscribed(one, two)
    broker.kill()
    await until(lambda: not one.connected and not two.connected)
    for number in numbered(1, 3000):  # more than a stream keeps
        one.publish("a", number)
    broker.start()
    found = await got(subscription, b"2999")
    assert found[0] is None
    assert found[-2:] == numbered(2998, 3000)
    assert found.count(None) <= 2


async def test_ids_that_go_back(broker: Broker, buses: Buses) -> None:
    """The clock of the broker that comes back is behind: nothing new would be later than what was seen."""
    async with Redis(unix_socket_path=broker.socket) as redis:
        await redis.xadd(KEY, {"e": b"to come"}, id="99999999999999-0")
    one, two = await buses.open(broker.url), await buses.open(broker.url)
    subscription = await subscribed(one, two)
    await restarted(broker, one, two)
    one.publish("a", b"1")
    assert await got(subscription, b"1") == [b"1"]
    one.publish("a", b"2")
    assert await got(subscription, b"2") == [b"2"]


async def test_down_at_the_start(stopped: Broker, buses: Buses) -> None:
    one = await buses.open(stopped.url, connected=False)
    two = await buses.open(stopped.url, connected=False)
    subscription = two.subscribe("a")
    for number in numbered(0, 5):
        one.publish("a", number)
    stopped.start()
    await until(lambda: one.connected and two.connected)
    one.publish("a", b"5")
    assert await got(subscription, b"5") == numbered(0, 6)


async def test_entries_of_others_are_left_out(broker: Broker, buses: Buses) -> None:
    one, two = await buses.open(broker.url), await buses.open(broker.url)
    subscription = await subscribed(one, two)
    async with Redis(unix_socket_path=broker.socket) as redis:
        await redis.xadd(KEY, {"e": b"short"})
        await redis.xadd(KEY, {"x": b"other"})
        await redis.xadd(KEY, {"e": bytes(2 << 20)})
    one.publish("a", b"1")
    assert await got(subscription, b"1") == [b"1"]


async def test_what_waits_is_sent_before_the_end(broker: Broker, buses: Buses) -> None:
    one, two = await buses.open(broker.url), await buses.open(broker.url)
    subscription = await subscribed(one, two)
    for number in numbered(1, 100):
        one.publish("a", number)
    await one.aclose()
    assert await got(subscription, b"99") == numbered(1, 100)


async def test_a_password_and_tls(buses: Buses, tmp_path: Path) -> None:
    if not shutil.which("openssl"):
        pytest.skip("openssl is not installed")
    key, certificate = tmp_path / "key.pem", tmp_path / "cert.pem"
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-subj", "/CN=localhost", "-days", "2",
         "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", str(key), "-out", str(certificate)],
        check=True, capture_output=True,
    )  # fmt: skip
    port = str(free_port())
    tls = ["--tls-port", port, "--tls-cert-file", str(certificate), "--tls-key-file", str(key)]
    with brokers.broker(*tls, "--tls-auth-clients", "no", "--bind", "127.0.0.1") as broker:
        broker.start()
        async with Redis(unix_socket_path=broker.socket) as redis:
            await redis.acl_setuser(
                "talker", enabled=True, passwords="+s3cret", commands=["+@all"], keys=["fapstream:*"]
            )
        url = f"rediss://talker:s3cret@127.0.0.1:{port}?ssl_ca_certs={quote(str(certificate))}"
        one, two = await buses.open(url), await buses.open(url)
        await subscribed(one, two)
        stranger = await buses.open(url.replace("s3cret", "wrong"), connected=False)
        stranger.publish("a", b"1")
        untrusting = await buses.open(url.partition("?")[0], connected=False)
        untrusting.publish("a", b"1")
        one.publish("a", b"2")
        assert await got(two.subscribe("a"), b"2") == [b"0", b"2"]
        assert not stranger.connected
        assert not untrusting.connected


def free_port() -> int:
    """One that nobody listens at."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


async def talk(bus: Bus, channels: list[str], first: int, end: int) -> None:
    """At twenty times the pace of a talk."""
    for number in range(first, end):
        for channel in channels:
            bus.publish(channel, entry(number))
        await asyncio.sleep(0.002)


def finish(bus: Bus, channels: list[str]) -> None:
    """A listener that is still calling finds the end in the backlog."""
    for channel in channels:
        bus.publish(channel, entry(END))


@pytest.mark.parametrize("restart", [False, True])
async def test_several_processes_through_redis(broker: Broker, buses: Buses, restart: bool) -> None:
    channels = ["a", "b", "c"]
    bus = await buses.open(broker.url)
    with ExitStack() as stack:
        listeners = await listening(stack, broker.url, channels)
        await talk(bus, channels, 0, 100)
        if restart:
            await restarted(broker, bus)
        await talk(bus, channels, 100, 300)
        finish(bus, channels)
        await check(listeners, restart)


async def listening(stack: ExitStack, address: str, channels: list[str]) -> list[Process]:
    """Three listeners that have subscribed."""
    return [
        await asyncio.to_thread(lambda: stack.enter_context(process("listen", address, "x", *channels)))
        for _ in range(3)
    ]


async def check(listeners: list[Process], restart: bool) -> None:
    """Everything came, in order; a restart in the middle may have cost each channel one gap."""
    for listener in listeners:
        heard = await asyncio.to_thread(listener.heard)
        assert heard.wrong == 0
        assert heard.first == [0, 0, 0]
        assert heard.gaps <= restart * 3
        assert heard.entries == 900 or (restart and heard.entries > 500)


@pytest.mark.parametrize("restart", [False, True])
async def test_several_processes_through_a_hub(tmp_path: Path, restart: bool) -> None:
    channels = ["a", "b", "c"]
    path = str(tmp_path / "bus")
    with ExitStack() as stack:
        hub = stack.enter_context(process("hub", path))
        bus = HubBus(path)
        await until(lambda: bus.connected)
        listeners = await listening(stack, f"hub:{path}", channels)
        await talk(bus, channels, 0, 100)
        if restart:
            await asyncio.to_thread(hub.kill)
            await until(lambda: not bus.connected)
            again = Hub(path)
            await again.start()
            await until(lambda: bus.connected)
        await talk(bus, channels, 100, 300)
        finish(bus, channels)
        await check(listeners, restart)
        await bus.aclose()
        if restart:
            await again.aclose()
