"""Messages of the adaptation session as bytes."""

from __future__ import annotations

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.errors import RemoteProtocolError
from fapstream.protocol.adapting import MOST_FIELDS, decode, encode


def test_messages_come_back_without_what_is_none() -> None:
    message = {"type": "fit", "seq": 3, "mesh": b"\x00\x01", "note": None, "front": {"9.3": [1.5, 2.0]}}
    assert decode(encode(message)) == {k: v for k, v in message.items() if v is not None}


@pytest.mark.parametrize(
    "data",
    ["text", b"", b"\xc1", msgpack.packb([1]), msgpack.packb({"x": 1}), msgpack.packb({"type": 5}),
     msgpack.packb({"type": "a", "b": {str(i): i for i in range(MOST_FIELDS + 1)}}),
     msgpack.packb({"type": "a", "b": msgpack.ExtType(1, b"x")}), msgpack.packb({1: 2, "type": "a"}),
     b"\x91" * 5000],
)  # fmt: skip
def test_what_is_no_message_is_refused(data: bytes | str) -> None:
    with pytest.raises(RemoteProtocolError):
        decode(data)


@given(st.binary(max_size=200))
def test_no_bytes_raise_anything_else(data: bytes) -> None:
    try:
        message = decode(data)
    except RemoteProtocolError:
        return
    assert isinstance(message["type"], str)
