"""The incremental front-end of a turn."""

from __future__ import annotations

import gc
import time
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.errors import UnknownLanguage
from fapstream.records import SILENCE, Note, Phone, Utterance, Word
from fapstream.tts.frontend import LONGEST_PHRASE, FrontEnd
from fapstream.tts.manner import PHRASE, Manner, read_lexicon
from fapstream.tts.plan import HOLD_MS, MAX_PENDING
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
    "don't No. 1821 and the 😀 May 5, 2026 τον πατέρα to apples read lead 3 γυναίκες π.χ. </b> &amp; # - NATO"
)
PIECES = st.sampled_from(
    [
        *CHOSEN.split(),
        "\n",
        "\n\n",
        "\ud800",
        "x" * 250,
        "e\u0301",
        "<break/>",
        "<emphasis>now</emphasis>",
        "<prosody rate='fast'>",
        "</prosody>",
        "<mark name='m'/>",
        "<lang xml:lang='el'>",
        "</lang>",
        "<sub alias='a b'>",
        "</sub>",
        "word " * 15,
    ]
)
PLAIN = (
    "the a to of and record read lives has she 12 5% Dr. May 3 is polish reached "
    "των τον πατέρα με μια ως 1.500 άνδρες κι εκείνη zorb"
)
LONG = st.lists(st.sampled_from(PLAIN.split()), min_size=25, max_size=90).map(" ".join)
"""Phrases longer than is waited for."""
TEXT = st.lists(PIECES | st.text(max_size=8), max_size=60).map(" ".join) | st.text(max_size=300) | LONG
CUTS = st.lists(st.integers(0, 600), max_size=12)
LOOK_AHEAD = st.sampled_from([0, 1, 2, 5, PHRASE])
LANG = st.sampled_from(["en", "el"])


def spoken(lang: str, *fragments: str, look_ahead: int = PHRASE) -> list[Utterance]:
    front = FrontEnd(lang, Manner(look_ahead=look_ahead))
    return [u for f in fragments for u in front.feed(f)] + front.end()


def flat(utterances: list[Utterance]) -> list[tuple[Phone, Word | None]]:
    """Every phone with its word, whatever utterances they came in."""
    return [
        (p._replace(word=-1), u.words[p.word] if p.word >= 0 else None) for u in utterances for p in u.phones
    ]


def fragments(text: str, cuts: list[int]) -> list[str]:
    edges = [0, *sorted(min(c, len(text)) for c in cuts), len(text)]
    return [text[a:b] for a, b in pairwise(edges)]


def syllables(utterance: Utterance) -> int:
    phones = phone_set(utterance.lang)
    return sum(phones[p.name].kind == "vowel" for p in utterance.phones)


def speech_ms(utterance: Utterance) -> float:
    return sum(p.duration_ms for p in utterance.phones if p.name != SILENCE)


@settings(max_examples=150, deadline=None)
@given(LANG, TEXT, CUTS, LOOK_AHEAD)
def test_any_fragmentation_gives_the_same_words_phones_and_timing(
    lang: str, text: str, cuts: list[int], look_ahead: int
) -> None:
    whole = flat(spoken(lang, text, look_ahead=look_ahead))
    assert flat(spoken(lang, *fragments(text, cuts), look_ahead=look_ahead)) == whole
    assert flat(spoken(lang, *text, look_ahead=look_ahead)) == whole


@pytest.mark.parametrize("lang", ["en", "el"])
@pytest.mark.parametrize("shape", ["{}", "#{}", "#a{}", "3{}", "{}%", "1,{}", "A{}", "x.y/{}", "{}ος"])
@pytest.mark.parametrize("digit", ["²", "①", "٣", "Ⅷ", "½", "፩"])
def test_digits_of_every_kind_are_read_or_skipped(lang: str, shape: str, digit: str) -> None:
    assert spoken(lang, f"so {shape.format(digit)} so.")


@settings(max_examples=80, deadline=None)
@given(LANG, TEXT)
def test_look_ahead_changes_timing_only(lang: str, text: str) -> None:
    def said(look_ahead: int) -> list[tuple[str, int, Word | None]]:
        return [(p.name, p.stress, word) for p, word in flat(spoken(lang, text, look_ahead=look_ahead))]

    whole = said(PHRASE)
    assert all(said(k) == whole for k in (0, 1, 2))


