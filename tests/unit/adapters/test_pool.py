"""Finding voices by wish, whatever this machine has."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from fapstream.adapters import pool as module
from fapstream.adapters.espeak import EspeakSynthesizer
from fapstream.adapters.mbrola import MbrolaSynthesizer
from fapstream.adapters.pool import VoicePool
from fapstream.errors import UnknownLanguage, UnknownVoice, VoiceUnavailable
from fapstream.tts import LANGUAGES
from fapstream.tts.voices import Voice, default_voice, voice, voices

Have = Callable[[str], VoicePool]


@pytest.fixture
def having(monkeypatch: pytest.MonkeyPatch) -> Have:
    """A pool on a machine that has just these voices."""

    def make(names: str) -> VoicePool:
        monkeypatch.setattr(module, "installed", lambda v: v.name in names.split())
        return VoicePool()

    return make


ALL = " ".join(v.name for v in voices())


@pytest.mark.parametrize("lang", LANGUAGES)
def test_a_language_is_read_by_its_preferred_voice(having: Have, lang: str) -> None:
    pool = having(ALL)
    assert pool.find(None, lang) == default_voice(lang)
    assert next(v for v in pool.all() if v.lang == lang) == default_voice(lang)


def test_no_wish_is_the_first_language(having: Have) -> None:
    assert having(ALL).find(None, None) == default_voice(LANGUAGES[0])


@pytest.mark.parametrize(("lang", "code"), [("en-GB", "en"), ("EL", "el"), ("el-GR", "el")])
def test_regions_and_capitals_do_not_matter(having: Have, lang: str, code: str) -> None:
    assert having(ALL).find(None, lang).lang == code


def test_another_voice_serves_where_the_preferred_one_is_missing(having: Have) -> None:
    assert having("gr1 espeak-el").find(None, "el").name == "gr1"
    assert having("us1 espeak-el espeak-en").find(None, "el").name == "espeak-el"


def test_a_name_is_taken_at_its_word(having: Have) -> None:
    pool = having("us1 gr2")
    assert pool.find("gr2", None) == voice("gr2")
    with pytest.raises(UnknownVoice) as caught:
        pool.find("nobody", "en")
    assert caught.value.name == "nobody"
    with pytest.raises(VoiceUnavailable, match="us2"):
        pool.find("us2", None)


@pytest.mark.parametrize("lang", ["xx", "english", "\x00", "e"])
def test_an_unknown_language(having: Have, lang: str) -> None:
    with pytest.raises(UnknownLanguage):
        having(ALL).find(None, lang)


def test_no_voice_at_all(having: Have) -> None:
    pool = having("us1")
    with pytest.raises(VoiceUnavailable, match=r"'el'.*install"):
        pool.find(None, "el")
    assert pool.all() == (voice("us1"),)


def first(engine: str) -> Voice:
    found = [v for v in voices() if v.engine == engine and module.installed(v)]
    if not found:
        pytest.skip(f"no {engine} voice on this machine")
    return found[0]


@pytest.mark.parametrize(("engine", "kind"), [("mbrola", MbrolaSynthesizer), ("espeak", EspeakSynthesizer)])
async def test_voices_are_handed_out_ready(engine: str, kind: type) -> None:
    pool, chosen = VoicePool(), first(engine)
    await pool.warm(chosen)
    synthesizer = await pool.acquire(chosen)
    assert isinstance(synthesizer, kind)
    assert synthesizer.sample_rate == chosen.sample_rate
    await synthesizer.aclose()
    await pool.aclose()
