"""eSpeak NG, the embedded voice: a worker process behind the Synthesizer port.

Our phones are handed over as eSpeak's phoneme mnemonics; it decides how long they last and says when each
begins. Its events and our phones are matched in order, so whatever it inserts or merges moves no mark far.
"""

from __future__ import annotations

import asyncio
import importlib.util
import json
import math
import sys
from collections import deque
from collections.abc import AsyncIterator, Sequence
from typing import Any

import numpy as np

from fapstream.adapters.alignment import align, refine
from fapstream.adapters.espeak_worker import FRAME
from fapstream.adapters.spares import Budget, Limits, OnEvent, Spares, end_program, ignore
from fapstream.errors import SynthesisError, VoiceUnavailable
from fapstream.records import SILENCE, Pcm, Phone, Speech, TimedPhone, Utterance, Word
from fapstream.tts import espeak_map, phone_set
from fapstream.tts.voices import Voice

WORDS_PER_MINUTE = 175
MEAN_PHONE_MS = 80.0
"""How long a phone lasts on average at that rate; eSpeak's rate is set from what our phones wish for."""
RATE_LIMITS = (80, 450)
PITCH = 50
USUAL_PITCH = 0.12
"""A phrase whose mean pitch is this near to the voice's own is in its own pitch."""
MAX_FRAME = 1 << 24
MAX_OPEN_WORDS = 20
"""A phrase this long is spoken before its end is known."""
CLOSING_MS = 80
HANG_S = 10.0
"""A worker that says nothing for so long is taken for dead; it is hundreds of times faster than people."""
MAX_TODO = 2
"""So many phrases may wait to be spoken; then the writer waits."""


def installed() -> bool:
    """Whether the package with the library is there."""
    return importlib.util.find_spec("espeakng_loader") is not None


class EspeakProcess:
    """One worker."""

    def __init__(self, process: asyncio.subprocess.Process, on_event: OnEvent = ignore) -> None:
        self._process = process
        self._on_event = on_event

    @classmethod
    async def start(cls, on_event: OnEvent = ignore) -> EspeakProcess:
        """A worker that has read its data or will soon. Raises VoiceUnavailable, OSError."""
        if not installed():
            raise VoiceUnavailable("the embedded voice needs the extra fapstream[espeak]")
        pipe = asyncio.subprocess.PIPE
        process = await asyncio.create_subprocess_exec(
            sys.executable, "-m", "fapstream.adapters.espeak_worker", stdin=pipe, stdout=pipe
        )
        return cls(process, on_event)

    @property
    def alive(self) -> bool:
        """Whether the worker still runs."""
        return self._process.returncode is None

    async def speak(self, request: dict[str, Any]) -> tuple[Pcm, list[tuple[str, int]]]:
        """All sound of one request and its phoneme events. Raises SynthesisError."""
        assert self._process.stdin is not None
        sound, events = [b""], []
        try:
            async with asyncio.timeout(HANG_S):
                self._process.stdin.write(json.dumps(request).encode() + b"\n")
                await self._process.stdin.drain()
            while True:
                kind, body = await self._frame()
                match kind:
                    case "S":
                        sound.append(body)
                    case "P":
                        events += [(str(name), int(at)) for name, at in json.loads(body)]
                    case "X":
                        raise SynthesisError(f"eSpeak NG: {body.decode('utf-8', 'replace')}")
                    case _:
                        return np.frombuffer(b"".join(sound), "<i2").astype(np.int16), events
        except (asyncio.IncompleteReadError, ConnectionError, TimeoutError) as e:
            if isinstance(e, TimeoutError):
                self._on_event("hang")
            await self.aclose()
            raise SynthesisError("eSpeak NG ended in the middle of a phrase") from e

    async def _frame(self) -> tuple[str, bytes]:
        """Raises IncompleteReadError, TimeoutError."""
        assert self._process.stdout is not None
        async with asyncio.timeout(HANG_S):
            kind, size = FRAME.unpack(await self._process.stdout.readexactly(FRAME.size))
            return chr(kind), await self._process.stdout.readexactly(min(size, MAX_FRAME))

    async def aclose(self) -> None:
        """End the worker."""
        await end_program(self._process)


