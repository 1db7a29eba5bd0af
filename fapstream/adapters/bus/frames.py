"""What travels between the hub and the processes that it joins.

A frame: length of what follows (4 bytes), kind (1), length of the channel's name (2), the name in UTF-8, and
for an entry the numbered entry. Integers are big-endian.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum

from fapstream.adapters.bus.channels import MAX_NAME
from fapstream.adapters.bus.numbers import MAX_STAMPED
from fapstream.errors import RemoteProtocolError

LENGTH = struct.Struct("!I")
HEAD = struct.Struct("!IBH")
REST = HEAD.size - LENGTH.size
MAX_LENGTH = REST + MAX_NAME + MAX_STAMPED


class Kind(IntEnum):
    """What a frame says."""

    ENTRY = 1
    SUBSCRIBE = 2
    """The hub sends it back: what was sent before was not meant for this subscription."""
    UNSUBSCRIBE = 3


@dataclass(frozen=True, slots=True)
class Frame:
    """One frame; `raw` is all of it, as it travels."""

    kind: int
    channel: str
    body: bytes
    raw: bytes


def packed(kind: Kind, channel: str, body: bytes = b"") -> bytes:
    """A frame as it travels."""
    name = channel.encode()
    return b"".join((HEAD.pack(REST + len(name) + len(body), kind, len(name)), name, body))


class Parser:
    """Bytes in, frames out."""

    def __init__(self) -> None:
        self._buffer = bytearray()

    def feed(self, data: bytes) -> Iterator[Frame]:
        """The frames that are complete. Raises RemoteProtocolError; nothing can be read after that."""
        self._buffer += data
        at = 0
        try:
            while len(self._buffer) - at >= LENGTH.size:
                end = at + LENGTH.size + LENGTH.unpack_from(self._buffer, at)[0]
                if not HEAD.size <= end - at <= LENGTH.size + MAX_LENGTH:
                    raise RemoteProtocolError(f"a frame of {end - at} bytes on the bus")
                if len(self._buffer) < end:
                    break
                yield _frame(bytes(self._buffer[at:end]))
                at = end
        finally:
            del self._buffer[:at]


def _frame(raw: bytes) -> Frame:
    _, kind, size = HEAD.unpack_from(raw)
    body = HEAD.size + size
    try:
        channel = raw[HEAD.size : body].decode()
    except UnicodeDecodeError as error:
        raise RemoteProtocolError("a channel's name on the bus is not UTF-8") from error
    if body > len(raw) or not 0 < size <= MAX_NAME:
        raise RemoteProtocolError(f"a channel's name of {size} bytes on the bus")
    return Frame(kind, channel, raw[body:], raw)
