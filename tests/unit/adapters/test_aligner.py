"""Speech put in order: pauses between words, hours in windows, and what is refused."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest

from fapstream.adapters import aligner
from fapstream.adapters.aligner import Aligner
from fapstream.adapters.sphinx import RATE, Found, Segment
from fapstream.errors import ClipError
from fapstream.ports import Aligner as Port
from fapstream.records import Heard, Pcm
from tests.unit.adapters.test_sphinx import speech

NOISE = np.random.default_rng(0).normal(0, 3000, 4 * RATE).astype(np.int16)
HUM = (6000 * np.sin(2 * np.pi * 220 * np.arange(4 * RATE) / RATE)).astype(np.int16)
TEXT = "At 5 pm, Zorvex read the record."


@pytest.fixture(scope="module")
def real() -> Port:
    return Aligner()


def check(heard: Heard, pcm: Pcm) -> None:
    """No gaps from 0 to the end, phones within their words."""
    assert heard.words[0].start_s == 0
    assert heard.words[-1].end_s == pytest.approx(len(pcm) / RATE, abs=0.02)
    assert all(a.end_s == b.start_s for a, b in pairwise(heard.words))
    for word in heard.words:
        assert (word.phones[0].start_s, word.phones[-1].end_s) == (word.start_s, word.end_s)
        assert all(a.end_s == b.start_s and a.end_s > a.start_s for a, b in pairwise(word.phones))


async def test_a_transcript_is_read_as_it_is_spoken(real: Port) -> None:
    pcm = np.concatenate([np.zeros(RATE // 2, np.int16), await speech(TEXT), np.zeros(RATE // 2, np.int16)])
    heard = real.align(pcm, TEXT)
    check(heard, pcm)
    said = [word for word in heard.words if word.text]
    assert [w.text for w in said] == ["at", "five", "p", "m", "zorvex", "read", "the", "record"]
    assert [TEXT[w.char_start : w.char_end] for w in said[1:5]] == ["5", "pm", "pm", "Zorvex"]
    assert " ".join(p.name for p in said[5].phones) == "R EH1 D"
    assert " ".join(p.name for p in said[7].phones) == "R EH1 K ER0 D"
    assert heard.words[0].text == ""
    assert heard.words[0].phones[0].name == "SIL"
    assert 0.4 < said[0].start_s < 0.7
    assert heard.fit > aligner.LEAST_FIT
    assert heard.covered > 0.9


@pytest.mark.parametrize(
    "transcript",
    ["Rivers walked under purple mountains for other reasons.", "Zxqv brrrk pfft.", f"{TEXT} {TEXT} {TEXT}"],
)
async def test_wrong_transcripts(real: Port, transcript: str) -> None:
    with pytest.raises(ClipError, match="do not fit the sound"):
        real.align(await speech(TEXT), transcript)


async def test_a_word_may_be_wrong(real: Port) -> None:
    heard = real.align(await speech(TEXT), "At 5 pm, Zorvex read a record.")
    assert [w.text for w in heard.words if w.text][-2:] == ["a", "record"]


@pytest.mark.parametrize("transcript", ["", "  ", "?!", "..."])
def test_no_words(real: Port, transcript: str) -> None:
    with pytest.raises(ClipError, match="has no words"):
        real.align(NOISE, transcript)


@pytest.mark.parametrize("sound", [NOISE, HUM], ids=["noise", "hum"])
@pytest.mark.parametrize("transcript", ["yes", "hello world", "Γεια σου", "The company paid five million."])
def test_no_speech(real: Port, sound: Pcm, transcript: str) -> None:
    with pytest.raises(ClipError, match="do not fit the sound"):
        real.align(sound, transcript)


@pytest.mark.parametrize("sound", [NOISE, HUM], ids=["noise", "hum"])
def test_no_words_in_the_sound(real: Port, sound: Pcm) -> None:
    with pytest.raises(ClipError, match="no words can be understood"):
        real.recognise(sound)


@pytest.mark.parametrize(
    ("pcm", "reason"),
    [
        (np.zeros(4 * RATE, np.int16), "silent"),
        (np.r_[np.zeros(RATE, np.int16), np.full(50, 20_000, np.int16)], "silent"),
        (np.zeros(0, np.int16), "0.00 s"),
        (NOISE[: RATE // 20], "0.05 s; 0.2 s are the least"),
        (np.zeros((RATE, 2), np.int16), "mono"),
        (np.full(RATE, np.nan), "int16"),
    ],
    ids=["silence", "click", "nothing", "short", "stereo", "no numbers"],
)
def test_no_sound(real: Port, pcm: Pcm, reason: str) -> None:
    for use in (lambda: real.align(pcm, "hello"), lambda: real.recognise(pcm)):
        with pytest.raises(ClipError, match=reason):
            use()


async def test_recognition_has_times_and_a_text(real: Port) -> None:
    pcm = await speech("The company paid five million dollars.")
    heard = real.recognise(pcm)
    check(heard, pcm)
    for word in heard.words:
        assert word.text == (heard.text[word.char_start : word.char_end] if word.text else "")
    assert any(p.name[-1] == "1" for word in heard.words for p in word.phones)


# long sound, with a decoder that knows when each word is said


class Told:
    """A decoder that finds word k at k seconds, for 0.5 s; the sound tells where a piece is from."""

    def __init__(self) -> None:
        self.longest = 0.0
        self.fit = -1.0

    def name(self, word: str, readings: object) -> str:
        return word

    def align(self, pcm: Pcm, words: Sequence[str], open_end: bool = False) -> list[Segment] | None:
        length = len(pcm) / RATE
        self.longest = max(self.longest, length)
        start = int(pcm[0]) / 10
        found, at = [], 0.0
        for k in range(int(np.ceil(start)), int(start + length) + 1):
            if k - start + 0.5 > length or k - int(np.ceil(start)) >= len(words):
                break
            found.append(_segment("", at, k - start, self.fit))
            found.append(_segment(words[k - int(np.ceil(start))], k - start, k - start + 0.5, self.fit))
            at = k - start + 0.5
        said = sum(bool(s.name) for s in found)
        return [s for s in found if s.phones] if open_end or said == len(words) else None


def _segment(name: str, start: float, end: float, fit: float) -> Segment:
    return Segment(name, (Found("AA" if name else "SIL", start, end, fit),) if end > start else ())


def clock(seconds: int) -> Pcm:
    """Sound whose samples are tenths of seconds from its beginning."""
    return (np.arange(seconds * RATE) * 10 // RATE).astype(np.int16)


@pytest.fixture
def told(monkeypatch: pytest.MonkeyPatch) -> Told:
    made = Told()
    monkeypatch.setattr(aligner, "Sphinx", lambda: made)
    monkeypatch.setattr(aligner, "LEAST_COVERED", 0.0)
    return made


@pytest.mark.parametrize("seconds", [40, 46, 100, 600])
def test_windows_leave_no_word_out_and_move_none(told: Told, seconds: int) -> None:
    text = "word " * seconds
    heard = Aligner().align(clock(seconds), text)
    said = [word for word in heard.words if word.text]
    assert len(said) == seconds
    assert [w.start_s for w in said] == pytest.approx(range(seconds), abs=0.11)
    assert [w.char_start for w in said] == [5 * k for k in range(seconds)]
    assert told.longest <= aligner.LAST_WINDOW_S


@pytest.mark.parametrize("words", [80, 130, 5000])
def test_a_text_that_ends_too_early_or_too_late(told: Told, words: int) -> None:
    if words > 100:
        with pytest.raises(ClipError, match=r"do not fit the sound after \d+ s"):
            Aligner().align(clock(100), "word " * words)
        return
    heard = Aligner().align(clock(100), "word " * words)
    assert heard.words[-1].text == ""
    assert heard.words[-1].end_s == 100


def test_a_window_that_does_not_fit_ends_it(told: Told) -> None:
    told.fit = -9.0
    with pytest.raises(ClipError, match="do not fit"):
        Aligner().align(clock(600), "word " * 600)
    assert told.longest <= 30


def test_words_must_take_up_the_loud_part(told: Told, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(aligner, "LEAST_COVERED", 0.9)
    with pytest.raises(ClipError, match=r"\d+% of what is heard is none of them"):
        Aligner().align(clock(40), "word " * 40)
