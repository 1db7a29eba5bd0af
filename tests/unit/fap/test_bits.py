"""Bits, and the start codes of ISO/IEC 14496-2 with their stuffing."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.errors import BitstreamError
from fapstream.fap.bits import BitReader, BitWriter


def written(bits: str) -> BitWriter:
    writer = BitWriter()
    for bit in bits.replace(" ", ""):
        writer.write(int(bit), 1)
    return writer


def read(bits: str) -> BitReader:
    return BitReader(written(bits).to_bytes(), "s.fba")


@settings(deadline=None)
@given(st.lists(st.integers(0, 32).flatmap(lambda w: st.tuples(st.integers(0, 2**w - 1), st.just(w)))))
def test_round_trip(fields: list[tuple[int, int]]) -> None:
    writer = BitWriter()
    for value, width in fields:
        writer.write(value, width)
    assert len(writer) == sum(width for _, width in fields)
    reader = BitReader(writer.to_bytes(), "x")
    assert [reader.read(width) for _, width in fields] == [value for value, _ in fields]
    assert reader.size - reader.position < 8


def test_the_most_significant_bit_comes_first() -> None:
    writer = BitWriter()
    writer.write(0b1011, 4)
    writer.write(1, 3)
    assert str(writer) == "1011001"
    assert writer.to_bytes() == bytes([0b10110010])


@pytest.mark.parametrize(("value", "width"), [(4, 2), (-1, 3), (1, 0)])
def test_what_does_not_fit(value: int, width: int) -> None:
    with pytest.raises(ValueError, match="no unsigned integer"):
        BitWriter().write(value, width)


def test_the_end_says_where() -> None:
    reader = BitReader(b"\xff\x00", "s.fba")
    assert reader.read(13) == 0b1111111100000
    with pytest.raises(
        BitstreamError, match=r"^s\.fba, byte 2 bit 0: ends where 4 more bits are due$"
    ) as caught:
        reader.read(4)
    assert caught.value.bit == 16
    assert reader.position == 13
    assert [reader.peek(k) for k in (0, 7, 8, 16, 1000)] == [1, 1, 0, 0, 0]


def test_markers() -> None:
    reader = read("10")
    reader.marker()
    with pytest.raises(BitstreamError, match="byte 0 bit 1: a marker bit is 0"):
        reader.marker()


@pytest.mark.parametrize(
    ("before", "stuffing"), [("1", "0111111"), ("1111111", "0"), ("11111111", "01111111"), ("", "")]
)
def test_start_codes_are_stuffed(before: str, stuffing: str) -> None:
    writer = written(before)
    writer.start_code(0x1BB)
    assert str(writer) == before + stuffing + "00000000 00000000 00000001 10111011".replace(" ", "")
    reader = BitReader(writer.to_bytes(), "x")
    reader.read(len(before))
    assert reader.start_code() == 0x1BB
    assert reader.position == len(before), "looking does not move"
    reader.skip_start_code()
    assert reader.position == reader.size == len(writer)


CODE = "00000000 00000000 00000001 10110001"


@pytest.mark.parametrize(
    ("bits", "skip", "found"),
    [
        (CODE, 0, 0x1B1),
        ("1 0111111" + CODE, 1, 0x1B1),
        ("1 0111110" + CODE, 1, None),
        ("1 1111111" + CODE, 1, None),
        ("11111111" + CODE, 0, None),
        ("00000000 00000000 00000001", 0, None),
        ("", 0, None),
    ],
)
def test_start_codes_are_seen_behind_right_stuffing_only(bits: str, skip: int, found: int | None) -> None:
    reader = read(bits)
    reader.read(skip)
    assert reader.start_code() == found


@pytest.mark.parametrize(
    ("bits", "skip", "left"),
    [("", 0, True), ("10111111", 1, True), ("10111110", 1, False), ("11111111", 0, False),
     ("01111111", 0, True), ("01111111 1", 0, False), ("1 0111111 11111111", 1, False)],
)  # fmt: skip
def test_stuffing_at_the_end(bits: str, skip: int, left: bool) -> None:
    reader = read(bits)
    reader.read(skip)
    assert reader.only_stuffing_left() == left


@pytest.mark.parametrize(
    ("bits", "since", "emulated"),
    [
        ("0" * 23, 0, True),
        ("0" * 22 + "1", 0, False),
        ("1" + "0" * 29 + "1", 0, False),
        ("1" + "0" * 30 + "1", 0, True),
        ("1" * 8 + "0" * 23, 30, True),
        ("1" * 8 + "0" * 23 + "1" * 20, 48, False),
    ],
)
def test_false_start_codes(bits: str, since: int, emulated: bool) -> None:
    assert written(bits).emulates_start_code(since) == emulated


def test_truncate_and_extend() -> None:
    writer = written("1010")
    writer.truncate(2)
    writer.extend(written("0111"))
    assert str(writer) == "100111"
