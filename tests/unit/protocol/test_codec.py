"""protocol/SPEC.md section 2, against the golden frames of protocol/vectors."""

from __future__ import annotations

import dataclasses
import json
from contextlib import suppress
from pathlib import Path
from typing import Any

import msgpack
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.errors import LocalProtocolError, RemoteProtocolError
from fapstream.protocol import generated as g
from fapstream.protocol.codec import decode, encode

VECTORS = Path(__file__).parents[3] / "protocol" / "vectors"


def load(name: str) -> list[dict[str, Any]]:
    cases: list[dict[str, Any]] = json.loads((VECTORS / name).read_text(encoding="utf-8"))
    return cases


def ids(case: dict[str, Any]) -> str:
    return str(case["name"])


def to_record(value: Any, struct: str | None = None) -> Any:
    """A vector's JSON as the record it describes."""
    if isinstance(value, dict) and value.keys() == {"hex"}:
        return bytes.fromhex(value["hex"])
    for key, dtype in (("i16", np.int16), ("i32", np.int32)):
        if isinstance(value, dict) and value.keys() == {key}:
            return np.array(value[key], dtype)
    if isinstance(value, list):
        return tuple(to_record(item, struct) for item in value)
    if not isinstance(value, dict):
        return value
    fields = dict(value)
    if struct:
        return g.STRUCTS[struct][0](**fields)
    cls, _, specs = g.MESSAGES[fields.pop("type")]
    inner = {s.name: s.of for s in specs if s.type == "list" and s.of in g.STRUCTS}
    return cls(**{k: to_record(v, inner.get(k)) for k, v in fields.items()})


def same(a: Any, b: Any) -> bool:
    if type(a) is not type(b):
        return False
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and np.array_equal(a, b)
    if dataclasses.is_dataclass(a):
        return all(same(getattr(a, f.name), getattr(b, f.name)) for f in dataclasses.fields(a))
    return bool(a == b)


@pytest.mark.parametrize("case", load("messages.json"), ids=ids)
def test_golden_both_ways(case: dict[str, Any]) -> None:
    record, data = to_record(case["message"]), bytes.fromhex(case["hex"])
    assert encode(record).hex() == case["hex"]
    assert same(decode(data, case["from"]), record)


@pytest.mark.parametrize("case", load("invalid.json"), ids=ids)
def test_invalid_is_refused(case: dict[str, Any]) -> None:
    with pytest.raises(RemoteProtocolError) as caught:
        decode(bytes.fromhex(case["hex"]), case["from"])
    assert caught.value.code == case["code"]
    assert caught.value.fatal == g.ERRORS[case["code"]]


@pytest.mark.parametrize("case", load("lenient.json"), ids=ids)
def test_lenient_is_read(case: dict[str, Any]) -> None:
    message = decode(bytes.fromhex(case["hex"]), case["from"])
    assert same(message, to_record(case["message"]))


def test_every_message_has_a_golden_case() -> None:
    assert {c["message"]["type"] for c in load("messages.json")} == set(g.MESSAGES)


@given(st.binary(max_size=300))
def test_any_bytes_are_read_or_refused(data: bytes) -> None:
    with suppress(RemoteProtocolError):
        decode(data, "client")


JSONISH = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**63), 2**64 - 1) | st.floats()
    | st.text(max_size=5) | st.binary(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=5,
)  # fmt: skip


@given(st.sampled_from(sorted(g.MESSAGES)), st.data())
def test_any_fields_are_read_or_refused(name: str, data: st.DataObject) -> None:
    _, origin, specs = g.MESSAGES[name]
    fields = {s.name: data.draw(JSONISH) for s in specs}
    with suppress(RemoteProtocolError):
        decode(msgpack.packb({"type": name, **fields}), "server" if origin == "server" else "client")


def test_a_value_that_does_not_fit_is_not_sent() -> None:
    with pytest.raises(LocalProtocolError, match=r"end\.turn"):
        encode(g.End(turn=0))


def test_an_unpaired_surrogate_in_text_is_not_a_crash() -> None:
    assert isinstance(
        decode(msgpack.packb({"type": "speak", "turn": 1, "text": b"\xed\xa0\x80"}), "client"), g.Speak
    )
