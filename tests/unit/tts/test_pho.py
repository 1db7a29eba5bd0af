"""MBROLA's notation."""

from __future__ import annotations

import math
import struct
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.errors import DataError
from fapstream.records import Phone, Utterance
from fapstream.tts import pho
from fapstream.tts.realise import VoicePhone
from fapstream.tts.tables import phone_set
from fapstream.tts.voices import voice


def utterance(*phones: Phone, closed: bool = False) -> Utterance:
    return Utterance("", phones, (), closed)


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
    first = writer.write(utterance(Phone("a", 100.0), Phone("s", 80.0)))
    second = writer.write(utterance(Phone("D", 80.0), Phone("a", 100.0), Phone("_", 50.0), closed=True))
    names = [line.name for line in pho.parse(first.lines + second.lines)]
    assert (first.ends, [p.name for p, _ in first.phones]) == ([1600], ["a"])
    assert first.following == Phone("s", 80.0)
    assert [p.name for p, _ in second.phones] == ["s", "D", "a", "_"]
    assert second.ends[-1] == 1280 + 1280 + 1600 + 800
    assert second.following is None
    assert all(v.joins(a, b) for a, b in pairwise(names))
    assert writer.write(utterance(closed=True)) == pho.Written("", (), [], None)


PHONES = st.lists(
    st.tuples(st.sampled_from(["k", "s", "a", "r", "t", "i"]), st.floats(20, 300)), min_size=1, max_size=20
)


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(["gr1", "gr2", "us1", "en1"]), PHONES, st.lists(st.integers(0, 20), max_size=5))
def test_where_a_stream_is_cut_cannot_be_heard(
    name: str, chosen: list[tuple[str, float]], cuts: list[int]
) -> None:
    """The same voice phones and samples, whether a phrase comes whole or in open pieces."""
    phones = [Phone(n, ms, ((0.0, 100.0),)) for n, ms in chosen if n in phone_set(voice(name).lang)]
    phones.append(Phone("_", 100.0))
    edges = [0, *sorted(c for c in cuts if c < len(phones)), len(phones)]

    def lines(pieces: list[list[Phone]]) -> list[tuple[str, float]]:
        writer = pho.Realiser(voice(name))
        written = [writer.write(utterance(*p, closed=p is pieces[-1])) for p in pieces]
        assert [p for w in written for p, _ in w.phones] == phones
        ends = [e for w in written for e in w.ends]
        assert all(w.ends == sorted(w.ends) for w in written)
        assert ends
        return [(line.name, line.duration_ms) for w in written for line in pho.parse(w.lines)]

    pieces = [phones[a:b] for a, b in pairwise(edges) if a < b]
    assert lines(pieces) == lines([phones])


def test_a_phone_that_is_drawn_out_is_one_with_the_one_before() -> None:
    writer = pho.Realiser(voice("us1"))
    first = writer.write(utterance(Phone("m", 80.0), Phone("A", 120.0)))
    held = writer.write(utterance(Phone("A", 140.0, hold=True), Phone("_", 100.0, hold=True), closed=True))
    drawn, pause = pho.parse(held.lines)
    assert [p.name for p, _ in first.phones] == ["m"]
    assert (drawn.name, round(drawn.duration_ms), pause.name) == ("A", 260, "_")
    assert held.ends == [1920, 1920 + 2240, 1920 + 2240 + 1600]
