"""PocketSphinx at work on what eSpeak NG says: phones in order, variants as they are said, words it lacks."""

from __future__ import annotations

import sys
from itertools import pairwise

import numpy as np
import pytest
from scipy.signal import resample_poly

from fapstream.adapters.espeak import EspeakPool
from fapstream.adapters.sound_file import SpeechUnavailable
from fapstream.adapters.sphinx import RATE, Segment, Sphinx
from fapstream.records import Pcm
from fapstream.tts import FrontEnd
from fapstream.tts.voices import voice


async def speech(text: str) -> Pcm:
    """int16 (n,), 16 kHz."""
    pool = EspeakPool()
    try:
        synthesizer = await pool.acquire(voice("espeak-en"))
        front = FrontEnd("en")
        for utterance in front.feed(text) + front.end():
            await synthesizer.write(utterance)
        await synthesizer.finish()
        pcm = np.concatenate([part.pcm async for part in synthesizer.speech()])
        return resample_poly(pcm.astype(float), RATE, synthesizer.sample_rate).astype(np.int16)
    finally:
        await pool.aclose()


@pytest.fixture(scope="module")
def sphinx() -> Sphinx:
    return Sphinx()


def names(found: list[Segment] | None) -> list[str]:
    assert found is not None
    return [segment.name for segment in found if segment.name]


async def test_words_and_phones_follow_each_other_without_gaps(sphinx: Sphinx) -> None:
    pcm = await speech("The rivers are cold.")
    found = sphinx.align(pcm, ["the", "rivers", "are", "cold"])
    assert names(found) == ["the", "rivers", "are", "cold"]
    assert found is not None
    phones = [phone for segment in found for phone in segment.phones]
    assert phones[0].start_s == 0
    assert len(pcm) / RATE - 0.05 < phones[-1].end_s <= len(pcm) / RATE
    assert all(a.end_s == b.start_s for a, b in pairwise(phones))
    assert [p.name for s in found if s.name == "rivers" for p in s.phones] == ["R", "IH", "V", "ER", "Z"]
    assert all(phone.fit <= 0.5 for phone in phones)
    assert sphinx.align(pcm, ["the", "rivers", "are", "cold"]) == found, "the decoder remembers"


@pytest.mark.parametrize(("text", "vowel"), [("They want to read.", "IY"), ("They had read.", "EH")])
async def test_the_variant_that_is_said_is_chosen(sphinx: Sphinx, text: str, vowel: str) -> None:
    words = text.lower().strip(".").split()
    found = sphinx.align(await speech(text), words)
    assert found is not None
    assert [[p.name for p in s.phones] for s in found if s.name == "read"] == [["R", vowel, "D"]]


async def test_words_that_the_dictionary_lacks(sphinx: Sphinx) -> None:
    name = sphinx.name("zorvex", (("Z", "AO1", "R", "V", "EH2", "K", "S"),))
    found = sphinx.align(await speech("They met Zorvex."), ["they", "met", name])
    assert found is not None
    assert [[p.name for p in s.phones] for s in found if s.name == name] == [
        ["Z", "AO", "R", "V", "EH", "K", "S"]
    ]
    assert sphinx.name("", (("Y", "AA1"),)) == sphinx.name("", (("Y", "AA1"),))
    assert sphinx.name("<sil>", (("S", "IH1", "L"),)) not in ("<sil>", "")


async def test_an_open_end_takes_the_words_that_are_there(sphinx: Sphinx) -> None:
    pcm = await speech("The rivers are cold.")
    words = ["the", "rivers", "are", "cold", "and", "people", "walked", "along", "roads", "at", "night"]
    assert names(sphinx.align(pcm, words, open_end=True)) == words[:4]
    assert sphinx.align(pcm, words * 2) is None, "too many words are aligned"


def test_an_open_end_may_have_no_words(sphinx: Sphinx) -> None:
    noise = np.random.default_rng(0).normal(0, 500, 3 * RATE).astype(np.int16)
    assert names(sphinx.align(noise, ["the", "rivers", "are", "cold"], open_end=True)) == []


def test_recognition_says_nothing_of_noise_and_words_of_speech(sphinx: Sphinx) -> None:
    noise = np.random.default_rng(0).normal(0, 500, 3 * RATE).astype(np.int16)
    assert sphinx.recognise(noise) == []


async def test_recognition(sphinx: Sphinx) -> None:
    """This voice is hardly understood; tests/e2e/test_align.py has better ones."""
    heard = sphinx.recognise(await speech("The company paid five million dollars."))
    assert heard[0] == "the"
    assert all(word.replace("'", "").replace(".", "").isalpha() for word in heard)


def test_without_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pocketsphinx", None)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(SpeechUnavailable, match=r"fapstream\[speech\]"):
        Sphinx()
