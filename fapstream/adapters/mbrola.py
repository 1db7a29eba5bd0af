"""MBROLA as long-lived subprocesses behind the Synthesizer port.

What the program does with durations, flushes and its own delay is measured, not documented:
a phone of d ms yields trunc(float32(d) * F / 1000) samples, sum n_i minus the samples emitted stays within
[0, P) for ever (P: the database's period), and the sound of boundary G_i is heard at G_i + P.
"""

from __future__ import annotations

import asyncio
import os
from collections import deque
from collections.abc import AsyncIterator, Sequence
from contextlib import suppress
from pathlib import Path
from shutil import which

import numpy as np

from fapstream.adapters.spares import READ_BYTES, Spares, end_program
from fapstream.errors import SynthesisError, VoiceUnavailable
from fapstream.records import SILENCE, Pcm, Phone, Speech, TimedPhone, Utterance
from fapstream.tts import pho
from fapstream.tts.pho import Realiser
from fapstream.tts.realise import VoicePhone
from fapstream.tts.voices import Voice

DATABASES = (Path("/usr/share/mbrola"), Path("/usr/local/share/mbrola"))
"""Folders that hold V/V for voice V."""

LIBSTDBUF = (Path("/usr/libexec/coreutils/libstdbuf.so"), Path("/usr/lib/coreutils/libstdbuf.so"))
"""Preloaded, it makes the C library write sound at once instead of 4096 bytes later."""

MAX_RESTARTS = 3
CLOSING_MS = 80
"""Silence that closes a phrase which has to be flushed in its middle."""

FLUSH = "#\n"


def database(voice: Voice) -> Path | None:
    """Where a voice's database is; None if it or the program is missing."""
    if which("mbrola") is None:
        return None
    return next(
        (d / voice.name / voice.name for d in DATABASES if (d / voice.name / voice.name).is_file()), None
    )


