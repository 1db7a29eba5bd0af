"""Stand-ins for the outside world: a voice that makes a ramp of samples, its pool, time that is free."""

from __future__ import annotations

import asyncio
import functools
import selectors
from collections.abc import AsyncIterator, Callable, Coroutine, Sequence
from typing import Any

import numpy as np

from fapstream.errors import SynthesisError, UnknownLanguage, UnknownVoice
from fapstream.records import SILENCE, Phone, Speech, TimedPhone, Utterance
from fapstream.tts import LANGUAGES
from fapstream.tts.voices import Voice, default_voice, voices


class _Selector:
    """Looks at the sockets and, where a loop would wait for them, moves its clock instead."""

    def __init__(self) -> None:
        self.now = 0.0
        self._inner = selectors.DefaultSelector()

    def select(self, timeout: float | None = None) -> Any:
        ready = self._inner.select(0)
        if not ready:
            assert timeout is not None, "everybody waits for ever"
            self.now += max(timeout, 0.0)
        return ready

    def __getattr__(self, name: str) -> Any:
        return getattr(self._inner, name)


class VirtualLoop(asyncio.SelectorEventLoop):
    """An event loop whose time goes by only while everybody waits."""

    def __init__(self) -> None:
        self._virtual = _Selector()
        super().__init__(self._virtual)  # type: ignore[arg-type]

    def time(self) -> float:
        return self._virtual.now


def in_virtual_time(test: Callable[..., Coroutine[Any, Any, None]]) -> Callable[..., None]:
    """Run an asynchronous test in a loop of that kind."""

    @functools.wraps(test)
    def run(*args: Any, **kwargs: Any) -> None:
        with asyncio.Runner(loop_factory=VirtualLoop) as runner:
            runner.run(test(*args, **kwargs))

    return run


class LoopClock:
    """The Clock port on the loop's own time."""

    def now(self) -> float:
        return asyncio.get_running_loop().time()

    async def sleep_until(self, when: float) -> None:
        await asyncio.sleep(max(0.0, when - self.now()))


def timed(
    phones: Sequence[Phone], sample_rate: int, start: int = 0, utterance: Utterance | None = None
) -> tuple[TimedPhone, ...]:
    """Phones that last exactly as long as they wish, from `start` on."""
    out = []
    for phone in phones:
        end = start + round(phone.duration_ms * sample_rate / 1000)
        word = utterance.words[phone.word] if utterance and phone.word >= 0 else None
        out.append(TimedPhone(phone, start, end, word))
        start = end
    return tuple(out)


class FakeVoice:
    """A Synthesizer whose PCM counts its samples (modulo 2^15), so that any gap can be seen."""

    def __init__(self, sample_rate: int = 16000, fail: Callable[[str], None] | None = None) -> None:
        self.sample_rate = sample_rate
        self.written: list[Utterance] = []
        self.flushes = 0
        self.closes = 0
        self._fail = fail or (lambda _: None)
        self._at = 0
        self._todo: list[Speech] = []
        self._came = asyncio.Event()
        self._finished = False

    async def write(self, utterance: Utterance) -> None:
        self._fail("write")
        self.written.append(utterance)
        phones = timed(utterance.phones, self.sample_rate, self._at, utterance)
        end = phones[-1].end if phones else self._at
        pcm = (np.arange(self._at, end) % 32768).astype(np.int16)
        self._todo.append(Speech(self._at, pcm, phones))
        self._at = end
        self._came.set()

    async def flush(self) -> None:
        self.flushes += 1
        await self.write(Utterance("", (Phone(SILENCE, 80.0),)))

    async def finish(self) -> None:
        self._finished = True
        self._came.set()

    async def speech(self) -> AsyncIterator[Speech]:
        while True:
            self._came.clear()
            while self._todo:
                self._fail("speech")
                yield self._todo.pop(0)
            if self._finished:
                return
            await self._came.wait()

    async def aclose(self) -> None:
        await asyncio.sleep(0)
        self.closes += 1


class FakeVoices:
    """A pool of such voices; `fail` is handed to every voice, `acquired` keeps them all."""

    def __init__(self, fail: Callable[[str], None] | None = None) -> None:
        self.acquired: list[FakeVoice] = []
        self.fail = fail

    def all(self) -> tuple[Voice, ...]:
        return voices()

    def find(self, name: str | None, lang: str | None) -> Voice:
        if name is not None:
            for v in voices():
                if v.name == name:
                    return v
            raise UnknownVoice(name, tuple(v.name for v in voices()))
        if lang not in LANGUAGES:
            raise UnknownLanguage(str(lang), LANGUAGES)
        return default_voice(lang)

    async def acquire(self, voice: Voice) -> FakeVoice:
        made = FakeVoice(voice.sample_rate, self.fail)
        self.acquired.append(made)
        return made


class Failing:
    """Raises SynthesisError at the n-th call that has the given name, once."""

    def __init__(self, where: str, n: int = 1) -> None:
        self._where = where
        self._left = n

    def __call__(self, where: str) -> None:
        if where == self._where:
            self._left -= 1
            if self._left == 0:
                raise SynthesisError(f"the voice broke in {where}")
