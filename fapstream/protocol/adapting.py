"""The messages of the adaptation session as bytes (protocol/ADAPT.md)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import msgpack

from fapstream.errors import RemoteProtocolError

PATH = "/adapt/ws"
SUBPROTOCOL = "fapstream.adapt.v1"
MAX_MESSAGE_BYTES = 33 << 20
MOST_FIELDS = 256
"""Of a map, and rows of an array: more than there are feature points."""


def encode(message: Mapping[str, Any]) -> bytes:
    """One WebSocket frame's worth of bytes; fields that are None are left out."""
    data: bytes = msgpack.packb({name: value for name, value in message.items() if value is not None})
    return data


def decode(data: bytes | str) -> dict[str, Any]:
    """The message in a frame: a map with a `type`. Raises RemoteProtocolError."""
    if isinstance(data, str):
        raise RemoteProtocolError("messages are binary")
    try:
        message = msgpack.unpackb(
            data, max_map_len=MOST_FIELDS, max_array_len=MOST_FIELDS, max_ext_len=0, max_str_len=1 << 18,
            max_bin_len=MAX_MESSAGE_BYTES,
        )  # fmt: skip
    except (ValueError, TypeError, msgpack.UnpackException, RecursionError) as e:
        raise RemoteProtocolError(f"not a MessagePack map: {type(e).__name__}") from e
    if not isinstance(message, dict) or not isinstance(message.get("type"), str):
        raise RemoteProtocolError("a message is a map with a `type`")
    return message
