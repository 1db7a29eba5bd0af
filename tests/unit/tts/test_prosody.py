"""The table of rhythm and melody, and a user's changes to it."""

from __future__ import annotations

from typing import Any

import pytest

from fapstream.errors import DataError
from fapstream.tts.prosody import Prosody, prosody, question_words, standard
from fapstream.tts.tables import LANGUAGES


@pytest.mark.parametrize("lang", LANGUAGES)
def test_every_phrase_end_has_its_tune(lang: str) -> None:
    rooms = standard(lang)
    assert {stop.tune for stop in rooms.stops.values()} <= set(rooms.melody.tunes)
    assert all(0 <= stop.reset <= 1 and stop.pause_ms >= 0 for stop in rooms.stops.values())
    assert question_words(lang)
    assert standard(lang) is rooms


def changed(changes: dict[str, Any]) -> Prosody:
    return prosody("en", changes, {})


def test_changes_count_and_the_rest_stays() -> None:
    rooms = changed({"stops": {"comma": {"pause_ms": 50, "tune": "fall"}}, "emphasis": {"gain": 0.1}})
    assert (rooms.stops["comma"].pause_ms, rooms.stops["comma"].tune) == (50.0, "fall")
    assert rooms.stops["comma"].reset == standard("en").stops["comma"].reset
    assert rooms.stops["sentence"] == standard("en").stops["sentence"]
    assert rooms.emphasis_gain == 0.1


@pytest.mark.parametrize(
    "changes",
    [
        {"stop": {}},
        {"stops": {"nonsense": {"pause_ms": 1}}},
        {"stops": 5},
        {"stops": {"comma": {"pause_ms": "long"}}},
        {"stops": {"comma": {"pause_ms": True}}},
        {"stops": {"comma": {"pause_ms": -1}}},
        {"stops": {"comma": {"tune": "nonsense"}}},
        {"melody": {"top": float("nan")}},
        {"melody": {"top": 1e30}},
        {"durations": {"en": {"vowel": {"stressed": -2}}}},
    ],
)
def test_what_is_no_entry_is_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(DataError, match="profile"):
        changed(changes)
