"""Messages to bytes and back, as protocol/SPEC.md section 2 has it.

Driven by the generated field tables: a new message needs no code here.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import msgpack
import numpy as np

from fapstream.errors import LocalProtocolError, RemoteProtocolError
from fapstream.protocol.generated import MAX_MESSAGE_BYTES, MESSAGES, STRUCTS, FieldSpec, Message

Side = Literal["client", "server"]

MAX_INT = 2**53 - 1

ARRAYS: dict[str, np.dtype[Any]] = {"i16": np.dtype("<i2"), "i32": np.dtype("<i4")}
"""Field types that carry numbers as `bin`."""


def encode(message: Message) -> bytes:
    """One WebSocket frame's worth of bytes.

    Raises LocalProtocolError when a value does not fit its field.
    """
    _, _, specs = MESSAGES[message.type]
    fields = {"type": message.type, **_pack_fields(message, specs, message.type)}
    data: bytes = msgpack.packb(fields)
    if len(data) > MAX_MESSAGE_BYTES:
        raise LocalProtocolError(f"{message.type}: {len(data)} bytes, more than {MAX_MESSAGE_BYTES}")
    return data


def decode(data: bytes, sender: Side) -> Message | None:
    """The message in `data`, sent by `sender`; None for a message type this version does not know.

    Raises RemoteProtocolError: fatal `protocol` if the bytes are no message at all, else `bad_message`.
    """
    return read(unpack(data), sender)


def read(fields: Mapping[Any, Any], sender: Side) -> Message | None:
    """As `decode`, of a map that `unpack` gave."""
    name = fields.get("type")
    if not isinstance(name, str):
        raise RemoteProtocolError("a message needs a `type` of type str")
    if name not in MESSAGES:
        return None
    cls, origin, specs = MESSAGES[name]
    if origin not in (sender, "both"):
        raise RemoteProtocolError(f"`{name}` does not come from a {sender}")
    return cls(**_read_fields(fields, specs, name))


def unpack(data: bytes) -> Mapping[Any, Any]:
    """The map in a frame, nothing of it checked. Raises RemoteProtocolError."""
    if len(data) > MAX_MESSAGE_BYTES:
        raise RemoteProtocolError(f"message of {len(data)} bytes, more than {MAX_MESSAGE_BYTES}")
    try:
        fields = msgpack.unpackb(
            data, strict_map_key=False, max_map_len=64, max_array_len=4096, max_ext_len=0
        )
    except (ValueError, TypeError, msgpack.UnpackException, RecursionError) as e:
        raise RemoteProtocolError(f"not a MessagePack map: {type(e).__name__}") from e
    if not isinstance(fields, dict):
        raise RemoteProtocolError(f"not a MessagePack map but {type(fields).__name__}")
    return fields


def _pack_fields(record: object, specs: tuple[FieldSpec, ...], where: str) -> dict[str, Any]:
    fields = {}
    for spec in specs:
        value = getattr(record, spec.name)
        if value is None and spec.optional:
            continue
        plain = _plain(value, spec, where)
        problem = _problem(plain, spec)
        if problem:
            raise LocalProtocolError(f"{where}.{spec.name}: {problem}")
        fields[spec.name] = plain
    return fields


def _plain(value: Any, spec: FieldSpec, where: str) -> Any:
    """A value as MessagePack carries it."""
    if spec.type in ARRAYS:
        return np.ascontiguousarray(value, dtype=ARRAYS[spec.type]).tobytes()
    if spec.type == "list" and spec.of in STRUCTS:
        return [_pack_fields(item, STRUCTS[spec.of][1], f"{where}.{spec.name}[]") for item in value]
    return list(value) if spec.type == "list" else value


def _read_fields(fields: Mapping[Any, Any], specs: tuple[FieldSpec, ...], where: str) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for spec in specs:
        if spec.name not in fields:
            if not spec.optional:
                raise _bad(f"{where}.{spec.name} is missing")
            continue
        raw = fields[spec.name]
        problem = _problem(raw, spec)
        if problem:
            raise _bad(f"{where}.{spec.name}: {problem}")
        values[spec.name] = _rich(raw, spec, where)
    return values


def _rich(raw: Any, spec: FieldSpec, where: str) -> Any:
    """A checked MessagePack value as the records hold it."""
    if spec.type in ARRAYS:
        wire = ARRAYS[spec.type]
        return np.frombuffer(raw, dtype=wire).astype(wire.newbyteorder("="))
    if spec.type == "text" and isinstance(raw, str):
        return raw.encode("utf-8", "surrogatepass")
    if spec.type == "list" and spec.of in STRUCTS:
        cls, inner = STRUCTS[spec.of]
        return tuple(cls(**_read_fields(item, inner, f"{where}.{spec.name}[]")) for item in raw)
    return tuple(raw) if spec.type == "list" else raw


def _problem(raw: Any, spec: FieldSpec) -> str:
    """What is wrong with a MessagePack value for this field; empty if nothing."""
    if not _has_type(raw, spec):
        return f"expected {spec.type}, got {type(raw).__name__}"
    if spec.enum and raw not in spec.enum:
        return f"{raw!r:.40} is none of {', '.join(map(str, spec.enum))}"
    if spec.type == "int":
        low = -MAX_INT if spec.min is None else spec.min
        high = MAX_INT if spec.max is None else spec.max
        return "" if low <= raw <= high else f"{raw} is not within {low} to {high}"
    item_bytes = ARRAYS[spec.type].itemsize if spec.type in ARRAYS else 1
    if spec.type != "bool" and len(raw) % item_bytes:
        return f"{len(raw)} bytes are no array of {spec.type}"
    if spec.type == "bool":
        return ""
    size = len(raw) // item_bytes
    return "" if spec.max is None or size <= spec.max else f"length {size}, more than {spec.max}"


def _has_type(raw: Any, spec: FieldSpec) -> bool:
    match spec.type:
        case "int":
            return isinstance(raw, int) and not isinstance(raw, bool)
        case "str":
            return isinstance(raw, str)
        case "bool":
            return isinstance(raw, bool)
        case "text":
            return isinstance(raw, bytes | str)
        case "u8" | "i16" | "i32":
            return isinstance(raw, bytes)
    item_type: type = dict if spec.of in STRUCTS else str
    return isinstance(raw, list) and all(isinstance(item, item_type) for item in raw)


def _bad(message: str) -> RemoteProtocolError:
    return RemoteProtocolError(message, code="bad_message", fatal=False)
