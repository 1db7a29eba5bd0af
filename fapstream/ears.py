"""A turn of sound brought to life: sound comes in at any pace, packets go out."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import AsyncGenerator

from fapstream.errors import SoundTooLong
from fapstream.hearing import Hearing
from fapstream.records import Packet, Pcm

MAX_PENDING_S = 60.0
"""Sound that may wait to be taken as packets."""
SLICE_S = 0.1
"""Sound heard at a time, so that nobody else waits for more than a few milliseconds."""


class Ears:
    """What is heard of one turn."""

    def __init__(self, hearing: Hearing) -> None:
        self._hearing = hearing
        self._rate = hearing.turn.sample_rate
        self._waiting: deque[Pcm] = deque()
        self._pending = 0
        self._ended = False
        self._came = asyncio.Event()

    @property
    def delay(self) -> int:
        """See Hearing."""
        return self._hearing.delay

    @property
    def pending_s(self) -> float:
        """Seconds of sound that wait to be taken as packets."""
        return (self._pending + self._hearing.kept) / self._rate

    def feed(self, pcm: Pcm) -> None:
        """More sound. Raises SoundTooLong, and takes none of it, when too much waits already."""
        waiting = self.pending_s + len(pcm) / self._rate
        if waiting > MAX_PENDING_S:
            raise SoundTooLong(waiting, MAX_PENDING_S)
        step = round(SLICE_S * self._rate)
        for at in range(0, len(pcm), step):
            self._waiting.append(pcm[at : at + step])
        self._pending += len(pcm)
        self._came.set()

    def end(self) -> None:
        """The sound is complete."""
        self._ended = True
        self._came.set()

    async def packets(self) -> AsyncGenerator[Packet, None]:
        """The turn's packets, in order, as early as they can be made."""
        while True:
            for packet in self._hearing.packets():
                yield packet
            if self._waiting:
                pcm = self._waiting.popleft()
                self._hearing.add(pcm)
                self._pending -= len(pcm)
                await asyncio.sleep(0)
            elif self._ended:
                self._hearing.end()
                for packet in self._hearing.packets():
                    yield packet
                return
            else:
                self._came.clear()
                await self._came.wait()
