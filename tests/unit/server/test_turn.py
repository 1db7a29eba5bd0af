"""A turn's text while it waits, and what is left of packets after a cut."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.errors import TextTooLong
from fapstream.protocol import generated as g
from fapstream.records import FapFrame, Mark, Packet
from fapstream.server.turn import SpokenTurn
from fapstream.talk import MAX_PENDING_TEXT
from fapstream.tts.voices import voice

PACKET = Packet(
    1,
    640,
    np.arange(640, dtype=np.int16),
    (FapFrame(640, np.zeros(68, np.int32)), FapFrame(960, np.zeros(68, np.int32))),
    (Mark("word", 700, 10, "a"), Mark("word", 1000, 10, "b")),
)


def turn() -> SpokenTurn:
    return SpokenTurn(g.Speak(turn=1, text=b""), voice("us1"), 0.0)


def test_text_waits_up_to_a_limit_and_what_was_accepted_stays() -> None:
    t = turn()
    t.feed("x" * MAX_PENDING_TEXT)
    with pytest.raises(TextTooLong):
        t.feed("y")
    assert "".join(t._text) == "x" * MAX_PENDING_TEXT


@pytest.mark.parametrize(("cut", "left"), [(600, None), (640, None), (900, 260), (1280, 640), (5000, 640)])
def test_what_lies_behind_a_cut_is_void(cut: int, left: int | None) -> None:
    t = turn()
    t.cuts.append(cut)
    packet = t.still_valid(PACKET, 0)
    assert (packet and len(packet.pcm)) == left
    if packet:
        assert all(f.sample < cut for f in packet.frames)
        assert all(m.sample < cut for m in packet.marks)
    assert t.still_valid(PACKET, 1) is PACKET, "it was made after the cut"


def test_nobody_has_heard_more_than_was_sent() -> None:
    t = turn()
    t.sent = 100
    assert t.heard(500, 0.0) == 100
    assert t.heard(50, 0.0) == 50
    assert t.heard(None, 0.0) == 0
