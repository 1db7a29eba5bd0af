"""One turn brought to life: text comes in at any pace, a voice speaks it, packets go out.

Three things run at once: the writer hands phrases to the voice as far ahead as is useful, the reader takes
sound as it is made, and the caller takes packets.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import AsyncGenerator, AsyncIterator, Awaitable, Callable, Coroutine
from contextlib import suppress

from fapstream.errors import TextTooLong
from fapstream.pipeline import Pipeline
from fapstream.ports import Synthesizer
from fapstream.records import Packet, Speech, Utterance

MAX_PENDING_TEXT = 262_144
"""Characters that may wait to be spoken."""

SLICE = 64
"""Characters given to the front-end at a time, so that nobody else waits for more than a millisecond."""

AHEAD_S = 3.0
"""The voice is given no more text while it has made this much more sound than was taken."""

STALL_S = 0.06
"""Text that pauses this long, while the listener is about to run dry, is held."""

HOLD_S = 0.10
"""With less than this left to hear, the gap is filled: the voice gives out what it keeps back for the next
phone, drawn out, and pauses."""


Acquire = Callable[[], Awaitable[Synthesizer]]


class Talk:
    """A turn in progress.

    `heard_s` tells how many seconds of it the listener has heard. `again` gives another synthesizer of the
    same voice; without it, the turn cannot be cut.
    """

    def __init__(
        self,
        pipeline: Pipeline,
        synthesizer: Synthesizer,
        heard_s: Callable[[], float] | None = None,
        again: Acquire | None = None,
    ) -> None:
        self._pipeline = pipeline
        self._synthesizer = synthesizer
        self._heard_s = heard_s
        self._again = again
        self._rate = pipeline.turn.sample_rate
        self._text_came = asyncio.Event()
        self._sound_came = asyncio.Event()
        self._room_came = asyncio.Event()
        self._dropped: set[asyncio.Task[None]] = set()
        """Voices that were cut off and are being given back."""
        self._begin()

    def _begin(self) -> None:
        """No text has come yet."""
        self._text: deque[str] = deque()
        self._pending = 0
        self._ended = False
        self._finished = False
        self._stalled_since: float | None = None
        self._tasks: list[asyncio.Task[None]] = []

    def feed(self, text: str) -> None:
        """More text. Raises TextTooLong, and takes none of it, when too much waits already."""
        if self._pending + len(text) > MAX_PENDING_TEXT:
            raise TextTooLong(self._pending + len(text), MAX_PENDING_TEXT)
        self._take(text)

    def _take(self, text: str) -> None:
        for at in range(0, len(text), SLICE):
            self._text.append(text[at : at + SLICE])
        self._pending += len(text)
        self._pipeline.keep(text, self._pending)
        self._text_came.set()

    def end(self) -> None:
        """The text is complete."""
        self._ended = True
        self._text_came.set()

    @property
    def room(self) -> int:
        """Characters that may be fed now."""
        return max(0, MAX_PENDING_TEXT - self._pending)

    def heard_char(self, sample: int) -> int:
        """Code points of the text heard by `sample`."""
        return self._pipeline.heard_char(sample)

    def heard_word(self, sample: int) -> tuple[int, int]:
        """The characters [start, end) of the word heard at `sample`; (0, 0) before the first."""
        return self._pipeline.heard_word(sample)

    def seek_char(self, sample: int, sentences_back: int = 0) -> int:
        """The character with which the sentence heard at `sample` begins, or one so many sentences before it;
        the oldest beginning of which the text is still there, if there are not so many."""
        return self._pipeline.sentence(sample, sentences_back)

    def text_from(self, char: int) -> str:
        """The text from a character on, also what was not spoken yet. Of the spoken, the last 64 k characters
        are kept; if `char` is older, the oldest of these comes first."""
        return self._pipeline.text_from(char)

    def cut(self, sample: int, text_start: int, text: str = "") -> int:
        """Ends what is planned; `text`, of any length, and what is fed from now on is the text from the
        character `text_start` on.

        Returns t >= `sample`: the end of the word heard at `sample`, or `sample` itself in a pause; but never
        beyond the sound that was made. Everything from t on is void, packets already taken too; text that
        waited is forgotten unless it is part of `text`, and `end` has to be called again. Packets go on with
        one that starts at t exactly; if `packets` had come to its end, call it again. Raises ValueError if no
        other voice can be had.
        """
        if self._again is None:
            raise ValueError("a talk without `again` cannot be cut")
        t = self._pipeline.cut(sample, text_start)
        begun = bool(self._tasks)
        dropped = asyncio.create_task(self._let_go())
        self._dropped.add(dropped)
        dropped.add_done_callback(self._dropped.discard)
        self._synthesizer = _Later(self._again, self._rate)
        self._begin()
        self._take(text)
        if begun:
            self._start()
        self._sound_came.set()
        return t

    def splice(self, sample: int, char: int) -> tuple[int, int]:
        """The text from a character on is void, as far as it was not heard by `sample`; what is fed from now
        on takes its place.

        Returns the first void sample, as `cut`, and how many characters stay: more than `char` if a word
        that goes beyond it is being heard.
        """
        word = self._pipeline.said_until(sample, char)
        said = word.char_end if word else 0
        left = self.text_from(said)[: max(0, char - said)]
        t = self.cut(max(sample, word.start if word else 0), said, left)
        return t, said + len(left)

    def seek(self, sample: int, back: int) -> tuple[int, int]:
        """Say the sentence heard at `sample` again, or one so many sentences before it, and all that follows;
        `end` has to be called again.

        Returns the first void sample, as `cut`, and the character that is said next.
        """
        char = self.seek_char(sample, back)
        return self.cut(sample, char, self.text_from(char)), char

    def _let_go(self) -> Coroutine[None, None, None]:
        """Stops at once those who write and read; what is returned gives their voice back after that."""
        for task in self._tasks:
            task.cancel()
        return _given_back(self._tasks, self._synthesizer)

    async def packets(self) -> AsyncGenerator[Packet, None]:
        """The turn's packets, in order, as early as they can be made. Raises SynthesisError."""
        if not self._tasks:
            self._start()
        while True:
            self._sound_came.clear()
            finished = self._finished
            if packet := next(self._pipeline.packets(self._dry(), finished), None):
                yield packet
                if not self._too_far_ahead():
                    self._room_came.set()
                continue
            self._raise_failure()
            if finished:
                return
            await self._sound_came.wait()

    def _start(self) -> None:
        self._tasks = [
            asyncio.create_task(self._write(self._synthesizer)),
            asyncio.create_task(self._read(self._synthesizer)),
        ]

    async def aclose(self) -> None:
        """Stop, whatever the state, and give the voice back, also when cancelled meanwhile."""
        await asyncio.shield(self._close())

    async def _close(self) -> None:
        await asyncio.gather(self._let_go(), *self._dropped)

    def _raise_failure(self) -> None:
        for task in self._tasks:
            if task.done() and not task.cancelled() and (error := task.exception()):
                raise error

    def _dry(self) -> bool:
        """No text waits and none is being spoken beyond what the voice has given out."""
        return not (self._text or self._ended or self._pipeline.speaking)

    # the writer

    async def _write(self, voice: Synthesizer) -> None:
        try:
            while self._text or not self._ended:
                if self._text and not self._too_far_ahead():
                    slice_ = self._text.popleft()
                    self._pending -= len(slice_)
                    await self._speak(voice, self._pipeline.feed(slice_))
                    await asyncio.sleep(0)
                else:
                    await self._wait_for_text()
                await self._hold_when_dry(voice)
            await self._speak(voice, self._pipeline.end())
            await voice.finish()
        finally:
            self._sound_came.set()

    async def _speak(self, voice: Synthesizer, utterances: list[Utterance]) -> None:
        for utterance in utterances:
            await voice.write(utterance)
            self._stalled_since = None

    def _too_far_ahead(self) -> bool:
        return self._pipeline.planned - self._pipeline.produced > AHEAD_S * self._rate

    async def _wait_for_text(self) -> None:
        if self._too_far_ahead():
            self._room_came.clear()
            await self._room_came.wait()
            return
        self._text_came.clear()
        stalling = self._pipeline.speaking
        # not wait_for: it may lose a cancellation that comes together with the text (until Python 3.12)
        with suppress(TimeoutError):
            async with asyncio.timeout(STALL_S if stalling else None):
                await self._text_came.wait()

    async def _hold_when_dry(self, voice: Synthesizer) -> None:
        """When the text has stalled inside a phrase and the listener is about to run dry."""
        if self._heard_s is None or self._ended or self._text or not self._pipeline.speaking:
            return
        now = asyncio.get_running_loop().time()
        self._stalled_since = self._stalled_since or now
        left = self._pipeline.produced / self._rate - self._heard_s()
        if now - self._stalled_since >= STALL_S * 0.9 and left < HOLD_S:
            await self._speak(voice, self._pipeline.hold())
            self._sound_came.set()

    # the reader

    async def _read(self, voice: Synthesizer) -> None:
        try:
            async for speech in voice.speech():
                self._pipeline.add(speech)
                self._sound_came.set()
            self._finished = True
        finally:
            self._sound_came.set()


async def _given_back(tasks: list[asyncio.Task[None]], voice: Synthesizer) -> None:
    """When nobody uses it any more."""
    await asyncio.gather(*tasks, return_exceptions=True)
    await voice.aclose()


class _Later:
    """A Synthesizer that will be there when the pool has one: who writes or listens waits for it."""

    def __init__(self, acquire: Acquire, sample_rate: int) -> None:
        self.sample_rate = sample_rate
        self._coming = asyncio.ensure_future(acquire())

    async def write(self, utterance: Utterance) -> None:
        await (await self._there()).write(utterance)

    async def flush(self) -> None:
        await (await self._there()).flush()

    async def finish(self) -> None:
        await (await self._there()).finish()

    async def speech(self) -> AsyncIterator[Speech]:
        async for speech in (await self._there()).speech():
            yield speech

    async def aclose(self) -> None:
        self._coming.cancel()
        [found] = await asyncio.gather(self._coming, return_exceptions=True)
        if not isinstance(found, BaseException):
            await found.aclose()

    async def _there(self) -> Synthesizer:
        """Whoever is cancelled while he waits does not cancel it for the others."""
        return await asyncio.shield(self._coming)
