"""One turn brought to life: text comes in at any pace, a voice speaks it, packets go out.

Three things run at once: the writer hands phrases to the voice as far ahead as is useful, the reader takes
sound as it is made, and the caller takes packets.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import AsyncGenerator, Callable
from contextlib import suppress

from fapstream.errors import TextTooLong
from fapstream.pipeline import Pipeline
from fapstream.ports import Synthesizer
from fapstream.records import Packet, Utterance

MAX_PENDING_TEXT = 262_144
"""Characters that may wait to be spoken."""

SLICE = 256
"""Characters given to the front-end at a time, so that nobody else waits long."""

AHEAD_S = 12.0
"""The voice is given no more text while it has made this much more sound than was taken."""

STALL_S = 0.06
"""Text that pauses this long, while the listener is about to run dry, is held."""

HOLD_S = 0.10
"""With less than this left to hear, the gap is filled: the voice gives out what it keeps back for the next
phone, drawn out, and pauses."""


class Talk:
    """A turn in progress. `heard_s` tells how many seconds of it the listener has heard."""

    def __init__(
        self, pipeline: Pipeline, synthesizer: Synthesizer, heard_s: Callable[[], float] | None = None
    ) -> None:
        self._pipeline = pipeline
        self._synthesizer = synthesizer
        self._heard_s = heard_s
        self._rate = pipeline.turn.sample_rate
        self._text: deque[str] = deque()
        self._pending = 0
        self._ended = False
        self._finished = False
        self._stalled_since: float | None = None
        self._text_came = asyncio.Event()
        self._sound_came = asyncio.Event()
        self._tasks: list[asyncio.Task[None]] = []

    def feed(self, text: str) -> None:
        """More text. Raises TextTooLong, and takes none of it, when too much waits already."""
        if self._pending + len(text) > MAX_PENDING_TEXT:
            raise TextTooLong(self._pending + len(text), MAX_PENDING_TEXT)
        for at in range(0, len(text), SLICE):
            self._text.append(text[at : at + SLICE])
        self._pending += len(text)
        self._text_came.set()

    def end(self) -> None:
        """The text is complete."""
        self._ended = True
        self._text_came.set()

    @property
    def room(self) -> int:
        """Characters that may be fed now."""
        return MAX_PENDING_TEXT - self._pending

    def heard_char(self, sample: int) -> int:
        """Code points of the text heard by `sample`."""
        return self._pipeline.heard_char(sample)

    async def packets(self) -> AsyncGenerator[Packet, None]:
        """The turn's packets, in order, as early as they can be made. Raises SynthesisError."""
        self._tasks = [asyncio.create_task(self._write()), asyncio.create_task(self._read())]
        while True:
            self._sound_came.clear()
            finished, dry = self._finished, self._dry()
            for packet in self._pipeline.packets(dry, finished):
                yield packet
            self._raise_failure()
            if finished:
                return
            await self._sound_came.wait()

    async def aclose(self) -> None:
        """Stop, whatever the state, and give the voice back, also when cancelled meanwhile."""
        await asyncio.shield(self._close())

    async def _close(self) -> None:
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        await self._synthesizer.aclose()

    def _raise_failure(self) -> None:
        for task in self._tasks:
            if task.done() and not task.cancelled() and (error := task.exception()):
                raise error

    def _dry(self) -> bool:
        """No text waits and none is being spoken beyond what the voice has given out."""
        return not (self._text or self._ended or self._pipeline.speaking)

    # the writer

    async def _write(self) -> None:
        try:
            while self._text or not self._ended:
                if self._text and not self._too_far_ahead():
                    slice_ = self._text.popleft()
                    self._pending -= len(slice_)
                    await self._speak(self._pipeline.feed(slice_))
                    await asyncio.sleep(0)
                else:
                    await self._wait_for_text()
                await self._hold_when_dry()
            await self._speak(self._pipeline.end())
            await self._synthesizer.finish()
        finally:
            self._sound_came.set()

    async def _speak(self, utterances: list[Utterance]) -> None:
        for utterance in utterances:
            await self._synthesizer.write(utterance)
            self._stalled_since = None

    def _too_far_ahead(self) -> bool:
        return self._pipeline.planned - self._pipeline.produced > AHEAD_S * self._rate

    async def _wait_for_text(self) -> None:
        if self._too_far_ahead():
            await asyncio.sleep(STALL_S)
            return
        self._text_came.clear()
        stalling = self._pipeline.speaking
        # not wait_for: it may lose a cancellation that comes together with the text (until Python 3.12)
        with suppress(TimeoutError):
            async with asyncio.timeout(STALL_S if stalling else None):
                await self._text_came.wait()

    async def _hold_when_dry(self) -> None:
        """When the text has stalled inside a phrase and the listener is about to run dry."""
        if self._heard_s is None or self._ended or self._text or not self._pipeline.speaking:
            return
        now = asyncio.get_running_loop().time()
        self._stalled_since = self._stalled_since or now
        left = self._pipeline.produced / self._rate - self._heard_s()
        if now - self._stalled_since >= STALL_S * 0.9 and left < HOLD_S:
            await self._speak(self._pipeline.hold())
            self._sound_came.set()

    # the reader

    async def _read(self) -> None:
        try:
            async for speech in self._synthesizer.speech():
                self._pipeline.add(speech)
                self._sound_came.set()
            self._finished = True
        finally:
            self._sound_came.set()
