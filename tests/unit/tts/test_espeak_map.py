"""Phones in eSpeak NG's notation."""

from __future__ import annotations

import pytest

from fapstream.records import Phone
from fapstream.tts import espeak_map
from fapstream.tts.frontend import FrontEnd
from fapstream.tts.tables import phone_set
from fapstream.tts.voices import default_voice


@pytest.mark.parametrize(
    ("lang", "text", "expected"),
    [
        ("en", "Hello, bird", ["[[h|@|l|'oU]]", "[[b|'3:|d]]"]),
        ("en", "better shop", ["[[b|'E|t|3 S|'A:|p]]"]),
        ("el", "Γεια σου άγγελε", ["[[j|'a s|u 'a|N|J|e|l|e]]"]),
    ],
)
def test_text(lang: str, text: str, expected: list[str]) -> None:
    front, v = FrontEnd(lang), default_voice(lang, "espeak")
    utterances = front.feed(text) + front.end()
    assert [espeak_map.bracketed(u.phones, v) for u in utterances] == expected


@pytest.mark.parametrize("lang", ["en", "el"])
def test_one_mnemonic_per_phone_whatever_the_neighbours(lang: str) -> None:
    v = default_voice(lang, "espeak")
    phones = [Phone(name, 80.0, stress=s) for name in phone_set(lang) for s in (0, 1, 2)]
    found = espeak_map.mnemonics(phones, v)
    assert len(found) == len(phones)
    assert all(bool(m) == (p.name != "_") for p, m in zip(phones, found, strict=True))


def test_only_silence() -> None:
    assert espeak_map.bracketed([Phone("_", 100.0)], default_voice("en", "espeak")) == ""
