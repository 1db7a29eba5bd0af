"""Which mouths there are."""

from __future__ import annotations

import pytest

from fapstream.errors import InputError
from fapstream.motion.keyframed import KeyframedMouth
from fapstream.motion.learned import LearnedMouth
from fapstream.motion.mouths import DEFAULT_MODEL, GAINS, MODELS, Motion, UnknownMotion, learned, mouth_track


def test_each_model_has_its_mouth() -> None:
    kinds = {model: type(mouth_track(Motion(model), "en", 16000, 25)) for model in MODELS}
    assert kinds == {"keyframes": KeyframedMouth, "ohman": LearnedMouth, "hmm": LearnedMouth}
    assert Motion().model == DEFAULT_MODEL == "hmm"


def test_turns_share_what_was_learned() -> None:
    assert learned("hmm") is learned("hmm")


def test_there_is_no_other_model() -> None:
    with pytest.raises(UnknownMotion, match="keyframes, ohman, hmm"):
        Motion("dnn")  # type: ignore[arg-type]


@pytest.mark.parametrize("gain", [0.0, GAINS[1] + 0.1, float("nan"), float("inf")])
def test_a_gain_is_bounded(gain: float) -> None:
    with pytest.raises(InputError, match="articulation"):
        Motion(gain=gain)
