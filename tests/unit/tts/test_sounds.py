"""Tokens as the rhythm rules see them, and syllables."""

from __future__ import annotations

from itertools import pairwise

import pytest

from fapstream.tts.sounds import onsets, sounds, syllables
from fapstream.tts.tables import LANGUAGES, phone_set


def split(lang: str, text: str) -> str:
    names = text.split()
    vowels = [phone_set(lang)[n].kind == "vowel" for n in names]
    starts = [*syllables(names, vowels, lang), len(names)]
    return ".".join("".join(names[a:b]) for a, b in pairwise(starts))


@pytest.mark.parametrize(
    ("lang", "word", "syllables"),
    [
        ("en", "p l { n I t", "pl{.nIt"),
        ("en", "E k s t r @", "Ek.str@"),
        ("en", "{ t l @ s", "{t.l@s"),
        ("en", "s t r E N T", "strENT"),
        ("en", "r I @ l i", "rI.@.li"),
        ("en", "s t", "st"),
        ("el", "k a l i m e r a", "ka.li.me.ra"),
        ("el", "a n T r o p o s", "an.Tro.pos"),
        ("el", "p e r p a t a o", "per.pa.ta.o"),
        ("el", "e k s e l i k s i", "e.kse.li.ksi"),
        ("el", "a s t r o", "a.stro"),
    ],
)
def test_syllables_take_as_many_consonants_as_can_begin_one(lang: str, word: str, syllables: str) -> None:
    assert split(lang, word) == syllables


@pytest.mark.parametrize("lang", LANGUAGES)
def test_onsets_are_of_the_language(lang: str) -> None:
    consonants = {n for n, p in phone_set(lang).items() if p.kind not in ("vowel", "silence")}
    assert {name for pair in onsets(lang) for name in pair} <= consonants


@pytest.mark.parametrize("lang", LANGUAGES)
def test_every_token_and_a_users_means(lang: str) -> None:
    own, changed = sounds(lang, {}), sounds(lang, {"s": 300.0, "m": 5.0})
    assert set(own) == {
        n + d for n, p in phone_set(lang).items() for d in (("0", "1", "2") if p.kind == "vowel" else ("",))
    }
    assert own["i1"].stress == 1
    assert own["i1"].vowel
    assert own["s"].min_ms + own["s"].span_ms == phone_set(lang)["s"].mean_ms
    assert changed["s"].min_ms + changed["s"].span_ms == 300.0
    assert (changed["m"].min_ms, changed["m"].span_ms) == (5.0, 0.0)
    assert changed["t"] == own["t"]
