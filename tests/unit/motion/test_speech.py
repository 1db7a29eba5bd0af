"""Every mouth answers what a mouth is asked."""

from __future__ import annotations

import pytest

from fapstream.motion.mouths import MODELS, Model, Motion, mouth_track
from fapstream.motion.speech import MouthTrack, Speaking


@pytest.mark.parametrize("model", MODELS)
def test_every_mouth_is_a_mouth_track(model: Model) -> None:
    mouth = mouth_track(Motion(model), "en", 16000, 25)
    asked = [name for name in vars(MouthTrack) if not name.startswith("_")]
    assert asked == ["add", "ready_until", "settled_until", "at", "rest_until"]
    assert all(callable(getattr(mouth, name)) for name in asked)


def test_a_turn_begins_at_its_first_sample_and_moves_as_the_model_has_it() -> None:
    speaking = Speaking("el", 22050)
    assert (speaking.start, speaking.gain) == (0, 1.0)
