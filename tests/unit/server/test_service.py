"""What connections share says how turns are read."""

from __future__ import annotations

from fapstream.server.service import Service
from fapstream.tts import DEFAULT_LOOK_AHEAD
from tests.unit.fakes import FakeVoices, LoopClock


def test_turns_wait_for_as_many_words_as_is_usual() -> None:
    assert Service(FakeVoices(), LoopClock(), tuple).manner.look_ahead == DEFAULT_LOOK_AHEAD