@settings(max_examples=100, deadline=None)
@given(LANG, TEXT, LOOK_AHEAD, st.sets(st.integers(0, 40)))
def test_when_text_comes_only_inserts_holds(lang: str, text: str, look_ahead: int, holds: set[int]) -> None:
    front = FrontEnd(lang, Manner(look_ahead=look_ahead))
    found: list[Utterance] = []
    for i, c in enumerate(text):
        found += front.feed(c)
        if i % 41 in holds:
            held = front.hold()
            assert all(p.hold and p.word == -1 for u in held for p in u.phones)
            assert all(u.closed and u.phones[-1].name == SILENCE for u in held)
            assert front.hold() == [], "one hold is enough until something is said"
            found += held
    found += front.end()
    assert [pair for pair in flat(found) if not pair[0].hold] == flat(
        spoken(lang, text, look_ahead=look_ahead)
    )


@settings(max_examples=100, deadline=None)
@given(LANG, TEXT, LOOK_AHEAD)
def test_utterances_are_well_formed_whatever_the_text(lang: str, text: str, look_ahead: int) -> None:
    front = FrontEnd(lang, Manner(look_ahead=look_ahead))
    found = [u for c in text for u in front.feed(c)] + front.end()
    phones = phone_set(lang)
    at = -1
    for utterance in found:
        assert utterance.phones
        for word in utterance.words:
            assert " ".join(text[word.start : word.end].split()) == " ".join(word.text.split())
            assert at <= word.start < word.end
            assert word.spoken
            at = word.end
        assert {p.word for p in utterance.phones} - {-1} <= set(range(len(utterance.words)))
        for phone in utterance.phones:
            assert phone.name in phones
            assert 1.0 < phone.duration_ms <= 10_000
            assert (phone.word == -1) == (phone.name == SILENCE)
            assert all(0 <= percent <= 100 and 40 < f0 < 350 for percent, f0 in phone.pitch)
            assert phone.pitch or phone.name == SILENCE
        assert utterance.closed == (utterance.phones[-1].name == SILENCE)
    assert not found or found[-1].closed
    assert front.end() == []
    assert front.pending_words == 0


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


def test_words_come_out_with_the_look_ahead_asked_for() -> None:
    text = "one two three four five "
    for look_ahead in range(4):
        front = FrontEnd("en", Manner(look_ahead=look_ahead))
        came = []
        for token in text.split():
            words = [w.text for u in front.feed(token + " ") for w in u.words]
            came.append(len(words))
        assert came == [0] * look_ahead + [1] * (5 - look_ahead)
        assert front.pending_words == look_ahead


def test_a_word_waits_for_the_next_only_if_that_can_change_it() -> None:
    front = FrontEnd("en", Manner(look_ahead=0))
    assert front.feed("I saw the ")[0].words[-1].text == "saw"
    (rest,) = front.feed("apple ")
    assert [p.name for p in rest.phones][:2] == ["D", "i"]
    front = FrontEnd("el", Manner(look_ahead=0))
    assert front.feed("με τον ")[0].words[-1].text == "με"
    (rest,) = front.feed("πατέρα ")
    assert [p.name for p in rest.phones] == ["t", "o", "m", "b", "a", "t", "e", "r", "a"]


def test_a_hold_draws_out_the_last_sound_and_pauses() -> None:
    front = FrontEnd("en", Manner(look_ahead=0))
    assert front.hold() == []
    (first,) = front.feed("The quick yellow fo")
    assert [w.text for w in first.words] == ["The", "quick", "yellow"]
    assert not first.closed
    assert front.speaking
    (hold,) = front.hold()
    drawn, pause = hold.phones
    assert (drawn.name, drawn.duration_ms, pause.name) == (first.phones[-1].name, HOLD_MS, SILENCE)
    assert drawn.pitch[0][1] == first.phones[-1].pitch[-1][1]
    assert hold.closed
    assert not front.speaking
    (rest,) = front.feed("x jumps. ")
    assert [w.text for w in rest.words] == ["fox", "jumps"]


