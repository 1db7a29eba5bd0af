"""Frames between the hub and its processes."""

from __future__ import annotations

from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.adapters.bus.channels import MAX_NAME
from fapstream.adapters.bus.frames import HEAD, MAX_LENGTH, Kind, Parser, packed
from fapstream.adapters.bus.numbers import MAX_STAMPED
from fapstream.errors import RemoteProtocolError

NAMES = st.text(st.characters(exclude_categories=["Cs"]), min_size=1, max_size=MAX_NAME // 4)
FRAMES = st.lists(st.tuples(st.sampled_from(Kind), NAMES, st.binary(max_size=300)), max_size=8)


@given(FRAMES, st.lists(st.integers(1, 200), min_size=1))
def test_any_frames_in_any_pieces(frames: list[tuple[Kind, str, bytes]], pieces: list[int]) -> None:
    data = b"".join(packed(*frame) for frame in frames)
    parser = Parser()
    got = []
    while data:
        for piece in pieces:
            got += list(parser.feed(data[:piece]))
            data = data[piece:]
    assert [(f.kind, f.channel, f.body) for f in got] == frames
    assert [f.raw for f in got] == [packed(*frame) for frame in frames]


def test_the_largest_frame() -> None:
    [frame] = Parser().feed(packed(Kind.ENTRY, "n" * MAX_NAME, bytes(MAX_STAMPED)))
    assert len(frame.body) == MAX_STAMPED


@pytest.mark.parametrize(
    "wrong",
    [
        HEAD.pack(MAX_LENGTH + 1, 1, 1),
        HEAD.pack(2, 1, 1),
        HEAD.pack(4, 1, 2) + b"a",
        HEAD.pack(4, 1, 0) + b"a",
        HEAD.pack(3 + MAX_NAME + 1, 1, MAX_NAME + 1) + b"a" * (MAX_NAME + 1),
        HEAD.pack(4, 1, 1) + b"\xff",
    ],
    ids=["too long", "too short", "name beyond the frame", "no name", "long name", "no UTF-8"],
)
def test_what_is_no_frame(wrong: bytes) -> None:
    parser = Parser()
    before = packed(Kind.ENTRY, "a", b"1")
    frames = parser.feed(before + wrong)
    assert next(frames).body == b"1"
    with pytest.raises(RemoteProtocolError):
        next(frames)


@given(st.binary(max_size=64))
def test_noise_is_refused_or_waited_for(noise: bytes) -> None:
    with suppress(RemoteProtocolError):
        list(Parser().feed(noise))
