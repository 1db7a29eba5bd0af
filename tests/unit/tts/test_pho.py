"""MBROLA's notation."""

from __future__ import annotations

import math
import struct
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.errors import DataError
from fapstream.records import Phone
from fapstream.tts import pho
from fapstream.tts.realise import VoicePhone
from fapstream.tts.voices import voice


def float32(value: float) -> float:
    return float(struct.unpack("f", struct.pack("f", value))[0])


@given(st.integers(1, 14 * 22050), st.sampled_from([16000, 22050]))
def test_mbrola_makes_exactly_the_samples_asked_for(n: int, rate: int) -> None:
    """n = trunc(float32(duration) * rate / 1000)."""
    (read,) = pho.parse(pho.line(VoicePhone("a", n, ((0.0, 120.0),), ()), rate))
    assert math.trunc(float32(read.duration_ms) * rate / 1000.0) == n


@given(st.lists(st.tuples(st.floats(), st.floats()), min_size=1, max_size=5))
def test_pitch_is_always_in_range(pitch: list[tuple[float, float]]) -> None:
    (read,) = pho.parse(pho.line(VoicePhone("@U", 1600, tuple(pitch), ()), 16000))
    assert len(read.pitch) == len(pitch)
    assert all(0 <= percent <= 100 and 40 <= f0 <= 500 for percent, f0 in read.pitch)


def test_a_line() -> None:
    line = pho.line(VoicePhone("{", 1280, ((0.0, 120.0), (50.0, 131.25)), ()), 16000)
    assert line == "{ 80.03125 0.0 120.0 50.0 131.2\n"


@pytest.mark.parametrize("name", ["", "#", "#a", "a b", "a;b", "x" * 9, "é", "a\n"])
def test_bad_names(name: str) -> None:
    with pytest.raises(ValueError, match="not a phone name"):
        pho.line(VoicePhone(name, 100, ((0.0, 100.0),), ()), 16000)


def test_lines_without_samples_or_pitch() -> None:
    for bad in (VoicePhone("a", 0, ((0.0, 100.0),), ()), VoicePhone("a", 10, (), ())):
        with pytest.raises(ValueError, match="samples"):
            pho.line(bad, 16000)


def test_parse() -> None:
    assert pho.parse("; hello\n_ 100\na 80.5 0 120 50 130 ; x\n#\n") == [
        pho.PhoLine("_", 100.0),
        pho.PhoLine("a", 80.5, ((0.0, 120.0), (50.0, 130.0))),
    ]
    with pytest.raises(DataError) as caught:
        pho.parse("a 80\nb x\n")
    assert caught.value.line == 2


def test_the_realiser_remembers_the_last_phone() -> None:
    v = voice("gr1")
    writer = pho.Realiser(v)
    first, ends = writer.lines([Phone("a", 100.0), Phone("s", 80.0)])
    second, _ = writer.lines([Phone("D", 80.0), Phone("a", 100.0)])
    names = [line.name for line in pho.parse(first + second)]
    assert ends == [1600, 2880]
    assert all(v.joins(a, b) for a, b in pairwise(names))
    assert writer.lines([]) == ("", [])
