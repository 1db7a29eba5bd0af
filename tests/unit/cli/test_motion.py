"""--motion and --articulation."""

from __future__ import annotations

import argparse

import pytest

from fapstream.cli.motion import add_motion, motion
from fapstream.motion import Motion


def asked(*options: str) -> Motion:
    parser = argparse.ArgumentParser()
    add_motion(parser)
    return motion(parser.parse_args(options))


def test_the_learned_mouth_is_the_default() -> None:
    assert asked() == Motion("hmm", 1.0)


def test_another_can_be_asked_for() -> None:
    assert asked("--motion", "keyframes", "--articulation", "0.6") == Motion("keyframes", 0.6)


@pytest.mark.parametrize("wrong", [("--motion", "dnn"), ("--articulation", "9"), ("--articulation", "nan")])
def test_what_there_is_not_is_refused(wrong: tuple[str, str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        asked(*wrong)
    assert wrong[0] in capsys.readouterr().err
