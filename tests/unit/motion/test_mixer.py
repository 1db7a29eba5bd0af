"""One face out of streams: who owns what, eyes that hold their aim, lids that meet, limits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from fapstream import data
from fapstream.errors import DataError
from fapstream.fap import EXPRESSIONS, expressions, limits, visemes
from fapstream.motion import mixer
from fapstream.motion.idle import Idle, IdleLife, Look, life
from fapstream.motion.mixer import AU, Mouth, Streams, idle_face, limited, mix

AHEAD = Idle(0.0, Look(0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
"""Nothing lives: a stare at infinity."""

ZERO = np.zeros(68)
LIPS = np.array([4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60]) - 1
JAW_AND_TONGUE = np.array([3, 14, 15, 43, 44, 45, 46, 47]) - 1


def face(
    mouth: Mouth | None = None, expression: NDArray[np.float64] = ZERO, idle: Idle = AHEAD, **more: object
) -> NDArray[np.float64]:
    return mix(
        Streams(mouth or Mouth(ZERO), expression, more.get("gesture", ZERO), idle, more.get("shut", 0.0))
    )  # type: ignore[arg-type]


def test_nothing_makes_nothing() -> None:
    assert not face().any()


@pytest.mark.parametrize("viseme", range(3, 15))
def test_speech_alone_goes_through(viseme: int) -> None:
    assert face(Mouth(visemes()[viseme], 1.0)) == pytest.approx(visemes()[viseme])


@pytest.mark.parametrize("name", EXPRESSIONS)
def test_an_expression_alone_shows_whole_but_for_lips_through_each_other(name: str) -> None:
    shown, wanted = face(expression=expressions()[name]), expressions()[name]
    apart = np.abs(shown - wanted) > 1e-6
    assert set(np.flatnonzero(apart)) <= set(LIPS)
    assert np.abs(shown - wanted).max() < 60


@pytest.mark.parametrize("name", EXPRESSIONS)
@pytest.mark.parametrize("viseme", range(3, 15))
def test_speech_owns_jaw_and_tongue_and_a_mood_keeps_brows_and_corners(viseme: int, name: str) -> None:
    speech, mood = visemes()[viseme], expressions()[name]
    shown = face(Mouth(speech, 1.0), mood)
    added = shown - speech
    assert (np.abs(added[JAW_AND_TONGUE]) <= 0.16 * np.abs(mood[JAW_AND_TONGUE]) + 1e-9).all()
    brows = slice(30, 38)
    assert shown[brows] == pytest.approx(mood[brows])
    corners = [11, 12]
    assert added[corners] == pytest.approx(0.8 * mood[corners])


def test_streams_add_up_smoothly_as_the_mouth_starts_to_speak() -> None:
    levels = [face(Mouth(ZERO, s), expressions()["joy"]) for s in np.linspace(0, 1, 101)]
    assert np.abs(np.diff(levels, axis=0)).max() < 0.01 * np.abs(expressions()["joy"]).max() + 1e-9


@given(*[st.floats(-0.15, 0.15)] * 4, st.floats(0.3, 1.5))
def test_both_eyes_aim_at_one_point_wherever_the_head_is(
    yaw: float, pitch: float, head_yaw: float, head_pitch: float, nearness: float
) -> None:
    shown = face(idle=Idle(0.0, Look(yaw, pitch, nearness), (head_pitch, head_yaw, 0.0)))
    left, right, left_pitch, right_pitch = shown[22:26] * AU
    assert (left + right) / 2 + shown[48] * AU == pytest.approx(yaw, abs=1e-9)
    assert left_pitch == right_pitch
    assert left_pitch + shown[47] * AU == pytest.approx(pitch, abs=1e-9)
    distance = 1 / nearness
    crossing = (
        2 * life()["gaze"]["half_eyes_m"] / (np.tan(right - yaw + head_yaw) - np.tan(left - yaw + head_yaw))
    )
    assert crossing == pytest.approx(distance, rel=0.01), "small angles"


def test_a_nod_does_not_move_the_gaze() -> None:
    gesture = np.zeros(68)
    gesture[47] = 3000
    assert face(gesture=gesture)[24:26].tolist() == [-3000, -3000]


def test_lids_follow_the_eyes_down_and_up() -> None:
    down = face(idle=Idle(0.0, Look(0.0, 0.2, 0.0), (0.0, 0.0, 0.0)))
    up = face(idle=Idle(0.0, Look(0.0, -0.2, 0.0), (0.0, 0.0, 0.0)))
    assert down[18] == down[19] > 100
    assert down[20] == down[21] < -40
    assert up[18] == pytest.approx(-down[18])


@pytest.mark.parametrize("name", [None, *EXPRESSIONS])
@pytest.mark.parametrize("pitch", [-0.2, 0.0, 0.2])
def test_a_blink_shuts_the_lids_wherever_they_stand(name: str | None, pitch: float) -> None:
    mood = expressions()[name] if name else ZERO
    for idle, shut in ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0)):
        shown = face(expression=mood, idle=Idle(idle, Look(0.0, pitch, 1.0), (0.0, 0.0, 0.0)), shut=shut)
        assert shown[18] + shown[20] == pytest.approx(1024)
        assert shown[19] + shown[21] == pytest.approx(1024)


@given(st.lists(st.floats(-1e6, 1e6), min_size=68, max_size=68))
def test_limits_hold_whatever_comes(values: list[float]) -> None:
    low, high = limits().T
    shown = limited(np.array(values))
    assert (shown >= low).all()
    assert (shown <= high).all()


def test_limits_are_soft_and_keep_the_order() -> None:
    ramp = np.array([limited(np.full(68, v)) for v in np.linspace(-3000, 3000, 1201)])
    assert (np.diff(ramp, axis=0) >= 0).all()
    assert (np.diff(ramp[:, 2:], axis=0) <= 5 + 1e-9).all(), "nowhere steeper than what comes in"
    inside = np.clip(200.0, *(0.9 * limits().T))
    assert limited(inside) == pytest.approx(inside)


def test_tables_and_idle_life_stay_within_what_is_not_bent() -> None:
    frames = [*visemes(), *expressions().values(), *(idle_face(IdleLife(1).at(t / 3)) for t in range(900))]
    low, high = 0.9 * limits().T
    for frame in frames:
        beyond = np.flatnonzero((frame < low - 1e-9) | (frame > high + 1e-9)) + 1
        assert not beyond.size


def test_the_frame_is_the_callers_own() -> None:
    speech = np.full(68, 10.0)
    face(Mouth(speech, 1.0, 1.0, 0.5), expressions()["joy"])
    assert (speech == 10.0).all()


@pytest.mark.parametrize("row", ["4 5\tx\twhy", "4 5\t30", "99\t30\twhy", "four\t30\twhy"])
def test_a_bad_row_names_its_line(row: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "motion/data").mkdir(parents=True)
    (tmp_path / "motion/data/mixing.tsv").write_text(f"# c\n# faps\tpercent\twhy\n{row}\n", encoding="utf-8")
    monkeypatch.setattr(data, "PACKAGE", str(tmp_path))
    with pytest.raises(DataError, match=r"mixing\.tsv:3: "):
        mixer.shares_while_speaking.__wrapped__()
