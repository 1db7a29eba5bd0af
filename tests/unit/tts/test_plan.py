"""The plan of phrases, word by word."""

from __future__ import annotations

import pytest

from fapstream.records import SILENCE, Note, Phone, Utterance
from fapstream.tts.manner import PHRASE, Manner
from fapstream.tts.markup import Style
from fapstream.tts.normalise import Item
from fapstream.tts.plan import HOLD_PAUSE_MS, LEAD_MS, MIN_PAUSE_MS, PlannedWord, Planner
from fapstream.tts.prosody import standard

PROSODY = standard("en")


def word(
    text: str, start: int = 0, stop: str = "", weak: bool = False, style: Style | None = None
) -> PlannedWord:
    """A word that sounds like t A t, whatever it is called."""
    item = Item(text, start, start + len(text), [text], style or Style(), stop)
    return PlannedWord(item, [PROSODY.sounds[t] for t in ("t", "A1", "t")], weak, False, True)


def planner(look_ahead: int = PHRASE, rate: float = 1.0) -> Planner:
    return Planner("en", PROSODY, Manner(look_ahead=look_ahead, rate=rate))


def spoken(
    *words: PlannedWord, look_ahead: int = PHRASE, kind: str = "sentence", rate: float = 1.0
) -> list[Phone]:
    plan = planner(look_ahead, rate)
    for w in words:
        plan.add([w], False)
        if not w.item.stop:  # its end would come before anything else is asked
            plan.advance()
    plan.close(kind)
    return [p for u in plan.take() for p in u.phones]


def texts(utterances: list[Utterance]) -> list[str]:
    return [w.text for u in utterances for w in u.words]


@pytest.mark.parametrize("look_ahead", [0, 1, 2])
def test_a_word_is_committed_once_its_look_ahead_is_there(look_ahead: int) -> None:
    plan = planner(look_ahead)
    for k in range(5):
        plan.add([word(f"w{k}")], False)
        plan.advance()
        assert texts(plan.take()) == ([f"w{k - look_ahead}"] if k >= look_ahead else [])
        assert plan.pending == min(k + 1, look_ahead)
    plan.close("sentence")
    assert texts(plan.take()) == [f"w{k}" for k in range(5 - look_ahead, 5)]


def test_an_item_is_never_committed_in_part() -> None:
    item = Item("21", 0, 2, ["twenty", "one"])
    sounds = [PROSODY.sounds["A1"]]
    plan = planner(1)
    plan.add(
        [PlannedWord(item, sounds, False, False, False), PlannedWord(item, sounds, False, False, True)], False
    )
    plan.advance()
    assert plan.take() == []
    plan.add([word("next")], False)
    plan.advance()
    assert texts(plan.take()) == ["21"]


def test_the_end_is_seen_from_as_far_as_the_look_ahead_reaches() -> None:
    """A written end lengthens the last word whatever the look-ahead; one that comes later needs some."""
    plain = spoken(word("a"), word("b"), look_ahead=0)[4:7]
    written = spoken(word("a"), word("b", stop="sentence"), look_ahead=0)[4:7]
    seen = spoken(word("a"), word("b"), look_ahead=1)[4:7]
    assert [p.duration_ms for p in written] == [p.duration_ms for p in seen]
    assert written[1].duration_ms > 1.2 * plain[1].duration_ms
    assert written[-1].pitch[-1][1] < plain[-1].pitch[-1][1]


def test_the_last_accent_is_the_tunes() -> None:
    def peaks(kind: str) -> list[float]:
        phones = spoken(word("a"), word("b"), word("c", weak=True), kind=kind)
        return [max(hz for _, hz in p.pitch) for p in phones if p.name == "A"]

    fall, exclaim = peaks("sentence"), peaks("exclamation")
    assert exclaim[1] > fall[1] + 10
    assert exclaim[0] > fall[0], "its accents before are higher as well"
    assert fall[2] < fall[1]


def test_a_question_word_changes_the_question() -> None:
    ends = []
    for asks in (False, True):
        plan = planner()
        plan.add([word("a")], asks)
        plan.close("question")
        ends.append(plan.take()[0].phones[-2].pitch[-1][1])
    assert ends[0] > ends[1] + 50


def test_silence_before_and_after() -> None:
    phones = spoken(word("a"))
    assert (phones[0].name, phones[0].duration_ms) == (SILENCE, LEAD_MS)
    assert (phones[-1].name, phones[-1].duration_ms) == (SILENCE, PROSODY.stops["sentence"].pause_ms)
    assert spoken(word("a"), rate=4.0)[-1].duration_ms == MIN_PAUSE_MS
    plan = planner()
    plan.close("sentence")
    assert plan.take() == [], "nothing was said, so nothing ends"
    plan.close("break", 700.0)
    assert [p.duration_ms for u in plan.take() for p in u.phones] == [700.0]


def test_holds() -> None:
    plan = planner(0)
    plan.hold()
    assert plan.take() == []
    plan.add([word("a")], False)
    plan.advance()
    plan.take()
    assert plan.speaking
    plan.hold()
    (held,) = plan.take()
    assert [(p.name, p.duration_ms, p.hold) for p in held.phones] == [(SILENCE, HOLD_PAUSE_MS, True)], (
        "t is a stop"
    )
    assert not plan.speaking
    plan.close("sentence")
    assert [p.hold for u in plan.take() for p in u.phones] == [False]


def test_notes_go_with_the_first_phone_after_them() -> None:
    plan = planner(0)
    plan.note(Note("mark", "m", 5, 6))
    plan.add([word("a", 0), word("b", 7)], False)
    plan.note(Note("mark", "n", 9, 10))
    plan.close("sentence")
    plan.note(Note("mark", "o", 11, 12))
    plan.finish()
    found = [(p.name, [n.text for n in p.notes]) for u in plan.take() for p in u.phones if p.notes]
    assert found == [("t", ["m"]), (SILENCE, ["n"]), (SILENCE, ["o"])]


def test_styles() -> None:
    plain, styled = spoken(word("a")), spoken(word("a", style=Style(rate=2.0, pitch=2.0, volume=0.5)))
    assert styled[2].duration_ms == pytest.approx(plain[2].duration_ms / 2)
    assert styled[1].pitch[0][1] > plain[1].pitch[0][1] + 100
    assert {p.gain for p in styled if p.word >= 0} == {0.5}
    strong, weak = (spoken(word("a", style=Style(emphasis=e)), word("b")) for e in (0.8, -0.5))
    assert max(hz for _, hz in strong[2].pitch) > max(hz for _, hz in weak[2].pitch) + 20
    assert strong[2].gain > 1.0 > weak[2].gain
