"""The file of a speaker: what goes in comes out, and what is no such file is refused."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest

from fapstream.data import read_bytes
from fapstream.errors import DataError
from fapstream.motion.speaker import FILE, pack, speaker, unpack


def test_the_packaged_file_is_what_packing_it_gives() -> None:
    data = read_bytes("motion", FILE)
    assert pack(unpack(data, FILE)) == data
    assert len(data) < 1_000_000
    assert "GRID" in speaker().made


@pytest.mark.parametrize("data", [b"", b"PK", b"nonsense" * 50, read_bytes("motion", FILE)[:20000]])
def test_what_is_no_such_file_is_named(data: bytes) -> None:
    with pytest.raises(DataError, match=r"him\.npz"):
        unpack(data, "him.npz")


def changed(**arrays: Any) -> bytes:
    with np.load(io.BytesIO(read_bytes("motion", FILE))) as file:
        found = {name: file[name] for name in file.files}
    found |= arrays
    out = io.BytesIO()
    np.savez(out, **{name: value for name, value in found.items() if value is not None})
    return out.getvalue()


@pytest.mark.parametrize(
    ("arrays", "why"),
    [
        ({"version": 99}, "version 99"),
        ({"asked": np.array(["vowel"])}, "other features"),
        ({"state_mean": None}, "state_mean"),
        ({"made": np.array([object()], dtype=object)}, "no articulation"),
    ],
)
def test_a_file_that_does_not_fit_says_why(arrays: dict[str, Any], why: str) -> None:
    with pytest.raises(DataError, match=why):
        unpack(changed(**arrays), "him.npz")


def test_both_models_speak() -> None:
    assert speaker().mouth("hmm").look_ahead == 2
    assert speaker().mouth("ohman").look_ahead == 4
