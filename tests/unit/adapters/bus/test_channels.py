"""Who joined what, and the backlog of those who come late."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.adapters.bus import channels as module
from fapstream.adapters.bus.channels import (
    BACKLOG_BYTES,
    BACKLOG_ENTRIES,
    FORGET_S,
    MAX_ENTRY,
    MAX_NAME,
    Backlog,
    Channels,
    check,
)
from fapstream.errors import InputError


class List:
    """A sink that is a list."""

    def __init__(self) -> None:
        self.got: list[bytes | None] = []

    def put(self, entry: bytes | None) -> None:
        self.got.append(entry)


def late(channels: Channels[List], name: str = "a") -> list[bytes | None]:
    """What one who comes now gets of the past."""
    sink = List()
    channels.join(name, sink)
    channels.leave(name, sink)
    return sink.got


@given(st.lists(st.one_of(st.none(), st.integers(0, BACKLOG_BYTES // 3)), max_size=120))
def test_a_backlog_is_the_newest_within_its_bounds(sizes: list[int | None]) -> None:
    entries = [None if size is None else bytes(size) for size in sizes]
    backlog = Backlog()
    for entry in entries:
        backlog.add(entry)
    kept = list(backlog)
    assert kept == entries[len(entries) - len(kept) :]
    assert len(kept) <= BACKLOG_ENTRIES
    assert sum(len(entry or b"") for entry in kept) <= BACKLOG_BYTES
    assert not kept or kept[0] is not None


def test_the_backlog_first_and_then_what_is_published() -> None:
    channels: Channels[List] = Channels()
    channels.publish("a", b"1")
    channels.publish("b", b"other")
    sink = List()
    channels.join("a", sink)
    channels.publish("a", b"2")
    channels.publish("a", None)
    assert sink.got == [b"1", b"2", None]


def test_who_left_gets_nothing_and_the_last_is_known() -> None:
    channels: Channels[List] = Channels()
    one, two = List(), List()
    channels.join("a", one)
    channels.join("a", two)
    assert sorted(map(id, channels.everyone())) == sorted(map(id, (one, two)))
    assert not channels.leave("a", one)
    assert not channels.leave("a", one)
    assert channels.leave("a", two)
    assert not channels.leave("a", two)
    channels.publish("a", b"1")
    assert one.got == two.got == []


def test_a_silent_channel_is_forgotten_but_not_its_listeners() -> None:
    now = 0.0
    channels: Channels[List] = Channels(lambda: now)
    sink = List()
    channels.publish("a", b"1")
    channels.join("a", sink)
    now = FORGET_S
    assert late(channels) == [b"1"]
    now = FORGET_S + 1
    assert late(channels) == []
    channels.publish("a", b"2")
    assert sink.got == [b"1", b"2"]


def test_a_channel_can_be_forgotten_on_purpose() -> None:
    channels: Channels[List] = Channels()
    channels.publish("a", b"1")
    channels.forget("a")
    channels.forget("never")
    assert late(channels) == []


def test_no_more_backlogs_than_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_BACKLOGS", 2)
    channels: Channels[List] = Channels()
    for name in ("a", "b", "a", "c"):
        channels.publish(name, name.encode())
    assert [late(channels, name) for name in "abc"] == [[b"a", b"a"], [], [b"c"]]


@pytest.mark.parametrize(
    "name", ["", "n" * (MAX_NAME + 1), "\N{GREEK SMALL LETTER ALPHA}" * MAX_NAME, "\ud800"]
)
def test_names_that_are_none(name: str) -> None:
    with pytest.raises(InputError, match="name"):
        check(name, b"")


def test_an_entry_that_is_too_large() -> None:
    check("a" * MAX_NAME, bytes(MAX_ENTRY))
    with pytest.raises(InputError, match=str(MAX_ENTRY + 1)):
        check("a", bytes(MAX_ENTRY + 1))
