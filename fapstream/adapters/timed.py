"""Another voice behind the Synthesizer port: one that times its phones itself, from a file or a program.

JSON lines, UTF-8. The first line is `{"sample_rate": 22050}`. Then, in order:

    {"phone": "a", "start": 0.120, "duration": 0.085}   a phone of the language (`fapstream phonemes`),
    seconds {"pcm": "..."}                                      sound: base64 of little-endian int16, mono

Sounds follow each other without a gap from 0 s on, and no phone comes later than the sound in which it
begins. A program is given, a line each, what is to be said, and ends when its input does:

    {"lang": "en", "closed": true, "words": ["Hello"],
     "phones": [{"phone": "h", "duration": 0.07, "pitch": [[0, 120.0]], "stress": 0, "word": 0}, ...]}

`pitch` is (percent of the duration, Hz). `closed`: a pause follows. Words and gains of the planned phones go
with the timed ones of the same name, in order; a voice may leave phones out or add some.
"""

from __future__ import annotations

import asyncio
import base64
import binascii
import json
import shlex
from collections import deque
from collections.abc import AsyncIterator, Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from fapstream.adapters.spares import end_program
from fapstream.errors import SynthesisError, VoiceUnavailable
from fapstream.records import SILENCE, Pcm, Phone, Speech, TimedPhone, Utterance, Word
from fapstream.tts import phone_set

MAX_LINE = 1 << 20
"""Bytes of a line."""
MAX_SECONDS = 3600.0
"""No turn is longer."""
RATES = (8000, 48000)
OPEN_S = 20.0
"""So long a program may take until it says its sample rate."""
NEAR = 6
"""A timed phone is looked for among so many planned ones."""


