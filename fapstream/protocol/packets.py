"""Packets to bytes without the checks of the codec: there are 25 a second of each talk."""

from __future__ import annotations

from typing import Any

import msgpack

from fapstream.errors import LocalProtocolError
from fapstream.protocol.faps import Changes
from fapstream.protocol.generated import MESSAGES, STRUCTS
from fapstream.records import Mark, Packet

MOST_MARKS = next(f.max for f in MESSAGES["packet"][2] if f.name == "marks") or 0
LONGEST_TEXT = next(f.max for f in STRUCTS["mark"][1] if f.name == "text") or 0


def pack_packet(packet: Packet, changes: Changes) -> bytes:
    """The very bytes that `encode` gives for the message. Raises LocalProtocolError."""
    fields: dict[str, Any] = {
        "type": "packet",
        "turn": packet.turn,
        "sample": packet.start,
        "pcm": packet.pcm.astype("<i2", copy=False).tobytes(),
    }
    if changes.key:
        fields["key"] = True
    if changes.mask is not None:
        fields["mask"] = changes.mask
    if changes.faps is not None:
        fields["faps"] = changes.faps.astype("<i2", copy=False).tobytes()
    if changes.wide is not None:
        fields["wide"] = changes.wide.astype("<i4", copy=False).tobytes()
    if packet.marks:
        if len(packet.marks) > MOST_MARKS:
            raise LocalProtocolError(f"{len(packet.marks)} marks in a packet, more than {MOST_MARKS}")
        fields["marks"] = [_mark(mark) for mark in packet.marks]
    if packet.hold:
        fields["hold"] = True
    data: bytes = msgpack.packb(fields)
    return data


def _mark(mark: Mark) -> dict[str, Any]:
    if len(mark.text) > LONGEST_TEXT:
        raise LocalProtocolError(f"a mark of {len(mark.text)} characters, more than {LONGEST_TEXT}")
    fields: dict[str, Any] = {
        "kind": mark.kind,
        "sample": mark.sample,
        "duration": mark.duration,
        "text": mark.text,
    }
    if mark.char_start >= 0:
        fields["char_start"] = mark.char_start
    if mark.char_end >= 0:
        fields["char_end"] = mark.char_end
    return fields
