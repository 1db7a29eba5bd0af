"""MBROLA as subprocesses behind the Synthesizer port: the sound of boundary G_i is heard at G_i + P."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import AsyncIterator, Sequence
from functools import partial
from itertools import pairwise

import numpy as np

from fapstream.adapters.mbrola_process import MbrolaProcess
from fapstream.adapters.spares import Budget, Limits, OnEvent, Spares, ignore
from fapstream.errors import SynthesisError
from fapstream.records import SILENCE, Pcm, Phone, Speech, TimedPhone, Utterance
from fapstream.tts.pho import FLUSH, Realiser
from fapstream.tts.voices import Voice

MAX_RESTARTS = 3
"""A process may die so often without having come to a pause."""

CLOSING_MS = 80
"""Silence that closes a phrase which has to be flushed in its middle."""

KEPT_PHONES = 7
"""The program keeps back less than the last so many phones: two and a half of its own, each of which may
stand for two of the language."""

MAX_LOG = 64
"""After so many writes that are not yet all said, the writer waits until they are."""


class MbrolaSynthesizer:
    """One turn spoken by MBROLA processes, one after the other.

    A process is held while there is something to say. At a closed pause, when all has been said, it goes back
    to the pool; what comes then is said by another, brought to where this one was: with as many samples kept
    back (`MbrolaProcess.renew`). If one dies, the next says again what was written since then. Nobody hears
    either: the same lines give the same bytes.

    Sample 0 of the turn is the process's sample `written` at the start: what the process still
    owes of the time before (a period of silence) is dropped. What the turn gives ends a period before
    what was asked for, because the program may keep back as much.
    """

    def __init__(self, pool: MbrolaPool, process: MbrolaProcess, voice: Voice) -> None:
        self.sample_rate = voice.sample_rate
        self._pool = pool
        self._voice = voice
        self._realiser = Realiser(voice)
        self._planned = 0
        """Samples of the turn asked for."""
        self._heard_end = voice.period
        """Where the last phone ends."""
        self._got = 0
        """Samples of the turn received."""
        self._finished = False
        self._closed = True
        """What was written last ends in a pause."""
        self._flushed = True
        """So does what the process has got."""
        self._tail: deque[int] = deque(maxlen=KEPT_PHONES)
        """Samples of the last phones sent since the last flush."""
        self._released = False
        self._log: list[str] = []
        """Everything written since the process was taken, to be said again by the next if this one dies."""
        self._log_start = 0
        """Samples received when the log began."""
        self._remainder = 0
        """Samples asked for and kept back when the log began."""
        self._restarts = 0
        self._phones: list[TimedPhone] = []
        self._pcm: deque[Pcm] = deque()
        self._came = asyncio.Event()
        self._rested = asyncio.Event()
        self._failure: SynthesisError | None = None
        self._writing = asyncio.Lock()
        self._process: MbrolaProcess | None = None
        self._hold(process)

    def _hold(self, process: MbrolaProcess) -> None:
        """Go on with a process that was brought to where the log begins."""
        self._process = process
        self._drop = process.owed - self._remainder
        """Samples that the process owes and nobody wants."""
        self._reader = asyncio.create_task(self._read(process))

    async def write(self, utterance: Utterance) -> None:
        """See the port. Raises SynthesisError."""
        if self._failure:
            raise self._failure
        if not utterance.phones:
            return
        written = self._realiser.write(utterance)
        origin, start = self._planned + self._voice.period, self._heard_end
        heard = self._heard([phone for phone, _ in written.phones], written.ends, written.following)
        for (phone, word), end in zip(written.phones, heard, strict=True):
            self._phones.append(TimedPhone(phone, start, origin + end, word))
            start = self._heard_end = origin + end
        self._closed = utterance.closed
        await self._send(written.lines, written.ends, utterance.closed)
        self._came.set()
        while len(self._log) > MAX_LOG and self._closed and not self._failure:
            self._rested.clear()
            await self._rested.wait()

    def _heard(self, phones: Sequence[Phone], ends: Sequence[int], following: Phone | None) -> list[int]:
        """Boundaries moved to where the database's own lie in its sound, by at most half a phone."""
        heard = list(ends)
        for i, (left, right) in enumerate(zip(phones, [*phones[1:], following], strict=True)):
            if right is None:
                break
            shift = self._voice.heard_shift(left.name, right.name)
            length = ends[i] - (ends[i - 1] if i else 0)
            after = ends[i + 1] - ends[i] if i + 1 < len(ends) else length
            heard[i] += max(shift, -(length // 2)) if shift < 0 else min(shift, after // 2)
        return heard

    async def flush(self) -> None:
        """See the port."""
        if not self._closed:
            pause = Phone(SILENCE, CLOSING_MS)
            await self.write(Utterance("", (pause,), closed=True))

    async def finish(self) -> None:
        """See the port."""
        await self.flush()
        self._finished = True
        self._came.set()

    async def speech(self) -> AsyncIterator[Speech]:
        """See the port."""
        given = 0
        while True:
            self._came.clear()
            phones, self._phones = tuple(self._phones), []
            pcm = self._take(self._end - given)
            if phones or len(pcm):
                yield Speech(given, pcm, phones)
                given += len(pcm)
            elif self._failure:
                raise self._failure
            elif self._finished and given >= self._end:
                return
            else:
                await self._came.wait()

    async def aclose(self) -> None:
        """See the port."""
        if self._released:
            return
        self._released = True
        self._reader.cancel()
        await asyncio.gather(self._reader, return_exceptions=True)
        process, self._process = self._process, None
        if process:
            await self._pool.release(self._voice, process, reusable=False)

    @property
    def _kept(self) -> int:
        """Samples that the process may keep back."""
        return self._voice.period + sum(self._tail)

    @property
    def _end(self) -> int:
        """Sample up to which sound is sure to come."""
        return max(0, self._planned - self._voice.period)

    def _take(self, most: int) -> Pcm:
        pcm = np.concatenate(self._pcm) if self._pcm else np.zeros(0, np.int16)
        self._pcm.clear()
        if len(pcm) > most:
            self._pcm.append(pcm[most:])
        return pcm[:most]

    async def _send(self, lines: str, ends: Sequence[int], closed: bool) -> None:
        samples = ends[-1] if ends else 0
        self._tail.extend(end - start for start, end in pairwise([0, *ends]))
        if closed:
            lines += FLUSH
            self._tail.clear()
        async with self._writing:
            if self._failure:
                raise self._failure
            process = self._process or await self._resume()
            self._log.append(lines)
            self._flushed = closed
            self._planned += samples
            await process.write(lines, samples, self._kept)

    async def _read(self, process: MbrolaProcess) -> None:
        while not (self._flushed and not self._drop and process.owed < self._voice.period):
            pcm = await process.pcm()
            if pcm is None:
                await self._restarted()
                return
            skip = min(self._drop, len(pcm))
            self._drop -= skip
            if skip < len(pcm):
                self._pcm.append(amplified(pcm[skip:], self._voice.gain))
                self._got += len(pcm) - skip
                self._came.set()
        await self._rest(process)

    # from one process to the next

    async def _rest(self, process: MbrolaProcess) -> None:
        """All that was written is said, and it ends in a pause."""
        self._process = None
        self._remainder, self._log_start = process.owed, self._got
        self._log.clear()
        self._restarts = 0
        self._rested.set()
        await self._pool.release(self._voice, process, reusable=not process.worn)

    async def _resume(self) -> MbrolaProcess:
        """There is something to say again. Raises SynthesisError."""
        try:
            process = self._process = await self._pool.take(self._voice)
        except SynthesisError as error:
            self._fail(error)
            raise
        await process.renew(self._voice, self._remainder)
        self._hold(process)
        return process

    async def _restarted(self) -> None:
        """The program died: another says again what this one has or had to say, and goes on."""
        async with self._writing:
            dead = self._process
            if dead is None:
                return
            self._restarts += 1
            try:
                if self._restarts > MAX_RESTARTS:
                    complaint = dead.complaint.decode("ascii", "replace").strip()
                    raise SynthesisError(f"MBROLA died {self._restarts} times in one phrase: {complaint}")
                self._process = None
                process = self._process = await self._pool.replaced(self._voice, dead)
            except SynthesisError as error:
                self._fail(error)
                return
            await process.renew(self._voice, self._remainder)
            self._hold(process)
            self._drop += self._got - self._log_start
            left = self._planned - self._log_start - self._remainder
            process.send("".join(self._log), left, self._kept)

    def _fail(self, error: SynthesisError) -> None:
        self._failure = error
        self._came.set()
        self._rested.set()


def amplified(pcm: Pcm, gain: float) -> Pcm:
    """Sound made louder or softer, clipped to 16 bits."""
    if gain == 1.0:
        return pcm
    louder: Pcm = np.clip(np.rint(pcm * gain), -32768, 32767).astype(np.int16)
    return louder


class MbrolaPool:
    """Warm processes of each voice."""

    def __init__(
        self, limits: Limits | None = None, budget: Budget | None = None, on_event: OnEvent = ignore
    ) -> None:
        self._limits, self._on_event = limits, on_event
        self._budget = budget or Budget(on_event=on_event)
        self._spares: dict[str, Spares[MbrolaProcess]] = {}

    async def warm(self, voice: Voice) -> None:
        """Start a spare, so that the first turn finds it running. Raises SynthesisError."""
        await self._of(voice).warm()

    async def acquire(self, voice: Voice) -> MbrolaSynthesizer:
        """A voice ready for one turn. Raises SynthesisError."""
        process = await self.take(voice)
        try:
            await process.renew(voice)
        except BaseException:
            await self.release(voice, process, reusable=False)
            raise
        return MbrolaSynthesizer(self, process, voice)

    async def take(self, voice: Voice) -> MbrolaProcess:
        """A process, first come, first served. Raises SynthesisError."""
        return await self._of(voice).take()

    async def release(self, voice: Voice, process: MbrolaProcess, reusable: bool) -> None:
        """Take a process back, or end it."""
        await self._of(voice).give_back(process, reusable)

    async def replaced(self, voice: Voice, process: MbrolaProcess) -> MbrolaProcess:
        """Another for one that died. Raises SynthesisError."""
        self._on_event("restart")
        return await self._of(voice).replaced(process)

    async def aclose(self) -> None:
        """End every idle process."""
        for spares in self._spares.values():
            await spares.aclose()

    def _of(self, voice: Voice) -> Spares[MbrolaProcess]:
        found = self._spares.get(voice.name)
        if found is None:
            start = partial(MbrolaProcess.start, voice, self._on_event)
            found = self._spares[voice.name] = Spares(start, self._limits, self._budget)
        return found
