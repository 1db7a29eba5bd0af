"""Sound in, packets out: the same sound, on one clock, with a face that is at most 300 ms behind."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fapstream.hearing import Hearing
from fapstream.motion import Motion
from fapstream.motion.articulation import COLUMNS
from fapstream.records import Packet, Pcm, TurnFormat
from tests.unit.voicing import voicing

SOUND = voicing(2.0)


def heard(pcm: Pcm, cuts: list[int], rate: int = 16000, fps: int = 25, gain: float = 1.0) -> list[Packet]:
    hearing = Hearing(TurnFormat(1, "", "en", rate, fps), 3, Motion(gain=gain))  # type: ignore[arg-type]
    packets: list[Packet] = []
    for part in np.split(pcm, sorted(cuts)):
        hearing.add(part)
        packets += hearing.packets()
    hearing.end()
    return packets + list(hearing.packets())


def faces(packets: list[Packet]) -> np.ndarray:
    return np.array([f.values for p in packets for f in p.frames])


@pytest.mark.parametrize("rate", [8000, 16000, 22050, 44100, 48000])
@pytest.mark.parametrize("fps", [25, 50])
def test_the_sound_comes_back_whole_with_a_frame_wherever_one_belongs(rate: int, fps: int) -> None:
    pcm = voicing(1.0, rate)[:-17]
    packets = heard(pcm, [1, 2, rate // 3], rate, fps)
    assert np.array_equal(np.concatenate([p.pcm for p in packets]), pcm)
    assert [p.start for p in packets] == list(np.cumsum([0, *(len(p.pcm) for p in packets[:-1])]))
    samples = [f.sample for p in packets for f in p.frames]
    assert samples == [s for s in (k * rate // fps for k in range(fps + 1)) if s < len(pcm)]
    assert all(p.start <= f.sample < p.start + len(p.pcm) for p in packets for f in p.frames)


@settings(max_examples=15, deadline=None)
@given(st.lists(st.integers(0, len(SOUND)), max_size=12))
def test_fragments_do_not_matter(cuts: list[int]) -> None:
    one, other = heard(SOUND, []), heard(SOUND, cuts)
    assert [(p.start, len(p.pcm)) for p in one] == [(p.start, len(p.pcm)) for p in other]
    assert np.array_equal(faces(one), faces(other))


def test_a_packet_is_there_as_soon_as_its_delay_has_passed() -> None:
    """At most 300 ms, as it says, and a packet's own length."""
    hearing = Hearing(TurnFormat(1, "", "en", 16000, 25), 1)
    assert 0 < hearing.delay <= 0.3 * 16000
    out = 0
    for at in range(0, len(SOUND), 160):
        hearing.add(SOUND[at : at + 160])
        out += sum(len(p.pcm) for p in hearing.packets())
        assert at + 160 - out <= hearing.delay + 640 + 160
        assert hearing.kept == at + 160 - out


def test_the_mouth_moves_with_what_is_said_and_rests_without() -> None:
    silence = np.zeros(16000, np.int16)
    said = np.concatenate([silence, SOUND, silence])
    mouth = faces(heard(said, []))[:, COLUMNS]
    loud, before, after = mouth[27:75], mouth[:20], mouth[-12:]
    assert np.abs(loud).max() > 60
    assert np.abs(before).max() <= 8
    assert np.abs(after).max() <= 8


def test_a_gain_makes_it_move_more() -> None:
    small, large = (np.abs(faces(heard(SOUND, [], gain=g))[:, COLUMNS]).mean() for g in (0.6, 1.5))
    assert large > 1.5 * small


def test_all_but_the_last_packets_may_be_followed_by_nothing() -> None:
    packets = heard(SOUND, list(range(0, len(SOUND), 1600)))
    assert packets[0].hold
    assert not packets[-1].hold


def test_a_turn_without_sound_has_no_packets() -> None:
    assert heard(np.zeros(0, np.int16), []) == []
