"""Packets are packed as the codec packs them, only faster."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.errors import LocalProtocolError
from fapstream.protocol import generated as g
from fapstream.protocol.codec import encode
from fapstream.protocol.faps import Changes
from fapstream.protocol.packets import LONGEST_TEXT, MOST_MARKS, pack_packet
from fapstream.records import Mark, Packet

MARKS = st.builds(
    Mark,
    st.sampled_from(["phone", "word", "caption", "expression", "mark", "warning"]),
    st.integers(0, 2**40),
    st.integers(0, 2**20),
    st.text(max_size=9),
    st.integers(-1, 9),
    st.integers(-1, 9),
)
I16 = st.lists(st.integers(-(2**15), 2**15 - 1), max_size=9).map(lambda v: np.array(v, np.int16))
I32 = st.lists(st.integers(-(2**31), 2**31 - 1), max_size=9).map(lambda v: np.array(v, np.int32))
CHANGES = st.builds(
    Changes,
    st.none() | st.binary(max_size=18),
    st.none() | I16,
    st.none() | I32,
    st.sampled_from([None, True]),
)
PACKETS = st.builds(
    Packet,
    st.integers(1, 2**31 - 1),
    st.integers(0, 2**53 - 1),
    I16,
    st.just(()),
    st.lists(MARKS, max_size=4).map(tuple),
    st.booleans(),
)


def as_message(packet: Packet, changes: Changes) -> g.Packet:
    marks = tuple(
        g.Mark(
            kind=m.kind, sample=m.sample, duration=m.duration, text=m.text,
            char_start=None if m.char_start < 0 else m.char_start,
            char_end=None if m.char_end < 0 else m.char_end,
        )
        for m in packet.marks
    )  # fmt: skip
    return g.Packet(
        turn=packet.turn, sample=packet.start, pcm=packet.pcm, key=changes.key, mask=changes.mask,
        faps=changes.faps, wide=changes.wide, marks=marks or None, hold=packet.hold or None,
    )  # fmt: skip


@given(PACKETS, CHANGES)
def test_the_same_bytes_as_the_codec(packet: Packet, changes: Changes) -> None:
    assert pack_packet(packet, changes) == encode(as_message(packet, changes))


@pytest.mark.parametrize(
    "marks",
    [(Mark("word", 0, 0, "x" * (LONGEST_TEXT + 1)),), (Mark("word", 0, 0, "x"),) * (MOST_MARKS + 1)],
)
def test_what_no_client_would_take_is_refused(marks: tuple[Mark, ...]) -> None:
    with pytest.raises(LocalProtocolError):
        pack_packet(Packet(1, 0, np.zeros(0, np.int16), (), marks), Changes())
