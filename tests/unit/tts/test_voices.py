"""The voices' tables."""

from __future__ import annotations

import pytest

from fapstream.errors import UnknownLanguage, UnknownVoice
from fapstream.records import SILENCE
from fapstream.tts.tables import LANGUAGES, phone_set
from fapstream.tts.voices import Voice, default_voice, phone_codes, voice, voices

MBROLA = [v for v in voices() if v.engine == "mbrola"]


def test_the_voices() -> None:
    assert [v.name for v in voices()] == [
        "us1", "us2", "us3", "en1", "gr1", "gr2", "espeak-en", "espeak-el",
    ]  # fmt: skip
    assert default_voice("el").lang == "el"
    assert default_voice("en", "espeak").engine == "espeak"


@pytest.mark.parametrize("v", MBROLA, ids=lambda v: v.name)
def test_a_database_is_described_consistently(v: Voice) -> None:
    assert {SILENCE} < v.inventory
    assert set(v.missing) <= v.inventory
    assert set().union(*v.missing.values()) <= v.inventory if v.missing else True
    assert set(v.stand_ins) <= v.inventory
    for others in v.stand_ins.values():
        assert set(others) <= v.inventory
    for name in phone_set(v.lang):
        assert set(v.phones.get(name, (name,))) <= v.inventory
    assert v.period in (90, 130, 140, 160)
    assert v.f0_range_hz[0] < v.f0_hz < v.f0_range_hz[1]


@pytest.mark.parametrize(
    ("name", "count"), [("us1", 0), ("en1", 0), ("us2", 50), ("gr1", 154), ("gr2", 288), ("us3", 678)]
)
def test_as_many_diphones_are_missing_as_were_measured(name: str, count: int) -> None:
    assert sum(len(rights) for rights in voice(name).missing.values()) == count


def test_unknown_names() -> None:
    with pytest.raises(UnknownVoice) as caught:
        voice("hal")
    assert "us1" in caught.value.known
    with pytest.raises(UnknownLanguage):
        default_voice("xx")


@pytest.mark.parametrize("lang", LANGUAGES)
def test_codes_are_distinct_characters(lang: str) -> None:
    codes = phone_codes(lang)
    assert len(set(codes.values())) == len(codes)
    assert all(len(c) == 1 for c in codes.values())


def test_where_boundaries_are_heard() -> None:
    gr2 = voice("gr2")
    assert gr2.heard_shift("a", "t") == round(-0.015 * 22050)
    assert gr2.heard_shift("p", "a") == round(-0.020 * 22050)
    assert gr2.heard_shift("a", "s") == gr2.heard_shift("_", "a") == 0
    assert voice("us1").heard_shift("A", "t") == 0
