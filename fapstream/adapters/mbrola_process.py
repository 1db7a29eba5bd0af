"""One MBROLA program: lines in, samples out, and a watch on whether it still answers.

What the program does with durations, flushes and its own delay is measured, not documented:
a phone of d ms yields trunc(float32(d) * F / 1000) samples, and sum n_i minus the samples emitted stays
within [0, P) for ever (P: the database's period).
"""

from __future__ import annotations

import asyncio
import os
from contextlib import suppress
from pathlib import Path
from shutil import which

import numpy as np

from fapstream.adapters.spares import READ_BYTES, OnEvent, end_program, ignore
from fapstream.errors import VoiceUnavailable
from fapstream.records import SILENCE, Pcm
from fapstream.tts import pho
from fapstream.tts.pho import FLUSH
from fapstream.tts.realise import VoicePhone
from fapstream.tts.voices import Voice

DATABASES = (Path("/usr/share/mbrola"), Path("/usr/local/share/mbrola"))
"""Folders that hold V/V for voice V."""

LIBSTDBUF = (Path("/usr/libexec/coreutils/libstdbuf.so"), Path("/usr/lib/coreutils/libstdbuf.so"))
"""Preloaded, it makes the C library write sound at once instead of 4096 bytes later."""

HANG_S = 1.0
"""A process that gives nothing for so long while it should is taken for dead."""

MAX_TURNS = 2000
MAX_BYTES = 32 << 20
"""A process that has been used so often, or has grown to so much memory, is not used again."""


def database(voice: Voice) -> Path | None:
    """Where a voice's database is; None if it or the program is missing."""
    if which("mbrola") is None:
        return None
    return next(
        (d / voice.name / voice.name for d in DATABASES if (d / voice.name / voice.name).is_file()), None
    )


class MbrolaProcess:
    """One running MBROLA, and how many samples it was asked for and gave.

    It writes whole periods, each at once and small enough never to be divided by the pipe. So when less than
    a period is owed after a flush in silence, that is what it keeps back, and nothing is still on its way.
    """

    def __init__(self, process: asyncio.subprocess.Process, on_event: OnEvent = ignore) -> None:
        self._process = process
        self._on_event = on_event
        self.written = 0
        self.read = 0
        self._due = 0
        """So many samples must come without anything else being written."""
        self._watch: asyncio.TimerHandle | None = None
        self._turns = 0
        self.complaint = b""
        self._stderr = asyncio.create_task(self._drain_stderr())

    @classmethod
    async def start(cls, voice: Voice, on_event: OnEvent = ignore) -> MbrolaProcess:
        """A process ready to speak. Raises VoiceUnavailable, OSError."""
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
        return cls(process, on_event)

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

    @property
    def worn(self) -> bool:
        """It has served long, or grown: another should take its place."""
        return self._turns >= MAX_TURNS or (self._turns % 64 == 0 and _resident_bytes(self.pid) > MAX_BYTES)

    def send(self, lines: str, samples: int, kept: int | None = None) -> None:
        """Send lines worth so many samples. Of all that were sent `kept` may be kept back until there are
        more; None: nobody knows how many.

        A dead process is noticed by `pcm`; one that gives nothing for a second while it should is killed.
        """
        assert self._process.stdin is not None
        self.written += samples
        if kept is not None:
            self._due = max(self._due, self.written - kept)
        if self._watch is None and self.read < self._due:
            self._look_later(-1)
        with suppress(ConnectionError):
            self._process.stdin.write(lines.encode("ascii"))

    async def write(self, lines: str, samples: int, kept: int | None = None) -> None:
        """Send lines, waiting while the program is busy."""
        assert self._process.stdin is not None
        self.send(lines, samples, kept)
        with suppress(ConnectionError):
            await self._process.stdin.drain()

    async def renew(self, voice: Voice, remainder: int = 0) -> None:
        """Fill up the period begun in silence: from here on it gives the bytes that a new process would, or
        one that has kept back `remainder` samples, less than a period, after a flush."""
        self._turns += 1
        n = (remainder - self.owed) % voice.period
        if n:
            pause = VoicePhone(SILENCE, n, ((0.0, voice.f0_hz),), ())
            await self.write(pho.line(pause, voice.sample_rate) + FLUSH, n, voice.period)

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
        if self._watch:
            self._watch.cancel()
        await end_program(self._process)
        self._stderr.cancel()

    def _look_later(self, seen: int) -> None:
        self._watch = asyncio.get_running_loop().call_later(HANG_S / 2, self._look, seen)

    def _look(self, seen: int) -> None:
        """Twice the same while more is due is a hang; once may be a loop that had no time to read."""
        self._watch = None
        if not self.alive or self.read >= self._due:
            return
        if self.read != seen:
            self._look_later(self.read)
            return
        self._on_event("hang")
        with suppress(ProcessLookupError):
            self._process.kill()

    async def _drain_stderr(self) -> None:
        assert self._process.stderr is not None
        while data := await self._process.stderr.read(4096):
            self.complaint = (self.complaint + data)[-2048:]


def _resident_bytes(pid: int) -> int:
    """Memory of a process; 0 where the system does not tell."""
    try:
        return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError, IndexError):
        return 0
