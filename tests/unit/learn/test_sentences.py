"""What is learned from: units with their stress and times, silences that may be."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.learn.clips import Clip, PhoneHeard, WordHeard
from fapstream.learn.landmarks import Landmarks
from fapstream.learn.measured import Measured, measure_clip
from fapstream.learn.sentences import Sentence, sentence, stresses_of, usable
from fapstream.motion.units import SIL
from tests.unit.learn.talker import IDS, moved

SPOKEN = {
    "seven": "S EH V AH N", "again": "AH G EH N", "at": "AE T", "f": "EH F", "a": "EY", "blue": "B L UW",
    "zero": "Z IH R OW",
    "please": "P L IY Z",
}  # fmt: skip


def words(*said: str, pause: float = 0.0) -> tuple[WordHeard, ...]:
    at, found = 0.5, [WordHeard("<sil>", 0.0, 0.5, (PhoneHeard("SIL", 0.0, 0.5),))]
    for k, word in enumerate(said):
        if pause and k == 1:
            found.append(WordHeard("<sil>", at, at + pause, (PhoneHeard("SIL", at, at + pause),)))
            at += pause
        phones, start = [], at
        for phone in SPOKEN[word].split():
            phones.append(PhoneHeard(phone, at, at + 0.1))
            at += 0.1
        found.append(WordHeard(word, start, at, tuple(phones)))
    found.append(WordHeard("<sil>", at, at + 0.5, (PhoneHeard("SIL", at, at + 0.5),)))
    return tuple(found)


def clip(*said: str, pause: float = 0.0) -> Clip:
    return Clip("it", Landmarks(np.zeros((4, len(IDS), 3)), IDS), words(*said, pause=pause))


def stressed(*said: str) -> list[str]:
    found = words(*said)
    return [
        f"{p.name}{int(s)}" for w, stresses in zip(found, stresses_of(found), strict=True)
        for p, s in zip(w.phones, stresses, strict=True) if p.name[0] in "AEIOU"
    ]  # fmt: skip


def test_stress_is_the_front_ends() -> None:
    assert stressed("seven", "again") == ["EH1", "AH0", "AH0", "EH1"]
    assert stressed("blue", "at", "f", "zero") == ["UW1", "AE0", "EH1", "IH1", "OW0"]


def test_a_letter_that_is_spelled_is_stressed() -> None:
    assert stressed("blue", "a", "please") == ["UW1", "EY1", "IY1"]


def test_units_have_the_times_of_the_sound_from_the_sentences_first_frame() -> None:
    made = sentence(clip("blue", "at"), np.arange(400.0).reshape(200, 2), False)
    assert made.units == (SIL, "B", "L", "UW1", "AE1", "T", SIL)
    assert made.start == 20
    assert made.parameters[0, 0] == 40
    assert made.times[1] == pytest.approx([30, 40])
    assert made.seconds()[1] == pytest.approx([0.3, 0.4])
    assert not any(made.optional)
    assert len(made.parameters) == 110


def test_silences_may_be_between_any_two_words() -> None:
    parameters = np.zeros((300, 2))
    made = sentence(clip("blue", "at", "please", pause=0.2), parameters, True)
    assert [i for i, may in enumerate(made.optional) if may] == [4, 7]
    assert made.units[4] == made.units[7] == SIL
    assert made.times[4] == pytest.approx([60, 80]), "where the sound is silent"
    assert made.times[7] == pytest.approx([100, 100])
    heard = sentence(clip("blue", "at", pause=0.2), parameters, False)
    assert heard.units == (SIL, "B", "L", "UW1", SIL, "AE1", "T", SIL)


def test_units_can_be_left_out() -> None:
    made = sentence(clip("blue", "at"), np.zeros((300, 2)), True).without([4])
    assert made.units == (SIL, "B", "L", "UW1", "AE1", "T", SIL)
    assert not any(made.optional)
    assert len(made.times) == 7


def test_a_sentence_in_which_the_face_is_lost_is_not_used() -> None:
    measured = measure_clip(Landmarks(moved(np.zeros((60, 68))) * (1, -1, -1), IDS))
    made = Sentence("s", np.zeros((50, 2)), (SIL,), np.zeros((1, 2)), (False,), 100)
    assert usable(measured, made)
    seen = measured.seen.copy()
    seen[120] = False
    lost = Measured(measured.faps, measured.points, seen, measured.fapu)
    assert not usable(lost, made)
    assert usable(lost, Sentence("s", np.zeros((20, 2)), (SIL,), np.zeros((1, 2)), (False,), 100))