def test_a_stop_is_not_drawn_out() -> None:
    front = FrontEnd("en", Manner(look_ahead=0))
    front.feed("a cat sat ")
    (hold,) = front.hold()
    assert [p.name for p in hold.phones] == [SILENCE]


def test_what_the_next_word_decides_is_remembered_over_a_hold() -> None:
    front = FrontEnd("en", Manner(look_ahead=0))
    (spoken_part,) = front.feed("We left the U.S. ")
    assert not spoken_part.closed
    front.hold()
    closing, rest = front.feed("Then we slept. ")
    assert [p.name for p in closing.phones] == [SILENCE]
    assert [w.text for w in rest.words] == ["Then", "we", "slept"]


def test_discarded_words_are_not_said_and_what_follows_goes_on() -> None:
    front = FrontEnd("en", Manner(look_ahead=2))
    first = front.feed("we will go home now ")
    front.discard()
    rest = front.feed("stay here. ")
    assert [w.text for u in first + rest for w in u.words] == ["we", "will", "go", "stay", "here"]
    assert rest[0].words[0].start == 20
    straight = spoken("en", "we will go stay here. ", look_ahead=2)
    assert [p for p, _ in flat(first + rest)] == [p for p, _ in flat(straight)], (
        "the plan goes on as if never fed"
    )


def test_marks_and_warnings_go_with_the_next_phone() -> None:
    text = "one <mark name='here'/>two <b>three.<mark name='end'/>"
    notes = [(n, word.text if word else "") for p, word in flat(spoken("en", text)) for n in p.notes]
    assert notes[0] == (Note("mark", "here", 4, 23), "two")
    assert notes[1][0].kind == "warning"
    assert [n.text for n, _ in notes[2:]] == ["end"]
    assert text[slice(*notes[1][0][2:])] == "<b>"


def test_emphasis_is_longer_higher_and_louder_and_what_follows_lower() -> None:
    (plain,) = spoken("en", "you must never touch the red button.")
    (strong,) = spoken("en", "you must <emphasis level='strong'>never</emphasis> touch the red button.")

    def of(u: Utterance, text: str) -> list[Phone]:
        return [p for p in u.phones if p.word >= 0 and u.words[p.word].text == text]

    def peak(phones: list[Phone]) -> float:
        return max(hz for p in phones for _, hz in p.pitch)

    assert sum(p.duration_ms for p in of(strong, "never")) > 1.1 * sum(
        p.duration_ms for p in of(plain, "never")
    )
    assert peak(of(strong, "never")) > peak(of(plain, "never")) + 10
    assert peak(of(strong, "red")) < peak(of(plain, "red"))
    assert {p.gain for p in of(strong, "never")} == {1.32}
    assert {p.gain for p in of(strong, "red")} == {1.0}
    assert sum(p.duration_ms for p in of(strong, "touch")) == sum(p.duration_ms for p in of(plain, "touch"))


def test_prosody_of_markup() -> None:
    (plain,) = spoken("en", "come here now.")
    (styled,) = spoken("en", "come <prosody rate='50%' pitch='+12st' volume='50'>here</prosody> now.")
    a, b = ([p for p in u.phones if p.word == 1] for u in (plain, styled))
    assert [p.duration_ms for p in b] == pytest.approx([2 * p.duration_ms for p in a])
    assert b[0].pitch[0][1] == pytest.approx(a[0].pitch[0][1] + 120, abs=8)
    assert {p.gain for p in b} == {0.5}


def test_words_inside_lang_are_read_by_that_language() -> None:
    (u,) = spoken("en", "it is <lang xml:lang='el'>21</lang> now.")
    assert u.words[2].spoken == ("είκοσι", "ένα")


def test_the_users_lexicon_comes_first() -> None:
    lexicon = read_lexicon('Fapstream\tf {1 p s t r i0 m\nSQL\t"sequel"\nC++\t"see plus plus"', "f", "en")
    front = FrontEnd("en", Manner(lexicon=lexicon))
    (u,) = front.feed("FAPSTREAM, ")
    assert " ".join(p.name for p in u.phones if p.word >= 0) == "f { p s t r i m"
    words = [w for u in front.feed("(SQL) C++. ") for w in u.words]
    assert [(w.text, w.spoken) for w in words] == [("SQL", ("sequel",)), ("C++", ("see", "plus", "plus"))]
    assert front.path(u.words[0]) == "user"
    assert front.path(words[0]) == "user"


