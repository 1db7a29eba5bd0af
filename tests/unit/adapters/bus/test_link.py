"""One end of a connection, with a transport that is as slow as it is told to be."""

from __future__ import annotations

import asyncio
import logging

import pytest

from fapstream.adapters.bus.frames import Frame, Kind, Parser, packed
from fapstream.adapters.bus.link import CHUNK_BYTES, STALL_S, Link
from fapstream.adapters.bus.waiting import Bounds, Waiting


class Transport(asyncio.Transport):
    """Keeps what is written to it."""

    def __init__(self) -> None:
        super().__init__()
        self.written: list[bytes] = []
        self.ends: list[str] = []

    def write(self, data: bytes | bytearray | memoryview) -> None:
        self.written.append(bytes(data))

    def set_write_buffer_limits(self, high: int | None = None, low: int | None = None) -> None:
        pass

    def close(self) -> None:
        self.ends.append("close")

    def abort(self) -> None:
        self.ends.append("abort")


BOUNDS = Bounds(100, 1 << 20, age_s=4.0)


class End:
    """A link, its transport, its time, and what came."""

    def __init__(self, bounds: Bounds = BOUNDS) -> None:
        self.now = 0.0
        self.frames: list[Frame] = []
        self.waiting: Waiting[bytes] = Waiting(bounds, lambda: self.now)
        self.link = Link(lambda _, frame: self.frames.append(frame), self.waiting, lambda: self.now)
        self.transport = Transport()

    def bodies(self) -> list[bytes]:
        """What was sent."""
        return [frame.body for frame in Parser().feed(b"".join(self.transport.written))]


def entry(body: bytes) -> bytes:
    return packed(Kind.ENTRY, "a", body)


async def test_what_waits_is_sent_together() -> None:
    end = End()
    end.link.connection_made(end.transport)
    for body in (b"1", b"2"):
        end.link.put(entry(body))
    assert end.transport.written == []
    await asyncio.sleep(0)
    assert len(end.transport.written) == 1
    assert end.bodies() == [b"1", b"2"]


async def test_what_waited_for_a_connection_is_sent_with_it() -> None:
    end = End()
    end.link.put(entry(b"1"))
    await asyncio.sleep(0)
    end.link.connection_made(end.transport)
    assert end.bodies() == [b"1"]


async def test_a_slow_reader_misses_the_oldest_and_never_blocks() -> None:
    end = End(Bounds(4, 1 << 20))
    end.link.connection_made(end.transport)
    end.link.pause_writing()
    for number in range(5):
        end.link.put(entry(b"%d" % number))
        await asyncio.sleep(0)
    assert end.transport.written == []
    end.link.resume_writing()
    assert end.bodies() == [b"3", b"4"]


async def test_who_reads_nothing_is_dropped() -> None:
    end = End()
    end.link.connection_made(end.transport)
    end.link.pause_writing()
    end.now = STALL_S
    end.link.put(entry(b"1"))
    assert end.transport.ends == []
    end.now = STALL_S + 1
    end.link.put(entry(b"2"))
    assert end.transport.ends == ["abort"]


async def test_no_more_is_handed_over_than_is_read() -> None:
    end = End()
    end.link.connection_made(end.transport)
    for _ in range(3):
        end.link.put(entry(bytes(CHUNK_BYTES)))
    write = end.transport.write

    def once(data: bytes | bytearray | memoryview) -> None:
        write(data)
        end.link.pause_writing()

    end.transport.write = once  # type: ignore[method-assign]
    await asyncio.sleep(0)
    assert len(end.bodies()) == 1
    assert len(end.waiting) == 2


async def test_what_must_not_be_dropped_overtakes() -> None:
    end = End()
    end.link.tell(b"to nobody")
    end.link.connection_made(end.transport)
    end.link.put(entry(b"1"))
    end.link.tell(packed(Kind.SUBSCRIBE, "b"))
    end.link.finish()
    assert end.bodies() == [b"", b"1"]
    assert end.transport.ends == ["close"]


async def test_frames_come_in_until_one_is_none(caplog: pytest.LogCaptureFixture) -> None:
    end = End()
    end.link.connection_made(end.transport)
    with caplog.at_level(logging.WARNING):
        end.link.data_received(entry(b"1") + bytes(8))
    assert [frame.body for frame in end.frames] == [b"1"]
    assert end.transport.ends == ["abort"]
    assert "dropped" in caplog.text


async def test_after_the_end_it_is_silent() -> None:
    end = End()
    end.link.connection_made(end.transport)
    error = ConnectionResetError()
    end.link.connection_lost(error)
    assert await end.link.lost is error
    end.link.put(entry(b"1"))
    await asyncio.sleep(0)
    end.link.abort()
    end.link.finish()
    assert end.transport.written == []
    assert end.transport.ends == []
