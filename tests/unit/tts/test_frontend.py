"""The incremental front-end of a turn."""

from __future__ import annotations

import time
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.errors import UnknownLanguage
from fapstream.records import SILENCE, Utterance
from fapstream.tts.frontend import MAX_PENDING, FrontEnd
from fapstream.tts.tables import phone_set

ENGLISH = (
    "The prime minister said on Tuesday that the government would publish its plans before the "
    "end of the month, after weeks of talks with the unions. Shares fell by 3.5% in early "
    "trading, but they recovered later in the day. Is the weather going to be better tomorrow? "
    "Nobody knows what will happen next! "
)
GREEK = (
    "Ο πρωθυπουργός δήλωσε την Τρίτη ότι η κυβέρνηση θα δημοσιεύσει τα σχέδιά της πριν από το "
    "τέλος του μήνα, μετά από εβδομάδες συνομιλιών με τα συνδικάτα. Οι μετοχές έπεσαν 3,5% το "
    "πρωί, αλλά ανέκαμψαν αργότερα. Θα είναι καλύτερος ο καιρός αύριο; Κανείς δεν ξέρει τι θα "
    "γίνει μετά! "
)

CHOSEN = (
    "Hello world Dr. U.S. etc. 21:45 $5 million 3.5% . , ? ! \\:)500 καλημέρα ο κ. λέει; (so it) — ... "
    "don't No. 1821 and the 😀"
)
PIECES = st.sampled_from([*CHOSEN.split(), "\n", "\ud800", "x" * 250, "e\u0301"])
TEXT = st.lists(PIECES | st.text(max_size=8), max_size=60).map(" ".join) | st.text(max_size=300)


def spoken(lang: str, *fragments: str) -> list[Utterance]:
    front = FrontEnd(lang)
    return [u for f in fragments for u in front.feed(f)] + front.end()


def syllables(utterance: Utterance) -> int:
    phones = phone_set(utterance.lang)
    return sum(phones[p.name].kind == "vowel" for p in utterance.phones)


def speech_ms(utterance: Utterance) -> float:
    return sum(p.duration_ms for p in utterance.phones if p.name != SILENCE)


@settings(max_examples=80, deadline=None)
@given(st.sampled_from(["en", "el"]), TEXT, st.lists(st.integers(0, 600), max_size=12))
def test_any_fragmentation_gives_the_same_phones(lang: str, text: str, cuts: list[int]) -> None:
    whole = spoken(lang, text)
    edges = [0, *sorted(min(c, len(text)) for c in cuts), len(text)]
    assert spoken(lang, *(text[a:b] for a, b in pairwise(edges))) == whole
    assert spoken(lang, *text) == whole


@settings(max_examples=80, deadline=None)
@given(st.sampled_from(["en", "el"]), TEXT, st.sets(st.integers(0, 40)))
def test_utterances_are_well_formed_whatever_the_text_and_the_holds(
    lang: str, text: str, holds: set[int]
) -> None:
    front = FrontEnd(lang)
    found: list[Utterance] = []
    for i, c in enumerate(text):
        found += front.feed(c)
        if i % 41 in holds:
            found += front.hold()
            assert front.pending_words == 0
    found += front.end()
    phones = phone_set(lang)
    at = 0
    for utterance in found:
        assert utterance.phones
        for word in utterance.words:
            assert text[word.start : word.end] == word.text
            assert at <= word.start < word.end
            at = word.end
        for phone in utterance.phones:
            assert phone.name in phones
            assert 1.0 < phone.duration_ms <= 10_000
            assert (phone.word == -1) == (phone.name == SILENCE)
            assert phone.word < len(utterance.words)
            assert all(0 <= percent <= 100 and 60 < f0 < 240 for percent, f0 in phone.pitch)
        if utterance.closed:
            assert utterance.phones[-1].name == SILENCE
            assert utterance.phones[-1].duration_ms >= (100 if utterance.words else 40)
        else:
            assert utterance.phones[-1].name != SILENCE
    assert not found or found[-1].closed
    assert front.end() == []


def test_phrases_come_out_as_soon_as_they_cannot_change() -> None:
    front = FrontEnd("en")
    assert front.feed("Hello, ")[0].words[0].text == "Hello"
    assert front.feed("my friend") == []
    assert front.pending_words == 1
    assert front.feed(".") == []
    (sentence,) = front.feed(" ")
    assert [(w.text, w.start, w.end) for w in sentence.words] == [("my", 7, 9), ("friend", 10, 16)]
    assert sentence.closed
    assert front.feed("a title\n")[0].closed


def test_hold_speaks_complete_words_and_the_rest_goes_on() -> None:
    front = FrontEnd("en")
    assert front.hold() == []
    front.feed("The quick brown fo")
    (first,) = front.hold()
    assert [w.text for w in first.words] == ["The", "quick", "brown"]
    assert not first.closed
    assert front.hold() == []
    (rest,) = front.feed("x jumps. ")
    assert [w.text for w in rest.words] == ["fox", "jumps"]
    joined = first.phones[-1].pitch[-1][1], rest.phones[0].pitch[0][1]
    assert joined[0] == pytest.approx(joined[1])
    fresh = FrontEnd("en").feed("fox jumps. ")[0]
    assert rest.phones[0].pitch[0][1] < fresh.phones[1].pitch[0][1]


