"""The skeleton does what turns do: linear blend skinning against deform."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.errors import DataError
from fapstream.head.deform import about_axis, deform, rotation
from fapstream.head.foreign import read_foreign
from fapstream.head.gltf_write import HeadWriter
from fapstream.head.mesh import Head, Turn
from fapstream.head.skeleton import add_skeleton, joint_tracks, skeleton
from tests.unit.head.avatars import avatar

HEAD = read_foreign(avatar(), "x").head


def matrices(quaternions: np.ndarray) -> np.ndarray:
    x, y, z, w = quaternions
    angle = 2 * np.arctan2(np.linalg.norm([x, y, z]), w)
    return about_axis(np.array([x, y, z]) if angle else np.array([1.0, 0, 0]), angle)


def posed(head: Head, frame: np.ndarray, part: str) -> np.ndarray:
    """Skinned by hand from what the skeleton says."""
    bones = skeleton(head)
    tracks = joint_tracks(head, bones, frame[None])
    points = head.part(part).positions.astype(float)
    joints, weights = bones.weights[part]
    total = np.zeros_like(points)
    for k, combination in enumerate(bones.combinations):
        moved = points
        for depth in range(len(combination)):
            joint = bones.combinations.index(combination[depth:])
            pivot = np.array(head.turns[combination[depth]].pivot)
            turn = np.eye(3) if tracks[joint] is None else matrices(tracks[joint][0])
            moved = (moved - pivot) @ turn.T + pivot
        total += (weights * (joints == k)).sum(1)[:, None] * moved
    return total


@pytest.mark.parametrize("part", [part.name for part in HEAD.parts])
@settings(max_examples=20, deadline=None)
@given(st.lists(st.integers(-32000, 32000), min_size=7, max_size=7))
def test_it_poses_every_part_as_deform_does(part: str, angles: list[int]) -> None:
    frame = np.zeros(68)
    frame[[22, 23, 24, 25, 47, 48, 49]] = angles
    rest = Head(HEAD.name, HEAD.parts, HEAD.fapu, HEAD.fdp, HEAD.mouth, HEAD.camera, (), HEAD.turns)
    np.testing.assert_allclose(posed(rest, frame, part), deform(rest, frame)[part], atol=2e-7)


def test_partial_weights_of_two_turns_make_four_joints() -> None:
    half = np.full(len(HEAD.part("skin").positions), 0.5, np.float32)
    turns = (Turn((23,), ((0, 1, 0),), ("skin",), (0, 0, 0.1), {"skin": half}),
             Turn((48,), ((1, 0, 0),), None, (0, 0, 0), {"skin": half}))  # fmt: skip
    head = Head("x", HEAD.parts, HEAD.fapu, HEAD.fdp, HEAD.mouth, HEAD.camera, (), turns)
    assert skeleton(head).combinations == ((), (0,), (1,), (0, 1))
    frame = np.zeros(68)
    frame[[22, 47]] = 25000, -20000
    np.testing.assert_allclose(posed(head, frame, "skin"), deform(head, frame)["skin"], atol=2e-7)


def test_turns_that_overlap_without_end_are_refused() -> None:
    """64 of them would make 2^64 joints."""
    half = np.full(len(HEAD.part("skin").positions), 0.5, np.float32)
    turns = (Turn((48,), ((1, 0, 0),), None, (0, 0, 0), {"skin": half}),) * 64
    head = Head("x", HEAD.parts, HEAD.fapu, HEAD.fdp, HEAD.mouth, HEAD.camera, (), turns)
    with pytest.raises(DataError, match="x: its turns overlap"):
        skeleton(head)


def test_bones_hang_on_each_other_and_carry_names_that_others_know() -> None:
    writer = HeadWriter()
    skin, joints = add_skeleton(writer, HEAD, skeleton(HEAD))
    names = [writer.document["nodes"][joint]["name"] for joint in joints]
    assert skin == 0
    assert {"Root", "Head", "LeftEye", "RightEye"} == set(names)
    assert writer.document["skins"][0]["joints"] == joints
    head = writer.document["nodes"][joints[names.index("Head")]]
    assert {writer.document["nodes"][child]["name"] for child in head["children"]} == {"LeftEye", "RightEye"}


def test_quaternions_go_the_short_way() -> None:
    frames = np.zeros((60, 68))
    frames[:, 48] = np.linspace(-32000, 32000, 60)
    bones = skeleton(HEAD)
    track = next(track for track in joint_tracks(HEAD, bones, frames) if track is not None)
    assert ((track[1:] * track[:-1]).sum(1) > 0.99).all()
    np.testing.assert_allclose(np.linalg.norm(track, axis=1), 1, atol=1e-6)
    turn = HEAD.turns[-1]
    np.testing.assert_allclose(matrices(track[-1]), rotation(turn, frames[-1]), atol=1e-6)
