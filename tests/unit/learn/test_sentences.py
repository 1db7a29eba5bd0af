"""From clips and phones that were heard to units with times."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.learn.clips import Clip, WordHeard
from fapstream.learn.landmarks import Landmarks
from fapstream.learn.measured import RATE, Measured
from fapstream.learn.sentences import MARGIN_S, Sentence, sentence, stresses_of, usable
from fapstream.motion.units import SIL, features
from tests.unit.learn.faces import FAPU
from tests.unit.learn.folders import SILENCE, Words, heard

SEVEN = ("seven", ("S", "EH", "V", "AH", "N"))
AGAIN = ("again", ("AH", "G", "EH", "N"))
BIN = ("bin", ("B", "IH", "N"))
NO_LANDMARKS = Landmarks(np.zeros((0, 0, 3)), ())


def made(
    words: Words, silences: bool, frames: int = 300, each_s: float = 0.1, start_s: float = 0.0
) -> Sentence:
    clip = Clip("a clip", NO_LANDMARKS, heard(words, each_s, start_s))
    return sentence(clip, np.arange(frames)[:, None] * np.ones(2), silences)


def stressed(*words: tuple[str, tuple[str, ...]]) -> dict[str, str]:
    """Each word, and its vowels with their digits."""
    told = heard([SILENCE, *words, SILENCE])
    return {
        word.text: " ".join(
            f"{p.name}{int(s)}" for p, s in zip(word.phones, of, strict=True) if p.name[0] in "AEIOU"
        )
        for word, of in zip(told, stresses_of(told), strict=True)
        if not word.silent
    }


def test_stress_is_where_the_front_end_has_it() -> None:
    assert stressed(SEVEN, AGAIN) == {"seven": "EH1 AH0", "again": "AH0 EH1"}
    assert stressed(("please", ("P", "L", "IY", "Z")), ("police", ("P", "AH", "L", "IY", "S"))) == {
        "please": "IY1",
        "police": "AH0 IY1",
    }


def test_function_words_are_unstressed_and_letters_are_not() -> None:
    found = stressed(BIN, ("blue", ("B", "L", "UW")), ("at", ("AE", "T")), ("f", ("EH", "F")), SEVEN)
    assert found == {"bin": "IH1", "blue": "UW1", "at": "AE0", "f": "EH1", "seven": "EH1 AH0"}
    assert stressed(("set", ("S", "EH", "T")), ("in", ("IH", "N")), ("a", ("EY",)))["a"] == "EY1"


def test_the_same_word_twice_and_silences_between_words_change_nothing() -> None:
    told = heard([SILENCE, AGAIN, SILENCE, AGAIN, SEVEN, SILENCE, SEVEN])
    found = stresses_of(told)
    again, seven = [False, False, True, False], [False, True, False, False, False]
    assert found == [[False], again, [False], again, seven, [False], seven]


def test_a_word_with_other_vowels_than_the_front_end_has_is_stressed_all_over() -> None:
    assert stressed(("seven", ("S", "EH", "V", "N")))["seven"] == "EH1"
    assert stressed(("again", ("AH", "G", "EH", "N", "AH")))["again"] == "AH1 EH1 AH1"


def test_without_silences_units_are_where_the_sound_has_them() -> None:
    found = made([SILENCE, BIN, SILENCE, AGAIN, SILENCE], silences=False, start_s=0.5)
    assert found.units == (SIL, "B", "IH1", "N", SIL, "AH0", "G", "EH1", "N", SIL)
    assert found.optional == (False,) * 10
    assert found.start == round((0.6 - MARGIN_S) * RATE)
    expected = 100 * (0.5 + 0.1 * np.arange(11)) - found.start
    np.testing.assert_allclose(found.times, np.stack([expected[:-1], expected[1:]], axis=1))
    np.testing.assert_allclose(found.seconds(), found.times / RATE)


def test_with_silences_one_may_be_between_any_two_words_and_the_sounds_own_are_not_looked_at() -> None:
    found = made([SILENCE, BIN, SILENCE, AGAIN, SEVEN, SILENCE], silences=True)
    assert found.units == (
        SIL, "B", "IH1", "N", SIL, "AH0", "G", "EH1", "N", SIL, "S", "EH1", "V", "AH0", "N", SIL,
    )  # fmt: skip
    assert np.flatnonzero(found.optional).tolist() == [4, 9]
    end_of_bin, start_of_again = found.times[3, 1], found.times[5, 0]
    assert found.times[4].tolist() == [end_of_bin, start_of_again]
    assert found.times[9, 0] == found.times[9, 1] == found.times[8, 1]


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize("last", [True, False])
def test_whether_a_clip_begins_or_ends_in_silence_its_words_may_be_apart(first: bool, last: bool) -> None:
    """In GRID, one clip in twenty has no silence before its first word."""
    words = [*[SILENCE] * first, BIN, AGAIN, SEVEN, *[SILENCE] * last]
    found = made(words, silences=True)
    assert len(found.units) == 12 + 2 + first + last
    optional = [found.units[i] for i, may in enumerate(found.optional) if may]
    assert optional == [SIL, SIL]
    between = [(found.units[i - 1], found.units[i + 1]) for i, may in enumerate(found.optional) if may]
    assert between == [("N", "AH0"), ("N", "S")]


def test_two_silences_in_a_row_are_one_place() -> None:
    found = made([SILENCE, SILENCE, BIN, SILENCE, SILENCE, AGAIN, SILENCE], silences=True)
    assert found.units == (SIL, "B", "IH1", "N", SIL, "AH0", "G", "EH1", "N", SIL)
    assert np.flatnonzero(found.optional).tolist() == [4]


@settings(max_examples=30, deadline=None)
@given(
    st.lists(st.sampled_from([SILENCE, BIN, AGAIN, SEVEN]), min_size=1, max_size=8).filter(
        lambda words: any(w != SILENCE for w in words)
    ),
    st.booleans(),
)
def test_units_are_known_and_times_ascend(words: Words, silences: bool) -> None:
    found = made(words, silences)
    assert set(found.units) <= set(features())
    assert len(found.units) == len(found.times) == len(found.optional)
    assert (np.diff(found.times.ravel()) >= -1e-9).all()
    for i, may in enumerate(found.optional):
        if may:
            assert found.units[i] == SIL
            assert SIL not in (found.units[i - 1], found.units[i + 1])


def test_some_of_the_silence_on_either_side_belongs_to_a_sentence() -> None:
    long = ("<sil>", ("SIL",) * 10)
    found = made([long, BIN, long], silences=False)
    assert found.start == 100 - 30
    np.testing.assert_array_equal(found.parameters[:, 0], np.arange(70, 160))


def test_a_margin_ends_where_the_clip_does() -> None:
    found = made([SILENCE, BIN, SILENCE], silences=False, frames=45)
    assert found.start == 0
    assert len(found.parameters) == 45
    assert found.times[-1].tolist() == pytest.approx([40, 50])


def test_silences_that_are_not_there_are_taken_out() -> None:
    found = made([SILENCE, BIN, AGAIN, SEVEN, SILENCE], silences=True)
    first, second = np.flatnonzero(found.optional)
    less = found.without([int(first)])
    assert less.units == found.units[:first] + found.units[first + 1 :]
    np.testing.assert_array_equal(less.times, np.delete(found.times, first, axis=0))
    assert less.units[second - 1] == SIL
    assert not any(less.optional)
    assert (less.name, less.start) == (found.name, found.start)
    np.testing.assert_array_equal(less.parameters, found.parameters)
    assert found.without([]).units == found.units


def seen(frames: int) -> Measured:
    return Measured(np.zeros((frames, 68)), np.zeros((frames, 1, 2)), np.ones(frames, bool), FAPU)


@pytest.mark.parametrize(("lost", "fits"), [(19, True), (20, False), (60, False), (84, False), (85, True)])
def test_a_sentence_is_usable_if_the_face_is_seen_all_through_it(lost: int, fits: bool) -> None:
    measured = seen(120)
    measured.seen[lost] = False
    given_ = replace(made([BIN], silences=False), parameters=np.zeros((65, 2)), start=20)
    assert usable(measured, given_) == fits


@pytest.mark.parametrize(("frames", "fits"), [(0, False), (20, False), (60, False), (74, False), (80, True)])
def test_a_sentence_that_goes_on_after_the_film_is_not_usable(frames: int, fits: bool) -> None:
    """Speech ends at 0.8 s, and the film here and there before; the silence at the end may be cut."""
    long: tuple[str, tuple[str, ...]] = ("<sil>", ("SIL",) * 5)
    found = made([long, BIN, long], silences=False, frames=frames)
    assert usable(seen(frames), found) == fits


def test_a_clip_of_one_word_has_no_place_for_silences() -> None:
    words: tuple[WordHeard, ...] = heard([BIN])
    found = sentence(Clip("a clip", NO_LANDMARKS, words), np.zeros((50, 1)), True)
    assert found.units == ("B", "IH1", "N")
    assert not any(found.optional)
