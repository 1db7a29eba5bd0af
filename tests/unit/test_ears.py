"""A turn of sound as it comes: packets while it comes, a limit to what may wait, an end."""

from __future__ import annotations

import asyncio

import numpy as np
import pytest

from fapstream.ears import MAX_PENDING_S, Ears
from fapstream.errors import SoundTooLong
from fapstream.hearing import Hearing
from fapstream.records import Packet, TurnFormat
from tests.unit.voicing import voicing

RATE = 16000
SOUND = voicing(1.5)


def ears() -> Ears:
    return Ears(Hearing(TurnFormat(1, "", "en", RATE, 25), 1))


async def test_packets_come_while_the_sound_still_comes() -> None:
    e = ears()
    got: list[Packet] = []

    async def take() -> None:
        async for packet in e.packets():
            got.append(packet)

    taking = asyncio.create_task(take())
    e.feed(SOUND[:RATE])
    for _ in range(50):
        await asyncio.sleep(0)
    early = sum(len(p.pcm) for p in got)
    assert RATE - e.delay - 640 <= early < RATE
    e.feed(SOUND[RATE:])
    e.end()
    await asyncio.wait_for(taking, 5)
    assert np.array_equal(np.concatenate([p.pcm for p in got]), SOUND)


async def test_what_waits_is_bounded_and_what_was_taken_stays() -> None:
    e = ears()
    second = np.ones(RATE, np.int16)
    for _ in range(int(MAX_PENDING_S)):
        e.feed(second)
    with pytest.raises(SoundTooLong) as refused:
        e.feed(second)
    assert refused.value.limit_s == MAX_PENDING_S
    assert e.pending_s == MAX_PENDING_S
    packets = e.packets()
    while e.pending_s > MAX_PENDING_S - 2:
        await anext(packets)
    e.feed(second)
    await packets.aclose()


async def test_an_end_without_sound_is_an_end() -> None:
    e = ears()
    e.end()
    assert [p async for p in e.packets()] == []
