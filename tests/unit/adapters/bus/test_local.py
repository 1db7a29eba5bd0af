"""The bus within one process, in any order of what can be done to it."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass, field

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.adapters.bus.channels import BACKLOG_ENTRIES
from fapstream.adapters.bus.inbox import INBOX, Inbox
from fapstream.adapters.bus.local import LocalBus
from fapstream.errors import InputError

NAMES = ("a", "b")
STEPS = st.lists(
    st.one_of(
        st.tuples(st.just("publish"), st.sampled_from(NAMES), st.integers(1, 150)),
        st.tuples(st.just("subscribe"), st.sampled_from(NAMES), st.just(0)),
        st.tuples(st.just("read"), st.integers(0, 5), st.integers(1, 200)),
        st.tuples(st.just("close"), st.integers(0, 5), st.just(0)),
        st.tuples(st.just("end"), st.just(0), st.just(0)),
    ),
    max_size=30,
)


@dataclass
class Listener:
    """A subscription with what was read of it and what had been published before."""

    name: str
    inbox: Inbox
    before: int
    closed: bool = False
    got: list[bytes | None] = field(default_factory=list)


class Play:
    """Does one step after the other; entries are their numbers."""

    def __init__(self) -> None:
        self.bus = LocalBus()
        self.count = dict.fromkeys(NAMES, 0)
        self.listeners: list[Listener] = []
        self.ended = False

    async def step(self, verb: str, what: str | int, amount: int) -> None:
        if isinstance(what, str):
            if verb == "publish":
                for _ in range(amount):
                    self.bus.publish(what, b"%d" % self.count[what])
                    self.count[what] += not self.ended
            else:
                self.listeners.append(Listener(what, self.bus.subscribe(what), self.count[what]))
        elif verb == "end":
            self.ended = True
            await self.bus.aclose()
        elif what < len(self.listeners):
            listener = self.listeners[what]
            if verb == "close":
                listener.closed = True
                await listener.inbox.aclose()
            else:
                await self.read(listener, amount)

    async def read(self, listener: Listener, amount: int) -> None:
        """What is there, and no more."""
        for _ in range(amount):
            reading = asyncio.ensure_future(anext(listener.inbox))
            await asyncio.sleep(0)
            if not reading.done():
                reading.cancel()
                await asyncio.wait({reading})
                return
            if isinstance(reading.exception(), StopAsyncIteration):
                return
            listener.got.append(reading.result())


def check_runs(listener: Listener, published: int) -> None:
    """Every entry is one more than the last, but after a gap, where it is later."""
    gap = False
    last = -1
    for entry in listener.got:
        if entry is None:
            assert not gap, "two gaps in a row"
            gap = True
            continue
        number = int(entry)
        assert number > last
        assert gap or last < 0 or number == last + 1
        if last < 0 and not gap:
            assert number == max(0, listener.before - BACKLOG_ENTRIES)
        last, gap = number, False
    assert not gap
    if not listener.closed and listener.got:
        assert last == published - 1, "the newest are never dropped"


@settings(deadline=None, max_examples=150)
@given(STEPS)
def test_each_subscriber_gets_contiguous_runs_up_to_reported_gaps(
    steps: list[tuple[str, str | int, int]],
) -> None:
    async def run() -> None:
        play = Play()
        for step in steps:
            await play.step(*step)
        for listener in play.listeners:
            if not listener.closed:
                await play.read(listener, 10_000)
            check_runs(listener, play.count[listener.name])

    asyncio.run(run())


async def test_a_late_subscriber_gets_the_backlog_and_then_the_live_entries() -> None:
    bus = LocalBus()
    for number in range(BACKLOG_ENTRIES + 20):
        bus.publish("a", b"%d" % number)
    subscription = bus.subscribe("a")
    bus.publish("a", b"live")
    got = [await anext(subscription) for _ in range(BACKLOG_ENTRIES + 1)]
    assert got == [b"%d" % n for n in range(20, BACKLOG_ENTRIES + 20)] + [b"live"]


async def test_a_slow_subscriber_is_told_once_and_holds_up_nobody() -> None:
    bus = LocalBus()
    slow, quick = bus.subscribe("a"), bus.subscribe("a")
    for number in range(INBOX.entries + 1):
        bus.publish("a", b"%d" % number)
        assert await anext(quick) == b"%d" % number
    await bus.aclose()
    got = [entry async for entry in slow]
    assert got.count(None) == 1
    assert got[0] is None
    assert got[-1] == b"%d" % INBOX.entries


async def test_it_is_told_when_the_last_one_leaves() -> None:
    deserted: list[str] = []
    bus = LocalBus(deserted=deserted.append)
    one, two = bus.subscribe("a"), bus.subscribe("a")
    await one.aclose()
    assert deserted == []
    await two.aclose()
    assert deserted == ["a"]


async def test_what_cannot_be_published_or_subscribed_to() -> None:
    bus = LocalBus()
    with pytest.raises(InputError):
        bus.publish("", b"1")
    with pytest.raises(InputError):
        bus.subscribe("")


async def test_after_its_end_nothing_happens() -> None:
    bus = LocalBus()
    assert bus.connected
    bus.publish("a", b"1")
    before = bus.subscribe("a")
    await bus.aclose()
    bus.publish("a", b"2")
    assert [entry async for entry in before] == [b"1"]
    assert [entry async for entry in bus.subscribe("a")] == []
