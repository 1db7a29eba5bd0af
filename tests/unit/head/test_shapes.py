"""The tables of face shapes, and the plan that drives those a head has."""

import numpy as np
import pytest

from fapstream.fap.tables import expressions, visemes
from fapstream.head.shapes import arkit, drives, known, oculus, plan, stand_ins, strengths

OCULUS = ["sil", "PP", "FF", "TH", "DD", "kk", "CH", "SS", "nn", "RR", "aa", "E", "I", "O", "U"]


def test_the_names_are_complete() -> None:
    assert len(arkit()) == 52
    assert list(oculus()) == [f"viseme_{name}" for name in OCULUS]
    assert set(arkit()) - set(drives()) == {"mouthShrugUpper"}


@pytest.mark.parametrize("name", arkit())
def test_left_and_right_mirror_each_other(name: str) -> None:
    pairs = {6: 7, 8: 9, 10: 11, 12: 13, 19: 20, 21: 22, 31: 32, 33: 34, 35: 36, 37: 38, 39: 40, 41: 42}
    pairs |= {53: 54, 55: 56, 57: 58, 59: 60, 61: 62}
    if not name.endswith("Left") or name in ("jawLeft", "mouthLeft") or "Look" in name:
        return
    mirrored = arkit()[name].copy()
    for left, right in pairs.items():
        mirrored[[left - 1, right - 1]] = mirrored[[right - 1, left - 1]]
    np.testing.assert_allclose(arkit()[name.replace("Left", "Right")], mirrored, atol=20)


@pytest.mark.parametrize(
    ("name", "shape"),
    [
        ("jawOpen", "jawOpen"), ("JawOpen", "jawOpen"), ("blendShape1.jaw_open", "jawOpen"),
        ("Face:mouthSmile_L", "mouthSmileLeft"), ("mouth smile right", "mouthSmileRight"),
        ("eyeBlinkLeft.001", "eyeBlinkLeft"), ("viseme_ih", "viseme_I"), ("Viseme_PP", "viseme_PP"),
        ("vrm:aa", "viseme_aa"), ("vrm:A", "viseme_aa"), ("vrm:blink_l", "eyeBlinkLeft"),
        ("vrm:jawOpen", "jawOpen"),
        ("eyesClosed", "blink"), ("A", None), ("Smile-o-matic", None), ("", None), ("hairLeft", None),
    ],
)  # fmt: skip
def test_names_in_the_wild(name: str, shape: str | None) -> None:
    assert known(name) == shape


@pytest.mark.parametrize("viseme", [k for k in range(1, 15) if k != 2])
def test_the_shapes_open_the_lips_as_far_as_the_faps_say(viseme: int) -> None:
    """The gap at mid-lip is -(FAP 4 + FAP 5), above 0; shapes add up, within 90 units (1.7 mm).

    Not so for f and v, whose lower lip rolls in under the teeth.
    """
    wanted = -(visemes()[viseme][3] + visemes()[viseme][4])
    found = strengths(visemes()[viseme][None].astype(np.int32), list(arkit()))
    got = -sum(weight[0] * (arkit()[name][3] + arkit()[name][4]) for name, weight in found.items())
    assert max(got, 0) == pytest.approx(max(wanted, 0), abs=90)


@pytest.mark.parametrize("jaw", [60, 250, 500])
def test_lips_close_however_far_the_jaw_is_open(jaw: int) -> None:
    frame = np.zeros((1, 68), np.int32)
    frame[0, 2] = jaw
    found = strengths(frame, list(arkit()))
    assert found["jawOpen"][0] > 0
    assert found["mouthClose"][0] == pytest.approx(found["jawOpen"][0])


@pytest.mark.parametrize(
    ("name", "shapes"),
    [("joy", "mouthSmileLeft mouthSmileRight cheekSquintLeft"), ("sadness", "browInnerUp mouthFrownLeft"),
     ("anger", "browDownLeft browDownRight"), ("fear", "browInnerUp eyeWideLeft"),
     ("disgust", "noseSneerLeft noseSneerRight"), ("surprise", "browInnerUp eyeWideLeft jawOpen")],
)  # fmt: skip
def test_expressions_drive_the_shapes_that_mean_them(name: str, shapes: str) -> None:
    found = strengths(expressions()[name][None].astype(np.int32), list(arkit()))
    for shape in shapes.split():
        assert found[shape][0] > 0.25, shape


def test_every_shape_is_driven_by_its_own_faps() -> None:
    for name in set(drives()) - {"mouthShrugLower"}:
        found = strengths(arkit()[name][None].astype(np.int32), list(arkit()))
        assert found[name][0] > 0.25, name


def test_a_full_set_lacks_nothing() -> None:
    full = plan(list(arkit()))
    assert full.missing == ()
    assert full.instead == {}


def test_without_mouth_close_the_jaw_follows_the_lips() -> None:
    names = set(arkit()) - {"mouthClose"}
    closed = np.zeros((1, 68), np.int32)
    closed[0, 2] = 300
    assert strengths(closed, names)["jawOpen"][0] == pytest.approx(0, abs=1e-9)
    assert strengths(visemes()[10][None].astype(np.int32), names)["jawOpen"][0] > 0.35
    assert plan(names).missing == ("mouthClose",)
    assert plan(names).instead == {"mouthClose": ("jawOpen",)}


def test_visemes_alone_open_round_and_close_the_mouth() -> None:
    def at(number: int) -> dict[str, float]:
        rows = strengths(visemes()[number][None].astype(np.int32), list(oculus()))
        return {name: row[0] for name, row in rows.items()}

    assert at(10)["viseme_aa"] > 0.4
    assert at(14)["viseme_U"] > 0.8
    assert at(2)["viseme_FF"] > 0.5
    assert at(1)["viseme_aa"] == 0
    assert at(1)["viseme_PP"] > 0.3


def test_presets_of_vrm_alone_do_too() -> None:
    chosen = plan(["viseme_aa", "viseme_I", "viseme_U", "viseme_E", "viseme_O", "blink"])
    assert {"viseme_aa", "viseme_U", "blink"} <= set(chosen.drives)
    assert chosen.instead["eyeBlinkLeft"] == ("blink",)
    assert "mouthSmileLeft" in chosen.missing
    assert "mouthSmileLeft" not in chosen.instead


def test_nothing_comes_of_nothing() -> None:
    assert plan([]).drives == {}
    assert stand_ins("jawOpen", []) == {}
    assert plan(list(arkit()), without=("eyeLook",)).drives.keys() == set(drives()) - {
        name for name in drives() if name.startswith("eyeLook")
    }
