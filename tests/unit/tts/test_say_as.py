"""Phones and readings that mark-up gives."""

from __future__ import annotations

import pytest

from fapstream.tts.say_as import ipa_phones, phones_of
from fapstream.tts.tables import LANGUAGES, phone_set, read_pairs


@pytest.mark.parametrize(
    ("text", "lang", "phones"),
    [
        ("t @ m A1 t @U", "en", "t @0 m A1 t @U0"),
        ("t @ m \"A t %@U", "en", "t @0 m A1 t @U2"),
        ("r=1 dZ @0 n t", "en", "r=1 dZ @0 n t"),
        ("j a0 s o1", "el", "j a0 s o1"),
        ("", "en", None),
        ("_", "en", None),
        ("t1", "en", None),
        ("zz", "en", None),
        ("1", "en", None),
    ],
)  # fmt: skip
def test_phones(text: str, lang: str, phones: str | None) -> None:
    assert phones_of(text, lang) == (tuple(phones.split()) if phones else None)


@pytest.mark.parametrize(
    ("text", "lang", "phones"),
    [
        ("təˈmeɪtoʊ", "en", "t @0 m EI1 t @U0"),
        ("ˈtʃɜːtʃ", "en", "tS r=1 tS"),
        ("ˌɪntəˈnæʃnəl", "en", "I2 n t @0 n {1 S n @0 l"),
        ("kaliˈmera", "el", "k a0 l i0 m e1 r a0"),
        ("ˈt͡sai", "el", "ts a1 i0"),
        ("ʘ", "en", None),
        ("", "el", None),
    ],
)
def test_ipa(text: str, lang: str, phones: str | None) -> None:
    assert ipa_phones(text, lang) == (tuple(phones.split()) if phones else None)


@pytest.mark.parametrize("lang", LANGUAGES)
def test_every_phone_can_be_written_in_ipa(lang: str) -> None:
    reached = {name for reading in read_pairs(f"{lang}/ipa.tsv").values() for name in reading.split()}
    assert reached == set(phone_set(lang)) - {"_"}
