"""Gain on the sound of phones."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.records import SILENCE, Pcm, Phone, TimedPhone
from fapstream.stream import Loudness
from fapstream.stream.loudness import FULL, KNEE, RAMP_MS

RATE = 16000
RAMP = round(RAMP_MS * RATE / 1000)


def timed(*phones: tuple[str, int, float]) -> list[TimedPhone]:
    """(name, samples, gain), one after the other."""
    out, at = [], 0
    for name, n, gain in phones:
        word = -1 if name == SILENCE else 0
        out.append(TimedPhone(Phone(name, n / 16, word=word, gain=gain), at, at + n))
        at += n
    return out


def applied(phones: list[TimedPhone], pcm: Pcm, step: int) -> Pcm:
    loudness, out, waiting = Loudness(RATE), [], list(phones)
    for at in range(0, len(pcm), step):
        while waiting and waiting[0].start < at + step:
            loudness.add([waiting.pop(0)])
        out.append(loudness.apply(at, pcm[at : at + step]))
    return np.concatenate(out)


def test_what_nobody_changed_is_the_same_array() -> None:
    loudness = Loudness(RATE)
    loudness.add(timed(("a", 800, 1.0), (SILENCE, 800, 1.0)))
    pcm = np.arange(1600, dtype=np.int16)
    assert loudness.apply(0, pcm) is pcm


@pytest.mark.parametrize("step", [7, 640, 6400])
def test_each_phone_has_its_gain_after_a_short_ramp(step: int) -> None:
    phones = timed(("a", 1600, 1.0), ("m", 1600, 0.5), (SILENCE, 800, 1.0), ("a", 1600, 2.0), ("a", 800, 1.0))
    got = applied(phones, np.full(6400, 1000, np.int16), step)
    assert (got[:1600] == 1000).all()
    ramp = got[1600 : 1600 + RAMP]
    assert (np.diff(ramp) <= 0).all()
    assert (got[1600 + RAMP : 4000] == 500).all(), "a pause keeps the gain before it"
    assert (got[4000 + RAMP : 5600] == 2000).all()
    assert (got[5600 + RAMP :] == 1000).all()


def test_what_would_clip_is_bent() -> None:
    tone = (20_000 * np.sin(np.arange(1600) / 5)).astype(np.int16)
    got = applied(timed(("a", 1600, 2.0)), tone, 1600)[RAMP:]
    assert KNEE < np.abs(got.astype(int)).max() <= FULL
    ordered = np.argsort(tone[RAMP:], kind="stable")
    assert (np.diff(got[ordered].astype(int)) >= 0).all(), "louder stays louder"


def test_silence_by_volume_zero() -> None:
    got = applied(timed(("a", 1600, 0.0)), np.full(1600, 9000, np.int16), 400)
    assert not got[RAMP:].any()
