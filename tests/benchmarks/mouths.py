"""Mouths to compare with measured ones: ours, of the true phone times or of our own, and what predicts well.

A mouth is three quantities, mm as if the outer corners of the eyes were 90 mm apart, at 100 Hz: how far the
inner lips are apart, how much wider the mouth is, and how much lower the chin, than on the neutral face.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fapstream.data import read_lines
from fapstream.head import Fapu
from fapstream.learn.clips import Clip
from fapstream.learn.measured import RATE
from fapstream.learn.sentences import stresses_of
from fapstream.learn.training import Filmed, speech
from fapstream.motion import Motion, hearing_mouth
from fapstream.motion.mixer import spoken
from fapstream.motion.mouths import mouth_track
from fapstream.motion.units import SIL, features
from fapstream.records import N_FAPS, SILENCE, Pcm, Phone, TimedPhone
from fapstream.tts import FrontEnd

Floats = NDArray[np.float64]

QUANTITIES = ("aperture", "width", "chin")
SAMPLE_RATE, FPS = 16000, 50
CLOSING = frozenset("BPM")
REACH = 3
"""Phones on either side that trees may look at."""
LONGEST_S = 0.3


def quantities(faps: Floats, fapu: Fapu) -> Floats:
    """Of FAPs (n, 68), shape (n, 3), mm."""
    mns, mw = fapu.mns0 / 1.024, fapu.mw0 / 1.024
    aperture = -(faps[:, 3] + faps[:, 4]) * mns
    return np.stack([aperture, (faps[:, 52] + faps[:, 53]) * mw, faps[:, 2] * mns], axis=1)


@cache
def sampa() -> dict[str, str]:
    """Our English phone for each phone of CMUdict."""
    table: dict[str, str] = {}
    for _, line in read_lines("motion", "units_en.tsv"):
        phone, units, _ = line.split("\t")
        table.setdefault(units, phone)
    return table


def heard(clip: Clip) -> list[TimedPhone]:
    """The phones of a clip when they were heard, as a voice would tell of them."""
    found = []
    for word, stresses in zip(clip.words, stresses_of(clip.words), strict=True):
        for phone, stressed in zip(word.phones, stresses, strict=True):
            name = SILENCE if word.silent else sampa()[phone.name]
            name = "@" if name == "V" and not stressed else name
            start, end = round(phone.start * SAMPLE_RATE), round(phone.end * SAMPLE_RATE)
            found.append(TimedPhone(Phone(name, 0.0, stress=int(stressed)), start, end))
    return found


def planned(clip: Clip) -> list[TimedPhone]:
    """The phones of what is said in a clip with the durations that our front-end gives them."""
    words = [word.text for word in clip.words if not word.silent]
    words = [word.upper() if len(word) == 1 else word for word in words]
    front_end = FrontEnd("en")
    found, start = [], 0.0
    for utterance in (*front_end.feed(f"{' '.join(words)}."), *front_end.end()):
        for phone in utterance.phones:
            end = start + phone.duration_ms * SAMPLE_RATE / 1000
            found.append(TimedPhone(phone, round(start), round(end)))
            start = end
    return found


def ours(phones: Sequence[TimedPhone], motion: Motion, fapu: Fapu) -> Floats:
    """What our engine makes of timed phones, to the end of the last one, shape (n, 3)."""
    track = mouth_track(motion, "en", SAMPLE_RATE, FPS)
    for phone in phones:
        track.add(phone)
    mouth = track.at(np.arange(0, phones[-1].end, SAMPLE_RATE // FPS))
    return _finer(quantities(spoken(mouth, np.zeros(N_FAPS)), fapu))


def from_sound(pcm: Pcm, fapu: Fapu) -> Floats:
    """What our engine makes of sound at SAMPLE_RATE alone, shape (n, 3)."""
    mouth = hearing_mouth(SAMPLE_RATE)
    mouth.hear(pcm)
    mouth.end()
    return _finer(quantities(mouth.at(np.arange(0, len(pcm), SAMPLE_RATE // FPS)).values, fapu))


def _finer(made: Floats) -> Floats:
    """From FPS to RATE a second."""
    t = np.arange(0, len(made) - 1, FPS / RATE)
    return np.stack([np.interp(t, np.arange(len(made)), column) for column in made.T], axis=1)


def contexts(clip: Clip, n: int) -> Floats:
    """What a regression may look at, at each of n instants: the phones around and when they are, (n,
    features)."""
    phones = [phone for word in clip.words for phone in word.phones]
    start, end = np.array([(phone.start, phone.end) for phone in phones]).T
    told = np.array([_told(phone.name) for phone in phones])
    t = np.arange(n) / RATE
    here = np.clip(np.searchsorted(start, t, side="right") - 1, 0, len(phones) - 1)
    columns = [((t - start[here]) / (end - start)[here])[:, None]]
    for k in range(-REACH, REACH + 1):
        at = np.clip(here + k, 0, len(phones) - 1)
        length = np.minimum((end - start)[at], LONGEST_S)
        columns += [told[at], (t - (start[at] + end[at]) / 2)[:, None], length[:, None]]
    return np.hstack(columns)


@cache
def _asked() -> list[str]:
    return sorted(frozenset().union(*features().values()))


def _told(phone: str) -> list[float]:
    name = SIL if phone == SIL else next(unit for unit in features() if unit.rstrip("01") == phone)
    return [float(feature in features()[name]) for feature in _asked()]


def regressed(
    fit: Callable[[Floats, Floats], Callable[[Floats], Floats]],
    inputs: Sequence[tuple[Filmed, Floats]],
    wanted: Sequence[Floats],
) -> Callable[[Floats], Floats]:
    """A regression fitted to what was measured while people spoke, `inputs` being numbers for each
    instant."""
    x = [rows[speech(filmed)] for filmed, rows in inputs]
    y = [rows[speech(filmed)] for (filmed, _), rows in zip(inputs, wanted, strict=True)]
    return fit(np.concatenate(x), np.concatenate(y))


def least_squares(x: Floats, y: Floats) -> Callable[[Floats], Floats]:
    """Linear with a constant."""
    weights, *_ = np.linalg.lstsq(np.hstack([x, np.ones((len(x), 1))]), y, rcond=None)
    return lambda rows: np.asarray(np.hstack([rows, np.ones((len(rows), 1))]) @ weights)


def apart_in_closures(filmed: Filmed, made: Floats) -> list[float]:
    """How far the lips are apart at least in each B, P and M, mm."""
    found = []
    for word in filmed.clip.words:
        for phone in word.phones:
            if phone.name in CLOSING:
                begin = int(phone.start * RATE)
                found.append(float(made[begin : max(begin + 1, round(phone.end * RATE)), 0].min()))
    return found