def test_paths() -> None:
    front = FrontEnd("en")
    (u,) = front.feed("Hello B zorblax γεια. ")
    assert [front.path(w) for w in u.words] == ["lexicon", "letter", "tree", "rule"]
    assert front.path(Word("x", 0, 1, ("hello", "zorblax"))) == "lexicon+tree"


def test_wrapped_lines_go_on_and_short_ones_end() -> None:
    wrapped = (
        "The government said on Tuesday that it would publish its new\nplans before the end of the month."
    )
    assert len(spoken("en", wrapped)) == len(spoken("en", wrapped.replace("\n", " ")))
    assert [u.closed for u in spoken("en", "A headline\nthen a line")] == [True, True]


def test_a_blank_line_is_a_longer_pause() -> None:
    def silence(text: str) -> float:
        return sum(p.duration_ms for u in spoken("en", text) for p in u.phones if p.name == SILENCE)

    assert silence("One.\n\nTwo.") > silence("One.\nTwo.") + 200
    assert silence("One.\n\n\n\n\nTwo.\n") == silence("One.\n\nTwo.")
    assert silence("\n\n\n") == 0


def test_a_phrase_without_content_words_has_an_accent_too() -> None:
    (u,) = spoken("en", "it is.")
    f0 = [hz for p in u.phones for _, hz in p.pitch]
    assert max(f0) > f0[0] + 5


def test_long_phrases_are_spoken_in_pieces() -> None:
    front = FrontEnd("en")
    assert front.feed("word " * MAX_PENDING) == []
    (first,) = front.feed("word ")
    assert (len(first.words), first.closed) == (MAX_PENDING, False)
    front = FrontEnd("en")
    (first,) = front.feed("word " * 14 + "of " + "word " * 6)
    assert len(first.words) == 14, "cut before a function word"


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
    normal, fast = FrontEnd("en"), FrontEnd("en", Manner(rate=2.0, pitch=2.0))
    (a,), (b,) = normal.feed("Good morning. "), fast.feed("Good morning. ")
    assert speech_ms(a) == pytest.approx(2 * speech_ms(b))
    assert b.phones[3].pitch[0][1] > 1.7 * a.phones[3].pitch[0][1]
    assert b.phones[-1].duration_ms >= 100


@pytest.mark.parametrize(
    "text",
    [
        "",
        " ",
        "\n\n",
        "\U0001fae8\U0001fae8",
        "—",
        "...",
        "\ud800",
        "\x00\x01",
        "привет",
        "'",
        "* * *",
        "\u0301",
        "ﷺ",
    ],
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

    gc.disable()  # it would go through the memory of all tests before this one
    try:
        seconds(text[:2000])
        quarter, whole = seconds(text[: len(text) // 4]), seconds(text)
    finally:
        gc.enable()
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


@pytest.mark.parametrize("look_ahead", [0, 1, PHRASE])
@pytest.mark.parametrize("step", [1, 50, 10**6])
def test_whoever_reads_without_marks_takes_breath(look_ahead: int, step: int) -> None:
    """So nothing that is kept of a phrase grows without end; where, does not depend on the pieces."""
    text = "banana to the river " * 200
    front = FrontEnd("en", Manner(look_ahead=look_ahead))
    utterances = [u for at in range(0, len(text), step) for u in front.feed(text[at : at + step])]
    utterances += front.end()
    words, ends = 0, []
    for u in utterances:
        words += len(u.words)
        if u.closed:
            ends.append(words)
    assert ends == list(range(LONGEST_PHRASE, 801, LONGEST_PHRASE))


def test_a_fresh_one_has_read_nothing() -> None:
    read = FrontEnd("el", Manner(look_ahead=1, rate=1.5))
    read.feed(GREEK[:100])
    assert read.fresh().feed(GREEK) == FrontEnd("el", Manner(look_ahead=1, rate=1.5)).feed(GREEK)