class TimedVoice:
    """One turn of a voice that gives JSON lines; see the module."""

    def __init__(self, lines: AsyncIterator[bytes], name: str, lang: str, sample_rate: int) -> None:
        """`lines`: from the second on; `name`: for messages."""
        self.sample_rate = sample_rate
        self._lines = lines
        self._name = name
        self._known = phone_set(lang)
        self._number = 1
        self._planned: deque[tuple[Phone, Word | None]] = deque()
        self._program: asyncio.subprocess.Process | None = None
        self._complete = asyncio.Event()
        """Everything planned is known: a file is read only then, a program when it likes."""

    @classmethod
    async def read(cls, path: Path, lang: str) -> TimedVoice:
        """What a file holds. Raises SynthesisError, OSError."""
        rows = path.read_bytes().splitlines()
        return await cls._opened(_each(rows), str(path), lang)

    @classmethod
    async def run(cls, command: str, lang: str) -> TimedVoice:
        """A program that is told what to say. Raises VoiceUnavailable, SynthesisError."""
        pipe = asyncio.subprocess.PIPE
        try:
            program = await asyncio.create_subprocess_exec(
                *shlex.split(command), stdin=pipe, stdout=pipe, limit=MAX_LINE
            )
        except (OSError, ValueError) as error:
            raise VoiceUnavailable(f"the voice program {command!r} cannot be run: {error}") from error
        assert program.stdout
        try:
            async with asyncio.timeout(OPEN_S):
                voice = await cls._opened(_from(program.stdout), command, lang)
        except BaseException as error:
            await end_program(program)
            if isinstance(error, TimeoutError):
                raise VoiceUnavailable(f"{command!r} did not say its sample rate in {OPEN_S:g} s") from error
            raise
        voice._program = program
        return voice

    @classmethod
    async def _opened(cls, lines: AsyncIterator[bytes], name: str, lang: str) -> TimedVoice:
        first = await anext(lines, b"")
        voice = cls(lines, name, lang, RATES[0])
        row = voice._parsed(first)
        voice.sample_rate = voice._number_of(row, "sample_rate", *RATES, whole=True)
        return voice

    async def write(self, utterance: Utterance) -> None:
        """See the port. Raises SynthesisError when the program is gone."""
        for phone in utterance.phones:
            self._planned.append((phone, utterance.words[phone.word] if phone.word >= 0 else None))
        if self._program:
            await self._send(_described(utterance))

    async def flush(self) -> None:
        """See the port: a pause is all that is asked for; when to speak is the voice's own affair."""
        await self.write(Utterance("", (Phone(SILENCE, 80.0, hold=True),)))

    async def finish(self) -> None:
        """See the port."""
        self._complete.set()
        if self._program and self._program.stdin:
            self._program.stdin.close()

    async def speech(self) -> AsyncIterator[Speech]:
        """See the port."""
        at, end, phones = 0, 0, list[TimedPhone]()
        if not self._program:
            await self._complete.wait()
        async for line in self._lines:
            self._number += 1
            row = self._parsed(line)
            if "pcm" in row:
                pcm = self._pcm(row["pcm"])
                yield Speech(at, pcm, tuple(phones))
                at += len(pcm)
                phones.clear()
            else:
                timed = self._phone(row, end)
                if timed.start > end:
                    phones.append(TimedPhone(Phone(SILENCE, 0.0), end, timed.start))
                phones.append(timed)
                end = timed.end
        if phones:
            yield Speech(at, np.zeros(0, np.int16), tuple(phones))
        if self._program and await self._program.wait():
            raise SynthesisError(
                f"the voice program {self._name!r} ended with status {self._program.returncode}"
            )

    async def aclose(self) -> None:
        """See the port."""
        if self._program:
            await end_program(self._program)

    async def _send(self, row: dict[str, Any]) -> None:
        assert self._program
        assert self._program.stdin
        try:
            self._program.stdin.write(json.dumps(row, ensure_ascii=False).encode() + b"\n")
            await self._program.stdin.drain()
        except ConnectionError as error:
            raise SynthesisError(f"the voice program {self._name!r} takes no more") from error

    # what comes back

    def _parsed(self, line: bytes) -> dict[str, Any]:
        if len(line) > MAX_LINE:
            raise self._wrong(f"a line of more than {MAX_LINE} bytes")
        try:
            row = json.loads(line)
        except (ValueError, RecursionError) as error:
            raise self._wrong(f"not a line of JSON: {line[:60]!r}") from error
        if not isinstance(row, dict):
            raise self._wrong(f"not an object: {line[:60]!r}")
        return row

    def _phone(self, row: dict[str, Any], floor: int) -> TimedPhone:
        name = row.get("phone")
        if not isinstance(name, str) or name not in self._known:
            raise self._wrong(f"phone is {name!r}; there are: {' '.join(self._known)}")
        start = round(self._number_of(row, "start", 0.0, MAX_SECONDS) * self.sample_rate)
        length = round(self._number_of(row, "duration", 0.0, MAX_SECONDS) * self.sample_rate)
        planned, word = self._match(name)
        phone = planned._replace(duration_ms=1000.0 * length / self.sample_rate)
        start = max(start, floor)
        return TimedPhone(phone, start, max(start, start + length), word)

    def _match(self, name: str) -> tuple[Phone, Word | None]:
        """The planned phone of that name that is next, and its word; planned ones before it were left out."""
        for k, (phone, word) in enumerate(list(self._planned)[:NEAR]):
            if phone.name == name:
                for _ in range(k + 1):
                    self._planned.popleft()
                return phone, word
        return Phone(name, 0.0), None

    def _pcm(self, text: Any) -> Pcm:
        try:
            data = base64.b64decode(text, validate=True)
        except (binascii.Error, TypeError, ValueError) as error:
            raise self._wrong("pcm is not base64") from error
        if len(data) % 2:
            raise self._wrong(f"pcm of {len(data)} bytes is no int16")
        return np.frombuffer(data, "<i2").astype(np.int16)

    def _number_of(self, row: dict[str, Any], name: str, low: float, high: float, whole: bool = False) -> Any:
        value = row.get(name)
        kinds = int if whole else (int, float)
        if isinstance(value, kinds) and not isinstance(value, bool) and low <= value <= high:
            return value
        raise self._wrong(f"{name} is {value!r}; a number from {low:g} to {high:g} is expected")

    def _wrong(self, reason: str) -> SynthesisError:
        return SynthesisError(f"{self._name}, line {self._number}: {reason}")


def _described(utterance: Utterance) -> dict[str, Any]:
    return {
        "lang": utterance.lang,
        "closed": utterance.closed,
        "words": [word.text for word in utterance.words],
        "phones": [
            {
                "phone": p.name,
                "duration": round(p.duration_ms / 1000.0, 6),
                "pitch": [[round(at, 2), round(hz, 2)] for at, hz in p.pitch],
                "stress": p.stress,
                "word": p.word,
            }
            for p in utterance.phones
        ],
    }


async def _each(rows: Iterable[bytes]) -> AsyncIterator[bytes]:
    for row in rows:
        if row.strip():
            yield row


async def _from(stream: asyncio.StreamReader) -> AsyncIterator[bytes]:
    """Lines as they come; one that is too long ends it with a line that is too long."""
    with suppress(ConnectionError):
        while True:
            try:
                line = await stream.readline()
            except ValueError:
                yield b" " * (MAX_LINE + 1)
                return
            if not line:
                return
            if line.strip():
                yield line
