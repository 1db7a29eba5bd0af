"""Phones and the events of a voice that inserts, merges and renames."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.adapters.alignment import align, refine

NAME = st.sampled_from(["a", "'e", ",i", "@", "t", "t#", "s", "S", "n", "r", "oU", "%u", ""])
NAMES = st.lists(NAME, max_size=12)


@st.composite
def events(draw: st.DrawFn) -> tuple[list[tuple[str, int]], int]:
    """(events in order, where the sound ends)."""
    names = draw(NAMES)
    times = sorted(draw(st.lists(st.integers(0, 9000), min_size=len(names), max_size=len(names))))
    return list(zip(names, times, strict=True)), draw(st.integers(9000, 10000))


@given(NAMES, events())
def test_one_start_a_phone_ascending_from_zero(
    names: list[str], heard: tuple[list[tuple[str, int]], int]
) -> None:
    starts = align(names, *heard)
    assert len(starts) == len(names)
    assert starts[:1] == [0] * len(starts[:1])
    assert starts == sorted(starts)
    assert all(0 <= s <= heard[1] for s in starts)


@given(st.lists(st.sampled_from("aeptsnl"), min_size=1, max_size=12))
def test_the_same_names_keep_their_times(names: list[str]) -> None:
    times = [0 if not i else 100 * i + 7 for i in range(len(names))]
    assert align(names, list(zip(names, times, strict=True)), 5000) == times


@pytest.mark.parametrize(
    ("names", "heard", "starts"),
    [
        # an inserted event moves nothing
        (["h", "'e", "l"], [("h", 0), ("'e", 50), ("?", 90), ("l", 120)], [0, 50, 120]),
        # a merged phone shares the time of those around it
        (["a", "n", "t", "a"], [("a", 0), ("n", 100), ("a", 300)], [0, 100, 200, 300]),
        (["a", "t", "t"], [("a", 0), ("t", 100)], None),
        # allophones and stress marks are the same phone
        (["'a", "t", ",i"], [("a", 0), ("t#", 90), ("i", 150)], [0, 90, 150]),
        # a reduced vowel stays a vowel
        (["p", "o", "t"], [("p", 0), ("@", 60), ("t", 130)], [0, 60, 130]),
        # nothing at all was heard
        (["a", "b"], [], [0, 200]),
        ([], [("a", 0)], []),
    ],
)
def test_examples(names: list[str], heard: list[tuple[str, int]], starts: list[int] | None) -> None:
    found = align(names, heard, 400)
    if starts is None:
        assert found[:1] == [0]
        assert 0 < found[1] <= found[2] < 400
    else:
        assert found == starts


KINDS = ["vowel", "stop", "affricate", "fricative", "nasal", "liquid"]


@given(
    st.lists(st.tuples(st.integers(0, 3000), st.sampled_from(KINDS), st.booleans()), min_size=1, max_size=12),
    st.integers(0, 2**32 - 1),
    st.integers(0, 800),
)
def test_refined_marks_stay_in_order_and_within_the_sound(
    phones: list[tuple[int, str, bool]], seed: int, tail: int
) -> None:
    starts = [0, *sorted(at for at, _, _ in phones[1:])]
    rng = np.random.default_rng(seed)
    n = starts[-1] + tail
    pcm = (rng.normal(0, 4000, n) * (rng.random(n // 200 + 1) < 0.6).repeat(200)[:n]).astype(np.int16)
    out = refine(starts, [(kind, voiced) for _, kind, voiced in phones], pcm, 22050)
    assert out[0] == 0
    assert len(out) == len(starts)
    assert out == sorted(out)
    assert out[-1] <= max(n, starts[-1])


def test_a_stop_begins_where_it_falls_silent_and_a_vowel_where_the_voice_comes_in() -> None:
    """200 ms of a tone, 60 ms of silence, 20 ms of noise, 200 ms of a tone."""
    rate = 22050
    tone = (8000 * np.sin(2 * np.pi * 120 * np.arange(rate) / rate)).astype(np.int16)
    rng = np.random.default_rng(0)
    vowel, gap, burst = (
        tone[: rate // 5],
        np.zeros(rate * 6 // 100, np.int16),
        rng.integers(-900, 900, rate // 50),
    )
    pcm = np.concatenate([vowel, gap, burst.astype(np.int16), vowel])
    closed, opened = len(vowel), len(vowel) + len(gap)
    voice_on = opened + len(burst)
    late = voice_on + rate * 3 // 100
    marks = [0, opened, late]
    refined = refine(marks, [("vowel", True), ("stop", False), ("vowel", True)], pcm, rate)
    step = rate * 5 // 1000
    assert refined[1] == pytest.approx(closed, abs=2 * step)
    assert refined[2] == pytest.approx(voice_on, abs=2 * step)
    voiced = refine(marks, [("vowel", True), ("stop", True), ("vowel", True)], pcm, rate)
    assert voiced[2] == late, "only after a voiceless stop does the voice tell"