class EspeakSynthesizer:
    """One turn spoken by eSpeak NG, a phrase at a time: it gives each request a melody of its own.

    A worker is held only while there are phrases to say.
    """

    def __init__(self, pool: EspeakPool, process: EspeakProcess, voice: Voice) -> None:
        self.sample_rate = voice.sample_rate
        self._pool = pool
        self._process: EspeakProcess | None = process
        self._voice = voice
        self._todo: deque[Utterance] = deque()
        self._open: list[Utterance] = []
        """The beginning of a phrase."""
        self._finished = False
        self._came = asyncio.Event()
        self._room = asyncio.Event()
        self._listened = False
        """Somebody takes the speech, so there will be room."""
        self._clean = True
        self._released = False

    async def write(self, utterance: Utterance) -> None:
        """See the port."""
        self._open.append(utterance)
        if utterance.closed or sum(len(u.words) for u in self._open) >= MAX_OPEN_WORDS:
            self._todo.append(_joined(self._open))
            self._open.clear()
            self._came.set()
        while self._listened and len(self._todo) > MAX_TODO:
            self._room.clear()
            await self._room.wait()

    async def flush(self) -> None:
        """See the port. Nothing is held back; a pause lets the mouth close."""
        if self._open:
            await self.write(Utterance("", (Phone(SILENCE, CLOSING_MS),)))

    async def finish(self) -> None:
        """See the port."""
        await self.flush()
        self._finished = True
        self._came.set()

    async def speech(self) -> AsyncIterator[Speech]:
        """See the port."""
        at = 0
        self._listened = True
        while True:
            self._came.clear()
            while self._todo:
                utterance = self._todo.popleft()
                self._room.set()
                async for speech in self._say(utterance, at):
                    yield speech
                    at += len(speech.pcm)
            await self._rest()
            if self._finished:
                return
            await self._came.wait()

    async def aclose(self) -> None:
        """See the port."""
        if not self._released:
            self._released = True
            self._listened = False
            self._room.set()
            await self._rest()

    async def _rest(self) -> None:
        """Give the worker back."""
        process, self._process = self._process, None
        if process:
            await self._pool.release(process, reusable=self._clean)

    async def _say(self, utterance: Utterance, at: int) -> AsyncIterator[Speech]:
        for run in split_at_pauses(utterance.phones):
            if run[0].name == SILENCE:
                pcm = np.zeros(round(run[0].duration_ms * self.sample_rate / 1000), np.int16)
                starts = [0]
            else:
                pcm, starts = await self._speak_run(run)
            ends = [*starts[1:], len(pcm)]
            yield Speech(
                at,
                pcm,
                tuple(
                    TimedPhone(p, at + s, at + e, utterance.words[p.word] if p.word >= 0 else None)
                    for p, s, e in zip(run, starts, ends, strict=True)
                ),
            )
            at += len(pcm)

    async def _speak_run(self, run: Sequence[Phone]) -> tuple[Pcm, list[int]]:
        """Sound of phones without a pause among them, and where each begins."""
        request = _request(run, self._voice)
        wished_ms = sum(p.duration_ms for p in run)
        rate = WORDS_PER_MINUTE * MEAN_PHONE_MS * len(run) / max(wished_ms, 1.0)
        request["rate"] = round(min(max(rate, RATE_LIMITS[0]), RATE_LIMITS[1]))
        pcm, events = await self._exchange(request)
        end = next((at for name, at in reversed(events) if not name.startswith("_")), 0)
        end = next((at for name, at in events if name.startswith("_") and at > end), len(pcm))
        heard = [(name, at) for name, at in events if not name.startswith("_") and at < end]
        starts = align(espeak_map.mnemonics(run, self._voice), heard, end)
        known = [phone_set(self._voice.lang)[p.name] for p in run]
        kinds = [(info.kind, info.voiced) for info in known]
        return pcm[:end], refine(starts, kinds, pcm, self.sample_rate)

    async def _exchange(self, request: dict[str, Any]) -> tuple[Pcm, list[tuple[str, int]]]:
        """Ask the worker; one that died is replaced once, and says the phrase again."""
        process = self._process = self._process or await self._pool.take()
        self._clean = False
        try:
            answer = await process.speak(request)
        except SynthesisError:
            if process.alive:
                raise
            self._process = None
            process = self._process = await self._pool.replaced(process)
            answer = await process.speak(request)
        self._clean = True
        return answer


def _joined(utterances: Sequence[Utterance]) -> Utterance:
    """The pieces of a phrase as one. Sounds drawn out are left out: they would become syllables."""
    phones: list[Phone] = []
    words: list[Word] = []
    for utterance in utterances:
        for phone in utterance.phones:
            if not phone.hold or phone.name == SILENCE:
                phones.append(phone._replace(word=phone.word + len(words)) if phone.word >= 0 else phone)
        words += utterance.words
    return Utterance(utterances[-1].lang, tuple(phones), tuple(words), utterances[-1].closed)


def _request(run: Sequence[Phone], voice: Voice) -> dict[str, Any]:
    text = espeak_map.bracketed(run, voice)
    return {"voice": voice.engine_voice, "text": text, "rate": WORDS_PER_MINUTE, "pitch": _pitch(run, voice)}


def _pitch(run: Sequence[Phone], voice: Voice) -> int:
    """eSpeak NG's pitch, whose scale of 100 is two octaves; its own melody stays within the usual."""
    planned = [p.pitch[0][1] for p in run if p.pitch]
    ratio = sum(planned) / len(planned) / voice.f0_hz if planned else 1.0
    if abs(ratio - 1.0) < USUAL_PITCH:
        return PITCH
    return round(min(max(PITCH + 50 * math.log2(ratio), 0), 99))


def split_at_pauses(phones: Sequence[Phone]) -> list[list[Phone]]:
    """Runs of sounding phones, and each pause alone."""
    runs: list[list[Phone]] = []
    for phone in phones:
        if phone.name == SILENCE or not runs or runs[-1][0].name == SILENCE:
            runs.append([phone])
        else:
            runs[-1].append(phone)
    return runs


class EspeakPool:
    """Warm workers; any of them speaks any language."""

    def __init__(
        self, limits: Limits | None = None, budget: Budget | None = None, on_event: OnEvent = ignore
    ) -> None:
        self._on_event = on_event
        start = lambda: EspeakProcess.start(on_event)  # noqa: E731
        self._spares = Spares(start, limits, budget or Budget(on_event=on_event))

    async def warm(self) -> None:
        """Start a spare. Raises VoiceUnavailable."""
        await self._spares.warm()

    async def acquire(self, voice: Voice) -> EspeakSynthesizer:
        """A voice ready for one turn. Raises VoiceUnavailable."""
        return EspeakSynthesizer(self, await self.take(), voice)

    async def take(self) -> EspeakProcess:
        """A worker, first come, first served. Raises SynthesisError."""
        return await self._spares.take()

    async def release(self, process: EspeakProcess, reusable: bool) -> None:
        """Take a worker back, or end it."""
        await self._spares.give_back(process, reusable)

    async def replaced(self, process: EspeakProcess) -> EspeakProcess:
        """Another for one that died. Raises SynthesisError."""
        self._on_event("restart")
        return await self._spares.replaced(process)

    async def aclose(self) -> None:
        """End every idle worker."""
        await self._spares.aclose()
