"""The face of a sample."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.records import FapFrame, Packet
from fapstream.stream.buffer import TurnBuffer


def packet(k: int, frames: int = 1) -> Packet:
    """40 ms at 16 kHz whose FAP 3 counts frames and FAP 48 counts down."""
    rows = []
    for i in range(frames):
        values = np.zeros(68, np.int32)
        values[2], values[47] = k * frames + i, -(k * frames + i)
        rows.append(FapFrame(640 * k + 640 // frames * i, values))
    return Packet(1, 640 * k, np.zeros(640, np.int16), tuple(rows))


def filled(packets: int = 10, frames: int = 1) -> TurnBuffer:
    buffer = TurnBuffer(16_000)
    for k in range(packets):
        buffer.push(packet(k, frames=frames))
    return buffer


@pytest.mark.parametrize(("sample", "value"), [(2560, 4), (2720, 4.25), (-5, 0), (640 * 20, 9)])
def test_the_face_is_linear_between_frames_and_held_at_the_ends(sample: float, value: float) -> None:
    face = filled().face(sample)
    assert face.shape == (68,)
    assert (face[2], face[47], face[3]) == (value, -value, 0)


def test_it_is_neutral_while_there_is_no_frame() -> None:
    assert not TurnBuffer(16_000).face(100).any()


def test_several_frames_a_packet() -> None:
    assert filled(frames=2).face(480)[2] == 1.5


def test_it_is_right_after_minutes_with_the_past_forgotten() -> None:
    buffer = TurnBuffer(16_000)
    for k in range(9000):
        buffer.push(packet(k))
        if k % 10 == 0 and k > 50:
            assert buffer.face(640 * (k - 40.5))[2] == k - 40.5
    assert len(buffer._frames) < 1000
    assert buffer.received == 9000 * 640


def test_what_comes_twice_counts_once_and_frames_have_samples_of_their_own() -> None:
    buffer = filled(3)
    buffer.push(packet(2))
    buffer.push(packet(4))
    assert buffer.received == 5 * 640
    assert buffer.face(640 * 3)[2] == 3, "between frames that are not far apart"
    late = TurnBuffer(16_000)
    late.push(packet(1000))
    assert late.face(640 * 1000)[2] == 1000
    assert late.received == 640 * 1001


def test_frames_that_were_discarded_are_replaced_by_what_comes_then() -> None:
    buffer = filled(10)
    buffer.discard(640 * 5 + 1)
    assert (buffer.received, buffer.face(640 * 9)[2]) == (640 * 5 + 1, 5)
    values = np.full(68, 77, np.int32)
    buffer.push(Packet(1, 640 * 5 + 1, np.zeros(639, np.int16), (FapFrame(640 * 6, values),)))
    assert (buffer.received, buffer.face(640 * 6)[2]) == (640 * 6, 77)
    buffer.discard(0)
    assert not buffer.face(640 * 3).any()


def test_a_frame_holds_for_a_moment_and_not_over_a_gap() -> None:
    buffer = filled(3)
    buffer.push(packet(50))
    assert all(buffer.holds(sample) for sample in (0, 640, 640 * 2 + 1920, 640 * 50))
    assert not any(buffer.holds(sample) for sample in (-1, 640 * 2 + 1921, 640 * 50 - 1))
    assert buffer.face(640 * 30)[2] == 2, "not on the way to a frame that is far away"
    assert not TurnBuffer(16_000).holds(0)


def test_frames_that_are_far_apart_by_nature_hold_for_longer() -> None:
    buffer = TurnBuffer(16_000)
    for k in range(5):
        buffer.push(packet(10 * k))
    assert buffer.holds(640 * 15)
    assert buffer.face(640 * 15)[2] == 15
    assert buffer.holds(640 * 60)
    assert not buffer.holds(640 * 61)
