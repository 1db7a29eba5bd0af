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
    buffer = TurnBuffer()
    for k in range(packets):
        buffer.push(packet(k, frames=frames))
    return buffer


@pytest.mark.parametrize(("sample", "value"), [(2560, 4), (2720, 4.25), (-5, 0), (640 * 20, 9)])
def test_the_face_is_linear_between_frames_and_held_at_the_ends(sample: float, value: float) -> None:
    face = filled().face(sample)
    assert face.shape == (68,)
    assert (face[2], face[47], face[3]) == (value, -value, 0)


def test_it_is_neutral_while_there_is_no_frame() -> None:
    assert not TurnBuffer().face(100).any()


def test_several_frames_a_packet() -> None:
    assert filled(frames=2).face(480)[2] == 1.5


def test_it_is_right_after_minutes_with_the_past_forgotten() -> None:
    buffer = TurnBuffer()
    for k in range(9000):
        buffer.push(packet(k))
        if k % 10 == 0 and k > 50:
            assert buffer.face(640 * (k - 40.5))[2] == k - 40.5
    assert len(buffer._frames) < 1000
    assert buffer.received == 9000 * 640
