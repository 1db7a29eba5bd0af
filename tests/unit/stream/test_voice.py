"""One turn's store: when it may start, and when it is changed."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.stream.jitter import FLOOR_S, Jitter
from fapstream.stream.voice import OVERDUE_S, PATIENCE_S, QUIET_EVERY, SPEECH_EVERY, Voice
from tests.unit.stream.test_line import VOICE

RATE = 16_000
PACKET = 640
PATIENT = round(PATIENCE_S * RATE)


def voice_of(live: bool, packets: int) -> Voice:
    voice = Voice(1, live, RATE, Jitter())
    for k in range(packets):
        voice.push(PACKET * k, VOICE[PACKET * k : PACKET * (k + 1)], False, 0)
    voice.start(0)
    voice.take(1000, False)
    return voice


def test_it_may_start_with_the_target_in_store() -> None:
    voice = Voice(1, False, RATE, Jitter())
    assert not voice.startable(0)
    voice.push(0, np.zeros(round(FLOOR_S * RATE) - 1, np.int16), False, 0)
    assert not voice.startable(0)
    voice.push(round(FLOOR_S * RATE) - 1, np.zeros(1, np.int16), False, 0)
    assert voice.startable(0)
    voice.push(0, np.zeros(0, np.int16), True, 0)
    assert voice.startable(0)


def test_a_live_talk_may_start_with_a_packet_once_the_rest_has_passed_as_time() -> None:
    voice = Voice(1, True, RATE, Jitter())
    voice.push(0, np.zeros(PACKET, np.int16), False, 1000)
    short = round(FLOOR_S * RATE) - PACKET
    assert not voice.startable(1000 + short - 1)
    assert voice.startable(1000 + short)
    own = Voice(1, False, RATE, Jitter())
    own.push(0, np.zeros(PACKET, np.int16), False, 1000)
    assert not own.startable(99_999)


@pytest.mark.parametrize(("live", "packets", "way"), [(True, 12, -1), (True, 2, 0), (False, 12, 0)])
def test_only_a_live_talk_shrinks(live: bool, packets: int, way: int) -> None:
    voice = voice_of(live, packets)
    before = voice.line.queued
    assert voice.fit(0) == 0
    voice._arrived = PATIENT
    assert voice.fit(PATIENT - 1) == 0, "not at once"
    size = voice.fit(PATIENT)
    assert voice.line.queued - before == way * size
    assert (size > 0) == (way != 0)


def test_after_a_change_most_of_speech_and_half_of_a_pause_pass_as_they_are() -> None:
    voice = voice_of(True, 40)
    assert voice.fit(0) == 0
    voice._arrived = PATIENT
    size = voice.fit(PATIENT)
    assert size > 0
    voice.take(size, False)
    while voice.line.at < 1000 + SPEECH_EVERY * size:
        assert voice.fit(PATIENT) == 0
        voice.take(100, False)
    assert voice.fit(PATIENT) > 0
    quiet = Voice(1, True, RATE, Jitter())
    quiet.push(0, np.zeros(16_000, np.int16), False, 0)
    quiet.start(0)
    quiet.take(1000, False)
    assert quiet.fit(0) == 0
    quiet._arrived = PATIENT
    assert quiet.fit(PATIENT) == 240
    while quiet.line.at < 1000 + QUIET_EVERY * 240:
        assert quiet.fit(PATIENT) == 0
        quiet.take(100, False)
    assert quiet.fit(PATIENT) == 240


@pytest.mark.parametrize("live", [True, False])
def test_time_is_gained_when_a_packet_is_overdue_and_not_when_the_text_has_run_dry(live: bool) -> None:
    overdue = round(OVERDUE_S * RATE) + 1
    assert voice_of(live, 4).fit(overdue) > 0
    for why in ("held", "ended", "stopped"):
        voice = voice_of(live, 4)
        setattr(voice, why, True)
        assert voice.fit(overdue) == 0
    assert voice_of(False, 20).fit(overdue) == 0, "enough in store"


def test_it_fades_in_and_out_to_nothing() -> None:
    voice = voice_of(False, 10)
    assert voice.gain == 1
    parts = []
    while len(part := voice.take(50, True)):
        parts.append(part)
    assert sum(map(len, parts)) == 320
    assert voice.gain == 0
    assert parts[-1][-1] == 0


def test_a_packet_is_late_if_its_sound_should_have_been_heard() -> None:
    voice = voice_of(False, 2)
    voice.take(9999, False)
    voice.rest()
    voice.dry = 2000
    late = [voice.push(PACKET * k, VOICE[:PACKET], False, 2000 + PACKET) for k in range(2, 5)]
    assert late == [True, True, False]
    assert not voice.push(0, VOICE[:PACKET], False, 9000), "nothing new"
    voice.start(0)
    assert not voice.push(PACKET * 5, VOICE[:PACKET], False, 9000)
