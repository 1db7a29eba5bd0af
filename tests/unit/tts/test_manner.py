"""What a user asks for: lexicon and profile."""

from __future__ import annotations

from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fapstream.errors import DataError
from fapstream.tts.frontend import FrontEnd
from fapstream.tts.manner import Manner, read_lexicon, read_profile
from fapstream.tts.voices import voice


def test_a_lexicon() -> None:
    found = read_lexicon('; mine\nfapstream\tf { p\nGIF\tdZ I1 f\nSQL\t"sequel"\n', "f", "en")
    assert found == {"fapstream": (("f", "{0", "p"),), "gif": (("dZ", "I1", "f"),), "sql": ("sequel",)}


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("word", "a tab"),
        ("two words\tt", "one word"),
        ("word\tt q9", "are not phones"),
        ("word\t_", "are not phones"),
        ("word\tt2 i", "are not phones"),
        ('word\t"a 5"', "made of words"),
        ("\tt", "one word"),
    ],
)
def test_bad_lines_are_named(line: str, reason: str) -> None:
    with pytest.raises(DataError, match=reason) as caught:
        read_lexicon(f"good\tg U1 d\n{line}\n", "my.tsv", "en")
    assert (caught.value.path, caught.value.line) == ("my.tsv", 2)


@given(st.text(max_size=100))
def test_any_text_is_a_lexicon_or_a_typed_error(text: str) -> None:
    with suppress(DataError):
        read_lexicon(text, "f", "el")


PROFILE = """
rate = 1.2
pitch = 0.9
volume = 0.5
[phones.en]
s = 140
[stops.comma]
pause_ms = 90
"""


def test_a_profile_is_heard() -> None:
    manner = read_profile(PROFILE, "p.toml", Manner())
    assert (manner.rate, manner.pitch, manner.volume) == (1.2, 0.9, 0.5)
    own = FrontEnd("en", manner).feed("Yes, ")[0].phones
    plain = FrontEnd("en").feed("Yes, ")[0].phones
    assert [p.name for p in own] == [p.name for p in plain]
    by_name = {p.name: (p, q) for p, q in zip(own, plain, strict=True)}
    assert by_name["s"][0].duration_ms > by_name["s"][1].duration_ms
    assert by_name["E"][0].duration_ms == pytest.approx(by_name["E"][1].duration_ms / 1.2)
    assert own[1].pitch[0][1] < plain[1].pitch[0][1]
    assert {p.gain for p in own if p.word >= 0} == {0.5}
    assert own[-1].duration_ms == 100.0, "the shortest pause"


@pytest.mark.parametrize(
    "text",
    [
        "rate = 'fast'",
        "rate = 9",
        "rate = true",
        "nonsense = 1",
        "rate = ",
        "[phones.fr]\na = 1",
        "[phones.en]\nq = 90",
        "[phones.en]\ns = 5000",
        "stops = 3",
        "[phones]\nen = 5",
        "[phones.en]\ns = 'x'",
    ],
)
def test_bad_profiles(text: str) -> None:
    with pytest.raises(DataError):
        read_profile(text, "p.toml", Manner())


def test_the_manner_of_a_voice() -> None:
    us1 = voice("us1")
    manner = Manner(rate=2.0).of(us1)
    assert (manner.rate, manner.f0_hz) == (2.0, us1.f0_hz)
    assert manner.range_hz == us1.f0_range_hz[1] - us1.f0_range_hz[0]
