"""The pitch contour."""

from __future__ import annotations

import tomllib
from itertools import pairwise

import pytest

from fapstream.tts.durations import DurationModel, Segment
from fapstream.tts.melody import MelodyModel, MelodyState, share
from fapstream.tts.tables import read_text

PROSODY = tomllib.loads(read_text("prosody.toml"))
MODEL = MelodyModel(PROSODY["melody"], PROSODY["tunes"])
WORDS = ["k a0 l i0 m e1 r a0", "k o1 z m e0", "t i1 l e0", "m u0"]


def segments(*words: str) -> list[Segment]:
    model = DurationModel("el", PROSODY["durations"]["el"])
    found = model.segments([tuple(w.split()) for w in words], [False] * len(words))
    model.assign(found, 1.0, True)
    return found


def contour(tune: str, *words: str) -> list[tuple[float, float]]:
    return MODEL.contour(segments(*(words or WORDS)), tune, MelodyState())


@pytest.mark.parametrize("tune", sorted(PROSODY["tunes"]))
def test_times_ascend_and_values_are_sane(tune: str) -> None:
    points = contour(tune)
    assert all(a[0] < b[0] for a, b in pairwise(points))
    assert all(0.6 < f < 1.7 for _, f in points)
    assert points[-1][0] == pytest.approx(sum(s.ms for s in segments(*WORDS)))


def test_endings() -> None:
    end = {tune: contour(tune)[-1][1] for tune in PROSODY["tunes"]}
    assert end["fall"] < end["low"] < end["open"] < end["continuation"] < end["rise"]


def test_an_accent_on_each_stressed_syllable() -> None:
    points = contour("fall")
    peaks = [b for a, b, c in zip(points, points[1:], points[2:], strict=False) if a[1] < b[1] > c[1]]
    assert len(peaks) == 3
    assert peaks[0][1] > peaks[1][1]


def test_declination_goes_on_in_the_next_piece() -> None:
    state = MelodyState()
    first = MODEL.contour(segments(*WORDS[:2]), "open", state)
    second = MODEL.contour(segments(*WORDS[2:]), "fall", state)
    assert second[0] == (0.0, first[-1][1])
    assert state.elapsed_ms == pytest.approx(first[-1][0] + second[-1][0])
    assert first[0][1] > first[-1][1] > second[-1][1]


def test_share_cuts_at_the_borders() -> None:
    found = segments("t a1")
    points = [
        (0.0, 1.0),
        (found[0].ms, 1.2),
        (found[0].ms + found[1].ms / 2, 1.4),
        (found[0].ms + found[1].ms, 1.0),
    ]
    first, second = share(points, found, 100.0)
    assert first == ((0.0, 100.0),)
    assert [p for p, _ in second] == pytest.approx([0.0, 50.0, 100.0])
    assert [hz for _, hz in second] == pytest.approx([120.0, 140.0, 100.0])


def test_nothing_to_say() -> None:
    assert share(MODEL.contour([], "fall", MelodyState()), [], 100.0) == []
