"""Text and streams are told apart."""

from __future__ import annotations

from pathlib import Path

import pytest

from fapstream.errors import BitstreamError, DataError
from fapstream.fap.animation import read_animation
from tests.unit.fap import hand

STREAM = hand.stream(hand.ONE_FAP_I, hand.ONE_FAP_P)
TEXT = Path(__file__).with_name("files").joinpath("plain.fap").read_bytes()


@pytest.mark.parametrize("where", ["a/talk.fba", "talk.FBA", "talk", "-"])
def test_a_stream(where: str) -> None:
    found = read_animation(STREAM, where)
    assert hand.same(found.frames, hand.ONE_FAP[:2])
    assert found.name == ("talk" if "talk" in where else "-")


@pytest.mark.parametrize("where", ["talk.fap", "-"])
def test_a_text(where: str) -> None:
    assert read_animation(TEXT, where).name == "three"
    assert read_animation(TEXT.partition(b"\n")[2], where, fps=10).fps == 10


def test_what_is_neither() -> None:
    with pytest.raises(BitstreamError, match=r"a\.fba, byte 0 bit 0: no FBA object"):
        read_animation(TEXT, "a.fba")
    with pytest.raises(DataError, match=r"a\.fap:1: "):
        read_animation(b"\xff\xfe\0x", "a.fap")