class MbrolaProcess:
    """One running MBROLA, and how many samples it was asked for and gave."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process
        self.written = 0
        self.read = 0
        self.complaint = b""
        self._stderr = asyncio.create_task(self._drain_stderr())

    @classmethod
    async def start(cls, voice: Voice) -> MbrolaProcess:
        """A process ready to speak. Raises VoiceUnavailable."""
        path = database(voice)
        if path is None:
            raise VoiceUnavailable(
                f"MBROLA or its voice {voice.name} is not installed; tools/run installs both on Debian"
            )
        env = dict(os.environ)
        preload = next((str(p) for p in LIBSTDBUF if p.exists()), None)
        if preload:
            env.update(LD_PRELOAD=preload, _STDBUF_O="0")
        pipe = asyncio.subprocess.PIPE
        process = await asyncio.create_subprocess_exec(
            "mbrola", "-e", "-v", str(voice.drive), str(path), "-", "-.raw",
            stdin=pipe, stdout=pipe, stderr=pipe, env=env,
        )  # fmt: skip
        return cls(process)

    @property
    def alive(self) -> bool:
        """Whether the program still runs."""
        return self._process.returncode is None

    @property
    def pid(self) -> int:
        """Its process id."""
        return self._process.pid

    @property
    def owed(self) -> int:
        """Samples asked for and not received."""
        return self.written - self.read

    def send(self, lines: str, samples: int) -> None:
        """Send lines worth so many samples. A dead process is noticed by `pcm`."""
        assert self._process.stdin is not None
        self.written += samples
        with suppress(ConnectionError):
            self._process.stdin.write(lines.encode("ascii"))

    async def write(self, lines: str, samples: int) -> None:
        """Send lines, waiting while the program is busy."""
        assert self._process.stdin is not None
        self.send(lines, samples)
        with suppress(ConnectionError):
            await self._process.stdin.drain()

    async def renew(self, voice: Voice) -> None:
        """Fill up the period begun in silence: from here on it gives the bytes that a new process would."""
        n = voice.period - self.owed
        if n < voice.period:
            pause = VoicePhone(SILENCE, n, ((0.0, voice.f0_hz),), ())
            await self.write(pho.line(pause, voice.sample_rate) + FLUSH, n)

    async def pcm(self) -> Pcm | None:
        """Sound as it comes; None when the program has ended."""
        assert self._process.stdout is not None
        data = await self._process.stdout.read(READ_BYTES)
        if len(data) % 2:
            with suppress(asyncio.IncompleteReadError):
                data += await self._process.stdout.readexactly(1)
        if not data:
            return None
        pcm = np.frombuffer(data[: len(data) // 2 * 2], "<i2").astype(np.int16)
        self.read += len(pcm)
        return pcm

    async def aclose(self) -> None:
        """End the program."""
        await end_program(self._process)
        self._stderr.cancel()

    async def _drain_stderr(self) -> None:
        assert self._process.stderr is not None
        while data := await self._process.stderr.read(4096):
            self.complaint = (self.complaint + data)[-2048:]


class MbrolaSynthesizer:
    """One turn spoken by an MBROLA process.

    Sample 0 of the turn is the process's sample `written` at the start: what the process still
    owes of the time before (a period of silence) is dropped. What the turn gives ends a period before
    what was asked for, because the program may keep back as much.
    """

    def __init__(self, pool: MbrolaPool, process: MbrolaProcess, voice: Voice) -> None:
        self.sample_rate = voice.sample_rate
        self._pool = pool
        self._process = process
        self._voice = voice
        self._realiser = Realiser(voice)
        self._planned = 0
        """Samples of the turn asked for."""
        self._heard_end = voice.period
        """Where the last phone ends."""
        self._got = 0
        """Samples of the turn received."""
        self._drop = process.owed
        """Samples that the process owes and nobody wants."""
        self._finished = False
        self._closed = True
        self._released = False
        self._log: list[str] = []
        """Everything written, to be said again by the next process if this one dies."""
        self._restarts = 0
        self._phones: list[TimedPhone] = []
        self._pcm: deque[Pcm] = deque()
        self._came = asyncio.Event()
        self._failure: SynthesisError | None = None
        self._writing = asyncio.Lock()
        self._reader = asyncio.create_task(self._read())

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
        if written.phones:
            await self._send(written.lines, written.ends[-1])
        if utterance.closed:
            await self._send(FLUSH, 0)
        self._came.set()

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
        with suppress(asyncio.CancelledError):
            await self._reader
        done = self._finished and not self._failure and self._process.owed < self._voice.period
        await self._pool.release(self._voice, self._process, reusable=done)

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

    async def _send(self, lines: str, samples: int) -> None:
        async with self._writing:
            self._log.append(lines)
            self._planned += samples
            await self._process.write(lines, samples)

    async def _read(self) -> None:
        while True:
            pcm = await self._process.pcm()
            if pcm is None:
                if not await self._restarted():
                    return
                continue
            skip = min(self._drop, len(pcm))
            self._drop -= skip
            if skip < len(pcm):
                self._pcm.append(amplified(pcm[skip:], self._voice.gain))
                self._got += len(pcm) - skip
                self._came.set()

    async def _restarted(self) -> bool:
        """The program died: a new one says the turn again, and it goes on where it was.

        A fresh process gives the same bytes for the same lines, so nobody hears the seam.
        """
        async with self._writing:
            return await self._restart()

    async def _restart(self) -> bool:
        self._restarts += 1
        complaint = self._process.complaint.decode("ascii", "replace").strip()
        await self._process.aclose()
        try:
            if self._restarts > MAX_RESTARTS:
                raise SynthesisError(f"MBROLA died {self._restarts} times in one turn: {complaint}")
            self._process = await MbrolaProcess.start(self._voice)
        except SynthesisError as e:
            self._failure = e
            self._came.set()
            return False
        self._drop = self._got
        self._process.send("".join(self._log), self._planned)
        return True


def amplified(pcm: Pcm, gain: float) -> Pcm:
    """Sound made louder or softer, clipped to 16 bits."""
    if gain == 1.0:
        return pcm
    louder: Pcm = np.clip(np.rint(pcm * gain), -32768, 32767).astype(np.int16)
    return louder


class MbrolaPool:
    """Warm processes of each voice."""

    def __init__(self) -> None:
        self._spares: dict[str, Spares[MbrolaProcess]] = {}

    async def warm(self, voice: Voice) -> None:
        """Start a spare, so that the first turn finds it running. Raises VoiceUnavailable."""
        await self._of(voice).warm()

    async def acquire(self, voice: Voice) -> MbrolaSynthesizer:
        """A voice ready for one turn. Raises VoiceUnavailable."""
        process = await self._of(voice).take()
        await process.renew(voice)
        return MbrolaSynthesizer(self, process, voice)

    async def release(self, voice: Voice, process: MbrolaProcess, reusable: bool) -> None:
        """Take a process back, or end it."""
        await self._of(voice).give_back(process, reusable)

    async def aclose(self) -> None:
        """End every idle process."""
        for spares in self._spares.values():
            await spares.aclose()

    def _of(self, voice: Voice) -> Spares[MbrolaProcess]:
        return self._spares.setdefault(voice.name, Spares(lambda: MbrolaProcess.start(voice)))