def test_what_the_next_word_decides_is_remembered_over_a_hold() -> None:
    front = FrontEnd("en")
    front.feed("We left the U.S. ")
    (spoken_part,) = front.hold()
    assert not spoken_part.closed
    closing, rest = front.feed("Then we slept. ")
    assert [p.name for p in closing.phones] == [SILENCE]
    assert [w.text for w in rest.words] == ["Then", "we", "slept"]


def test_a_phrase_left_open_is_closed_at_the_end() -> None:
    front = FrontEnd("en")
    front.feed("one two ")
    front.hold()
    (closing,) = front.end()
    assert closing.closed
    assert [p.name for p in closing.phones] == [SILENCE]


def test_long_phrases_are_spoken_in_pieces() -> None:
    utterances = spoken("en", "word " * 50)
    assert [u.closed for u in utterances] == [False, False, True]
    assert all(len(u.words) <= MAX_PENDING for u in utterances)


def test_pauses_and_melody_follow_the_punctuation() -> None:
    comma, statement = spoken("en", "It is late, we are going.")
    (question,) = spoken("en", "Are we going?")
    (asked,) = spoken("en", "Where are we going?")
    assert comma.phones[-1].duration_ms < statement.phones[-1].duration_ms

    def last(u: Utterance) -> float:
        return u.phones[-2].pitch[-1][1]

    assert last(statement) < 95 < last(comma) < last(question)
    assert last(asked) < 95


def test_smileys_are_silent_utterances_with_an_expression() -> None:
    first, smile, rest = spoken("en", "Hi \\:)1500 there.")
    (phone,) = smile.phones
    assert (phone.name, phone.duration_ms, phone.expression, smile.closed) == (SILENCE, 1500, "joy", True)
    assert first.closed
    assert [w.text for w in rest.words] == ["there"]


def test_a_turn_begins_almost_at_once() -> None:
    phones = spoken("el", "Γεια σου.")[0].phones
    assert phones[0].name == SILENCE
    assert phones[0].duration_ms <= 20
    assert phones[1].name != SILENCE


@pytest.mark.parametrize(
    ("lang", "text", "low", "high"), [("en", ENGLISH, 4.0, 5.5), ("el", GREEK, 5.0, 7.0)]
)
def test_articulation_rate(lang: str, text: str, low: float, high: float) -> None:
    utterances = spoken(lang, text)
    assert low < 1000 * sum(map(syllables, utterances)) / sum(map(speech_ms, utterances)) < high


def test_rate_and_pitch() -> None:
    normal, fast = FrontEnd("en"), FrontEnd("en", rate=2.0, f0_hz=240.0)
    (a,), (b,) = normal.feed("Good morning. "), fast.feed("Good morning. ")
    assert speech_ms(a) == pytest.approx(2 * speech_ms(b))
    assert b.phones[3].pitch[0][1] > 1.8 * a.phones[3].pitch[0][1]
    assert b.phones[-1].duration_ms >= 100


@pytest.mark.parametrize(
    "text", ["", " ", "\n\n", "😀", "—", "...", "\ud800", "\x00\x01", "привет", "'", "* * *", "\u0301", "ﷺ"]
)
def test_what_cannot_be_spoken_is_skipped(text: str) -> None:
    assert spoken("en", text) == []
    assert [w.text for u in spoken("el", f"να {text} ναι") for w in u.words] == ["να", "ναι"]


@pytest.mark.parametrize(
    "text",
    [
        "a" * 100_000,
        "a " * 20_000,
        "(" * 100_000,
        ".," * 50_000,
        "ά" * 100_000,
        "a\\:" * 20_000,
        "a-" * 30_000,
    ],
)
def test_megabytes_take_linear_time(text: str) -> None:
    def seconds(part: str) -> float:
        begin = time.process_time()
        spoken("en", part)
        return time.process_time() - begin

    seconds(text[:2000])
    quarter, whole = seconds(text[: len(text) // 4]), seconds(text)
    assert whole < 10 * quarter + 0.1


def test_a_sentence_takes_about_a_millisecond() -> None:
    sentence = (
        "The quick brown fox jumps over the lazy dog while nine old men are watching it from a small hill. "
    )
    FrontEnd("en").feed(ENGLISH)
    best = 1.0
    for _ in range(5):
        begin = time.process_time()
        for _ in range(20):
            FrontEnd("en").feed(sentence)
        best = min(best, (time.process_time() - begin) / 20)
    assert best < 0.004


def test_unknown_language() -> None:
    with pytest.raises(UnknownLanguage):
        FrontEnd("xx")
