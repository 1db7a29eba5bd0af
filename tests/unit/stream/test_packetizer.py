"""Packets of 40 ms on the sample clock, whatever the chunks in which sound comes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.records import FapFrame, Mark, Packet, TurnFormat
from fapstream.stream.packetizer import Packetizer

CHUNKS = st.lists(st.integers(0, 3000), max_size=25)


def turn(rate: int = 16000) -> TurnFormat:
    return TurnFormat(7, "v", "en", rate, 25)


def drain(packetizer: Packetizer, last: bool = False) -> list[Packet]:
    out = []
    while (end := packetizer.next_end(last)) is not None:
        out.append(packetizer.cut(end, ()))
    return out


def cut(chunks: list[int], marks: list[Mark], rate: int) -> list[Packet]:
    """The packets of a ramp that comes in such chunks, each with the marks that begin in it."""
    packetizer, out, at = Packetizer(turn(rate)), [], 0
    for n in chunks:
        mine = [m for m in marks if at <= m.sample < at + n]
        packetizer.add(at, np.arange(at, at + n).astype(np.int16), mine)
        at += n
        out += drain(packetizer)
    return out + drain(packetizer, last=True)


def shape(packets: list[Packet]) -> list[tuple[int, bytes, tuple[Mark, ...]]]:
    return [(p.start, p.pcm.tobytes(), p.marks) for p in packets]


@given(CHUNKS, st.lists(st.integers(0, 60000), max_size=10), st.sampled_from([16000, 22050]))
def test_chunking_does_not_matter(chunks: list[int], places: list[int], rate: int) -> None:
    total = sum(chunks)
    marks = [Mark("phone", s, 1, str(s)) for s in sorted(places) if s < total]
    packets = cut(chunks, marks, rate)
    assert shape(packets) == shape(cut([total], marks, rate))
    assert [m for p in packets for m in p.marks] == marks
    assert all(p.start <= m.sample < p.start + len(p.pcm) for p in packets for m in p.marks)


@given(CHUNKS, st.sampled_from([16000, 22050]))
def test_sizes(chunks: list[int], rate: int) -> None:
    total, size = sum(chunks), {16000: 640, 22050: 882}[rate]
    packets = cut(chunks, [], rate)
    assert [p.start for p in packets] == list(range(0, total, size))
    assert [len(p.pcm) for p in packets] == [min(size, total - s) for s in range(0, total, size)]
    assert np.array_equal(
        np.concatenate([p.pcm for p in packets] or [np.zeros(0, np.int16)]),
        np.arange(total).astype(np.int16),
    )


@pytest.mark.parametrize("start", [0, 99, 101])
def test_a_gap_or_an_overlap_raises_and_changes_nothing(start: int) -> None:
    packetizer = Packetizer(turn())
    packetizer.add(0, np.zeros(100, np.int16))
    with pytest.raises(ValueError, match="expected 100"):
        packetizer.add(start, np.zeros(10, np.int16), [Mark("phone", start, 1, "x")])
    packetizer.add(100, np.zeros(540, np.int16))
    [packet] = drain(packetizer)
    assert packet.marks == ()


def test_a_mark_may_come_before_its_sound() -> None:
    packetizer = Packetizer(turn())
    packetizer.add(0, np.zeros(0, np.int16), [Mark("word", 700, 10, "w")])
    packetizer.add(0, np.zeros(1280, np.int16))
    first, second = drain(packetizer)
    assert first.marks == ()
    assert [m.sample for m in second.marks] == [700]


def test_the_packet_carries_what_it_is_given() -> None:
    packetizer = Packetizer(turn())
    packetizer.add(0, np.arange(700, dtype=np.int16))
    frame = FapFrame(0, np.zeros(68, np.int32))
    packet = packetizer.cut(640, [frame], hold=True)
    assert (packet.turn, packet.start, packet.frames, packet.hold) == (7, 0, (frame,), True)
    assert packetizer.next_end() is None
    assert packetizer.next_end(last=True) == 700
    assert packetizer.cut_end == 640


def test_after_a_cut_sound_and_packets_begin_there() -> None:
    """Whether it lies in packets that were given, in sound that waits, or at its end."""
    for taken, at in ((3, 700), (1, 640), (1, 1999), (0, 0), (3, 2000), (2, 1281)):
        made = Packetizer(turn())
        made.add(
            0, np.arange(2000, dtype=np.int16), [Mark("phone", s, 9, str(s)) for s in range(0, 2000, 100)]
        )
        packets = [made.cut(made.next_end() or 0, ()) for _ in range(taken)]
        made.cut_back(at)
        assert made.pcm_end == at
        made.add(at, -np.ones(3000, np.int16), [Mark("phone", at, 9, "new")])
        more = drain(made, last=True)
        kept = [p for p in packets if p.start < at]
        heard = np.concatenate([p.pcm for p in kept])[:at] if kept else np.zeros(0, np.int16)
        heard = np.concatenate([heard, *(p.pcm for p in more)])
        assert np.array_equal(heard, np.concatenate([np.arange(at), -np.ones(3000)]))
        assert [p.start for p in more if p.start >= at] == list(range(at, at + 3000, 640))
        marks = [int(m.sample) for p in more for m in p.marks if m.text != "new"]
        assert marks == [s for s in range(0, at, 100) if s >= min(at, 640 * taken)]


def test_a_cut_beyond_the_sound_is_refused() -> None:
    made = Packetizer(turn())
    made.add(0, np.zeros(100, np.int16))
    with pytest.raises(ValueError, match="beyond the last sample 100"):
        made.cut_back(101)
