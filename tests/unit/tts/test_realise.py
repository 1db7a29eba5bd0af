"""Language phones to voice phones."""

from __future__ import annotations

from itertools import pairwise, product

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.records import SILENCE, Phone
from fapstream.tts.realise import Join, VoicePhone, lengths, realise
from fapstream.tts.tables import phone_set
from fapstream.tts.voices import Voice, voice, voices

MBROLA = [v for v in voices() if v.engine == "mbrola"]


def phones_of(lang: str) -> list[Phone]:
    return [
        Phone(name, 80.0, stress=stress)
        for name, info in phone_set(lang).items()
        for stress in ((0, 1, 2) if info.kind == "vowel" else (0,))
    ]


def check(found: list[VoicePhone], v: Voice, previous: str) -> None:
    """Every join exists, also with the phone before and with a silence after."""
    for left, right in pairwise([previous, *(p.name for p in found), SILENCE]):
        assert right in v.inventory
        assert v.joins(left, right), (v.name, left, right)
    for p in found:
        assert p.n_samples > 0
        assert sum(samples for _, samples in p.parts) == p.n_samples
        assert p.pitch


@pytest.mark.parametrize("v", MBROLA, ids=lambda v: v.name)
def test_no_missing_diphone_over_all_pairs(v: Voice) -> None:
    """Every pair of language phones, within an utterance and across a join of two."""
    every = phones_of(v.lang)
    ends = {phone: realise([phone], v)[-1].name for phone in every}
    for left, right in product(every, every):
        check(realise([left, right], v), v, SILENCE)
        check(realise([right], v, Join(ends[left])), v, ends[left])


@given(st.data())
def test_any_phones_keep_their_boundaries(data: st.DataObject) -> None:
    v = data.draw(st.sampled_from(MBROLA))
    every = phones_of(v.lang)
    chosen = data.draw(st.lists(st.sampled_from(every), max_size=12))
    times = data.draw(st.lists(st.floats(0, 20_000), min_size=len(chosen), max_size=len(chosen)))
    phones = [Phone(p.name, ms, stress=p.stress) for p, ms in zip(chosen, times, strict=True)]
    found = realise(phones, v)
    check(found, v, SILENCE)
    own, at, total = lengths(found, len(phones)), 0, 0.0
    for phone, samples in zip(phones, own, strict=True):
        at += samples
        total += phone.duration_ms
        assert at == round(total * v.sample_rate / 1000.0)
    for p in found:
        assert p.n_samples <= (14 if p.name == SILENCE else 9) * v.sample_rate


def names(v: str, *phones: str) -> str:
    def phone(text: str) -> Phone:
        digit = text[-1] if text[-1] in "012" else ""
        return Phone(text.removesuffix(digit) if digit else text, 80.0, stress=int(digit or 0))

    return " ".join(p.name for p in realise([phone(p) for p in phones], voice(v)))


@pytest.mark.parametrize(
    ("v", "phones", "expected"),
    [
        ("us1", "t A1 p", "t_h A p"),
        ("us1", "s t A1 p", "s t A p"),
        ("us1", "l EI1 t r=0", "l EI 4 r="),
        ("us2", "s O1 r t", "s Or r t"),
        ("us3", "s I1 N N", "s I N n"),
        ("en1", "n I1 r _", "n I@ _"),
        ("en1", "n I1 r I0 N", "n I@ r I N"),
        ("en1", "k A1 r _", "k A: _"),
        ("en1", "b r=1 d r=0 _", "b 3: d @ _"),
        ("gr1", "p e0 D j a1", "p e D j a"),
        ("gr1", "j a1", "jj a"),
        ("gr1", "k i1", "c i"),
        ("gr1", "dz a1 J a0", "tz a n j a"),
        ("gr2", "k s e1 r o0", "X e r o"),
        ("gr2", "t r o0 p i1", "t R o p i"),
        ("gr2", "m J a1", "M a"),
        ("gr2", "a1 N g a0", "a V g a"),
        ("gr2", "C k", "x k"),
    ],
)
def test_allophones(v: str, phones: str, expected: str) -> None:
    assert names(v, *phones.split()) == expected


def test_merged_phones_know_whose_samples_they_are() -> None:
    (merged,) = realise([Phone("k", 100.0), Phone("s", 50.0)], voice("gr2"))
    assert merged.name == "X"
    assert merged.parts == ((0, 2205), (1, round(150 * 22.05) - 2205))


def test_a_divided_phone_keeps_its_length() -> None:
    found = realise([Phone("J", 100.0), Phone("a", 100.0)], voice("gr1"))
    assert [(p.name, p.n_samples) for p in found] == [("n", 800), ("j", 800), ("a", 1600)]
    assert lengths(found, 2) == [1600, 1600]


def test_long_silences_are_divided() -> None:
    found = realise([Phone(SILENCE, 30_000.0)], voice("us1"))
    assert [p.n_samples for p in found] == [14 * 16000, 14 * 16000, 2 * 16000]


def test_pitch_goes_where_it_was_planned() -> None:
    phones = [
        Phone("a", 100.0, ((0.0, 100.0), (50.0, 140.0))),
        Phone("m", 100.0, ((0.0, 120.0),)),
        Phone("_", 100.0),
    ]
    a, m, silence = realise(phones, voice("gr1"))
    assert a.pitch == ((0.0, 100.0), (50.0, 140.0))
    assert m.pitch == ((0.0, 120.0),)
    assert silence.pitch == ((0.0, 120.0),)
    bare = realise([Phone("a", 100.0)], voice("gr1"))
    assert bare[0].pitch == ((0.0, voice("gr1").f0_hz),)


def test_nothing() -> None:
    assert realise([], voice("us1")) == []
