"""The corridor, with a voice made of arithmetic: packets, marks, captions, and what was heard."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.pipeline import UNSAID, Pipeline
from fapstream.records import SILENCE, Mark, Packet, Phone, Speech, TurnFormat, Utterance, Word
from fapstream.tts import PHRASE, FrontEnd, Manner
from tests.unit.fakes import timed

TEXT = 'Hello world, it is "late." \\:)300 He said: go home! No 1,234 times?'


def pipeline(lang: str = "en", rate: int = 16000, look_ahead: int = PHRASE) -> Pipeline:
    front = FrontEnd(lang, Manner(look_ahead=look_ahead))
    return Pipeline(TurnFormat(3, "v", lang, rate, 25), front, seed=1)


def speeches(utterances: list[Utterance], rate: int = 16000, start: int = 0) -> list[Speech]:
    """Each utterance as long as it wishes to be, as one Speech."""
    out = []
    for u in utterances:
        phones = timed(u.phones, rate, start, u)
        end = phones[-1].end
        out.append(Speech(start, (np.arange(start, end) % 32768).astype(np.int16), phones))
        start = end
    return out


def said(text: str, lang: str = "en", rate: int = 16000, step: int | None = None) -> list[Packet]:
    """A whole turn; its text in pieces of `step` characters."""
    line = pipeline(lang, rate)
    utterances = []
    for at in range(0, len(text), step or max(1, len(text))):
        utterances += line.feed(text[at : at + (step or len(text))])
    utterances += line.end()
    packets: list[Packet] = []
    for speech in speeches(utterances, rate):
        line.add(speech)
        packets += line.packets()
    return packets + list(line.packets(last=True))


def marks(packets: list[Packet], kind: str) -> list[Mark]:
    return [m for p in packets for m in p.marks if m.kind == kind]


@pytest.mark.parametrize("rate", [16000, 22050])
def test_packets_are_contiguous_and_only_the_last_is_short(rate: int) -> None:
    packets = said(TEXT, rate=rate)
    size = rate // 25
    assert [p.start for p in packets] == [k * size for k in range(len(packets))]
    assert {len(p.pcm) for p in packets[:-1]} == {size}
    assert 0 < len(packets[-1].pcm) <= size
    total = packets[-1].start + len(packets[-1].pcm)
    assert np.array_equal(np.concatenate([p.pcm for p in packets]), np.arange(total) % 32768)


def test_every_packet_has_the_frames_of_its_samples() -> None:
    for packet in said(TEXT, rate=22050):
        expected = [s for s in range(0, 10**7, 882) if packet.start <= s < packet.start + len(packet.pcm)]
        assert [f.sample for f in packet.frames] == expected


def test_marks_come_in_order_in_the_packet_of_their_sample() -> None:
    packets = said(TEXT)
    for packet in packets:
        assert all(packet.start <= m.sample < packet.start + len(packet.pcm) for m in packet.marks)
    samples = [m.sample for p in packets for m in p.marks]
    assert samples == sorted(samples)
    phones = marks(packets, "phone")
    assert all(a.sample + a.duration == b.sample for a, b in pairwise(phones))


def test_words_are_those_of_the_text() -> None:
    words = marks(said(TEXT), "word")
    assert [m.text for m in words] == [
        "Hello", "world", "it", "is", "late", "He", "said", "go", "home", "No", "1,234", "times",
    ]  # fmt: skip
    assert all(TEXT[m.char_start : m.char_end] == m.text for m in words)
    assert all(a.sample + a.duration <= b.sample for a, b in pairwise(words))


def test_captions_are_phrases_with_their_punctuation() -> None:
    packets = said(TEXT)
    captions = marks(packets, "caption")
    assert [m.text for m in captions] == [
        "Hello world,", 'it is "late."', "He said:", "go home!", "No 1,234 times?"
    ]  # fmt: skip
    words = marks(packets, "word")
    for caption in captions:
        inside = [w for w in words if caption.char_start <= w.char_start < caption.char_end]
        assert caption.sample == inside[0].sample
        assert caption.sample + caption.duration == inside[-1].sample + inside[-1].duration
        assert caption.char_end == inside[-1].char_end


def test_an_expression_is_marked_for_as_long_as_it_lasts() -> None:
    [mark] = marks(said(TEXT), "expression")
    assert (mark.text, mark.duration) == ("joy", 4800)


def shape(packets: list[Packet]) -> list[object]:
    return [
        (p.start, p.pcm.tobytes(), p.marks, p.hold, [(f.sample, f.values.tobytes()) for f in p.frames])
        for p in packets
    ]


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 40))
def test_fragments_of_any_size_give_the_same_packets(step: int) -> None:
    assert shape(said(TEXT, step=step)) == shape(said(TEXT))


@settings(max_examples=60, deadline=None)
@given(
    st.text(st.sampled_from("ab .,!?\"'()-\n🫨漢\x00\ud800é1αώ…\\:)"), max_size=60),
    st.sampled_from(["en", "el"]),
)
def test_no_text_loses_a_caption_or_a_word(text: str, lang: str) -> None:
    """Every phrase that has words is captioned once, and every word lies in one caption."""
    packets = said(text, lang)
    words, captions = marks(packets, "word"), marks(packets, "caption")
    for word in words:
        assert sum(c.char_start <= word.char_start < c.char_end for c in captions) == 1
    assert all(c.text and len(c.text) <= len(text) + 40 for c in captions)


def test_a_word_that_is_silent_holds_no_caption_back() -> None:
    """A phrase may begin, or be made of, something that is written but not said."""
    line = pipeline()
    line._text.add("§ one. §. two. ")
    one = Utterance(
        "en", (Phone("V", 100.0, word=1), Phone(SILENCE, 100.0)), (Word("§", 0, 1), Word("one", 2, 5))
    )
    none = Utterance("en", (Phone(SILENCE, 100.0),), (Word("§", 7, 8),))
    two = Utterance("en", (Phone("u", 100.0, word=0), Phone(SILENCE, 300.0)), (Word("two", 10, 13),))
    line._note([one, none, two])
    for speech in speeches([one, none, two]):
        line.add(speech)
    captions = marks(list(line.packets(last=True)), "caption")
    assert [(c.text, c.char_start, c.sample) for c in captions] == [("§ one.", 0, 0), ("two.", 10, 4800)]


def test_heard_char_is_the_end_of_the_last_word_begun() -> None:
    line = pipeline()
    for speech in speeches(line.feed(TEXT) + line.end()):
        line.add(speech)
    words = marks(list(line.packets(last=True)), "word")
    assert line.heard_char(0) == 0
    for i, word in enumerate(words):
        assert line.heard_char(word.sample) == word.char_end
        assert line.heard_char(word.sample - 1) == (words[i - 1].char_end if i else 0)
    assert line.heard_char(10**9) == len(TEXT) - 1


def test_hold_is_set_only_where_a_dry_turn_runs_out() -> None:
    line = pipeline()
    [first] = speeches(line.feed("Hello there. ") or [])
    line.add(first)
    packets = list(line.packets(dry=True))
    flags = [p.hold for p in packets]
    assert flags[-1]
    assert flags == sorted(flags)
    assert sum(flags) <= 3

    wet = pipeline()
    wet.add(speeches(wet.feed("Hello there. "))[0])
    assert not any(p.hold for p in wet.packets(dry=False))
    over = pipeline()
    over.add(speeches(over.feed("Hello there. "))[0])
    assert not any(p.hold for p in over.packets(dry=True, last=True))


def test_a_packet_waits_for_the_face_that_belongs_to_it() -> None:
    """Open speech: the last phones' shapes are not settled before the next is known."""
    line = pipeline(look_ahead=0)
    [open_one] = line.feed("Well now ")
    assert not open_one.closed
    [speech] = speeches([open_one])
    line.add(speech)
    early = list(line.packets())
    assert line.produced == sum(len(p.pcm) for p in early) < len(speech.pcm) - 640
    assert line.planned == len(speech.pcm)
    for rest in speeches(line.end(), start=len(speech.pcm)):
        line.add(rest)
    packets = early + list(line.packets(last=True))
    assert line.produced == line.planned == packets[-1].start + len(packets[-1].pcm)
    assert sum(len(p.frames) for p in packets) == -(-line.produced // 640)


def test_pending_words_and_hold() -> None:
    line = pipeline(look_ahead=1)
    [first] = line.feed("one two thr")
    assert [w.text for w in first.words] == ["one"]
    assert line.pending_words == 1
    assert line.speaking
    [held] = line.hold()
    assert not held.words
    assert not line.speaking
    [rest] = line.feed("ee. ")
    assert [w.text for w in rest.words] == ["two", "three"]


def test_caption_of_a_phrase_spoken_in_two_parts() -> None:
    """It grows: each part of a phrase shows what came before it as well, also over a hold."""
    line = pipeline(look_ahead=0)
    utterances = line.feed("Good morning ") + line.hold() + line.feed("everyone. ") + line.feed("Bye. ")
    for speech in speeches(utterances):
        line.add(speech)
    packets = list(line.packets(last=True))
    captions = marks(packets, "caption")
    assert [m.text for m in captions] == ["Good morning", "Good morning everyone.", "Bye."]
    assert [(m.char_start, m.char_end) for m in captions] == [(0, 12), (0, 21), (23, 26)]
    everyone = marks(packets, "word")[2]
    assert captions[1].sample == everyone.sample


def test_marks_of_the_text_and_warnings() -> None:
    packets = said("one <mark name='here'/>two <b>three.")
    [mark], [warning] = marks(packets, "mark"), marks(packets, "warning")
    words = marks(packets, "word")
    assert (mark.text, mark.sample, mark.duration) == ("here", words[1].sample, 0)
    assert (mark.char_start, mark.char_end) == (4, 23)
    assert "<b>" in warning.text


def test_a_word_whose_last_phone_comes_later_has_its_planned_length() -> None:
    """A voice keeps the last phone of an open phrase back until it knows the next."""
    line = pipeline(look_ahead=0)
    [utterance] = line.feed("morning ")
    phones = timed(utterance.phones, 16000, 0, utterance)
    line.add(Speech(0, np.zeros(phones[-2].end, np.int16), phones[:-1]))
    line.add(Speech(phones[-2].end, np.zeros(phones[-1].end - phones[-2].end, np.int16), phones[-1:]))
    line.end()
    [word] = marks(list(line.packets(last=True)), "word")
    assert word.sample + word.duration == pytest.approx(phones[-1].end, abs=2)


def test_the_sound_has_the_gain_of_its_phones() -> None:
    def loudness(text: str) -> float:
        line = pipeline()
        for u in line.feed(text):
            phones = timed(u.phones, 16000, 0, u)
            line.add(Speech(0, np.full(phones[-1].end, 1000, np.int16), phones))
        return float(np.concatenate([p.pcm for p in line.packets(last=True)]).max())

    assert loudness("one two. ") == 1000
    assert loudness("one <prosody volume='+6dB'>two</prosody>. ") == pytest.approx(1995, abs=2)


def test_text_without_words_is_not_kept_in_the_way() -> None:
    """Linear time: a megabyte that nobody can say, in small pieces."""
    line = pipeline()
    for _ in range(4000):
        line.feed("🫨" * 255 + " ")
    [spoken] = line.feed("yes. ")
    line.add(speeches([spoken])[0])
    [caption] = marks(list(line.packets(last=True)), "caption")
    assert (caption.text, caption.char_start) == ("yes.", 4000 * 256)


def test_an_empty_turn_has_no_packets() -> None:
    line = pipeline()
    assert line.end() == []
    assert list(line.packets(last=True)) == []
    assert line.planned == line.produced == line.heard_char(100) == 0


@pytest.mark.parametrize("step", [64, 5000])
def test_text_that_cannot_be_said_is_not_kept(step: int) -> None:
    line = pipeline()
    for _ in range(400):
        line.feed("🫨" * step)
    assert sum(map(len, line._text._parts)) <= UNSAID + step
    [utterance, *_] = line.feed("one two. ")
    assert [w.text for w in utterance.words] == ["one", "two"]
    for speech in speeches([utterance]):
        line.add(speech)
    [caption] = marks(list(line.packets(last=True)), "caption")
    assert caption.text.endswith("one two.")
    assert caption.char_end == 400 * step + 7


@pytest.mark.parametrize(("sample", "taken"), [(0, 5), (9_000, 40), (20_000, 60), (41_000, 0), (10**6, 10)])
def test_cut(sample: int, taken: int) -> None:
    """At the end of the word, of the pause, or of the sound; what follows is as in a turn of its own."""
    line = pipeline()
    for speech in speeches(line.feed(TEXT) + line.end()):
        line.add(speech)
    produced = line.packets()
    early = [next(produced) for _ in range(taken)]
    word = line._said.at(sample)
    end = line.planned
    t = line.cut(sample, 90)
    assert t == min(max(sample, word.end if word else 0), end)
    utterances = line.feed("New words. ") + line.end()
    for speech in speeches(utterances):
        line.add(speech)
    late = list(line.packets(last=True))
    assert [p.start for p in late] == sorted({p.start for p in late})
    assert t in [p.start for p in late]
    alone = said("New words. ")
    new = [p for p in late if p.start >= t]
    assert [len(p.pcm) for p in new] == [len(p.pcm) for p in alone]
    assert [(m.kind, m.sample - t, m.text) for p in new for m in p.marks] == [
        (m.kind, m.sample, m.text) for p in alone for m in p.marks
    ]
    assert [m.char_start for m in marks(new, "word")] == [90, 94]
    assert marks(new, "caption")[0].char_start == 90
    kept = [p for p in early if p.start + len(p.pcm) <= t] + [p for p in late if p.start < t]
    assert sum(len(p.pcm) for p in kept) >= min(t, sum(len(p.pcm) for p in early)) - 640
