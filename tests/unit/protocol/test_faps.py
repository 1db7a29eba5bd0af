"""protocol/SPEC.md 3.2: frames as masks and changed values, against protocol/vectors/faps.json."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.errors import RemoteProtocolError
from fapstream.protocol.faps import Changes, FapDecoder, FapEncoder

CASES = json.loads((Path(__file__).parents[3] / "protocol" / "vectors" / "faps.json").read_text())


def changes_of(step: dict[str, Any]) -> Changes:
    return Changes(
        bytes.fromhex(step["mask"]) if "mask" in step else None,
        np.array(step["faps"], np.int16) if "faps" in step else None,
        np.array(step["wide"], np.int32) if "wide" in step else None,
        step.get("key"),
    )


@pytest.mark.parametrize("case", CASES, ids=lambda c: c["name"])
def test_vectors(case: dict[str, Any]) -> None:
    encoder, decoder = FapEncoder(case["channels"]), FapDecoder(case["channels"])
    for step in case["steps"]:
        if "refused" in step:
            with pytest.raises(RemoteProtocolError):
                decoder.decode(changes_of(step))
            continue
        rows = [np.array(row, np.int32) for row in step["rows"]]
        got = decoder.decode(changes_of(step))
        assert [list(r) for r in got] == step["rows"]
        if case.get("encode", True):
            made = encoder.encode(rows, key=bool(step.get("key")))
            wanted = changes_of(step)
            assert (made.mask, made.key) == (wanted.mask, wanted.key)
            for a, b in ((made.faps, wanted.faps), (made.wide, wanted.wide)):
                assert (a is None) == (b is None)
                assert a is None or b is None or list(a) == list(b)


VALUES = st.integers(-(2**31), 2**31 - 1) | st.integers(-40000, 40000) | st.just(0)


@given(
    st.integers(1, 68).flatmap(
        lambda n: st.lists(
            st.tuples(st.booleans(), st.lists(st.lists(VALUES, min_size=n, max_size=n), max_size=3)),
            max_size=6,
        ).map(lambda packets: (n, packets))
    )
)
def test_what_is_decoded_is_what_was_encoded(case: tuple[int, list[tuple[bool, list[list[int]]]]]) -> None:
    n, packets = case
    encoder, decoder = FapEncoder(n), FapDecoder(n)
    for key, rows in packets:
        changes = encoder.encode([np.array(row, np.int32) for row in rows], key)
        assert [list(row) for row in decoder.decode(changes)] == rows


@given(st.binary(max_size=30), st.lists(st.integers(-9, 9), max_size=12), st.integers(1, 68))
def test_no_mask_whatever_harms(mask: bytes, values: list[int], n: int) -> None:
    decoder = FapDecoder(n)
    before = decoder.decode(Changes(np.packbits(np.zeros(n, bool)).tobytes()))[0]
    try:
        rows = decoder.decode(Changes(mask, np.array(values, np.int16)))
    except RemoteProtocolError:
        assert (decoder.decode(Changes(bytes(-(-n // 8))))[0] == before).all(), "nothing was changed"
    else:
        assert len(rows) == len(mask) // -(-n // 8)


def test_after_a_lost_packet_a_key_makes_everything_good() -> None:
    encoder, decoder = FapEncoder(3), FapDecoder(3)
    rows = [np.array(r, np.int32) for r in ([1, 2, 3], [1, 9, 3], [4, 9, 3])]
    decoder.decode(encoder.encode([rows[0]], key=True))
    encoder.encode([rows[1]], key=False)
    assert list(decoder.decode(encoder.encode([rows[2]], key=False))[0]) == [4, 2, 3]
    assert list(decoder.decode(encoder.encode([rows[2]], key=True))[0]) == [4, 9, 3]
