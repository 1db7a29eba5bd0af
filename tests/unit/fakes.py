"""Stand-ins for the outside world: a voice that makes a ramp of samples, its pool, time that is free."""

from __future__ import annotations

import asyncio
import functools
import selectors
from collections.abc import AsyncGenerator, AsyncIterator, Callable, Coroutine, Sequence
from typing import Any

import numpy as np

from fapstream.adapters.clock import MonotonicClock
from fapstream.errors import SynthesisError, UnknownLanguage, UnknownVoice
from fapstream.records import SILENCE, Phone, Speech, TimedPhone, Utterance
from fapstream.server import Adapting, App, Lobby, Service, Site
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


class FakeBus:
    """A bus within one test: every entry goes to all who subscribe; the newest are kept for late ones."""

    def __init__(self) -> None:
        self.entries: dict[str, list[bytes | None]] = {}
        self._queues: list[tuple[str, asyncio.Queue[bytes | None]]] = []

    def publish(self, channel: str, entry: bytes) -> None:
        self.inject(channel, entry)

    def inject(self, channel: str, entry: bytes | None) -> None:
        """An entry, or a gap."""
        self.entries.setdefault(channel, []).append(entry)
        for name, queue in self._queues:
            if name == channel:
                queue.put_nowait(entry)

    async def subscribe(self, channel: str) -> AsyncGenerator[bytes | None, None]:
        queue: asyncio.Queue[bytes | None] = asyncio.Queue()
        for entry in self.entries.get(channel, [])[-100:]:
            queue.put_nowait(entry)
        self._queues.append((channel, queue))
        try:
            while True:
                yield await queue.get()
        finally:
            self._queues.remove((channel, queue))

    @property
    def connected(self) -> bool:
        return True

    def on_state(self, tell: Callable[[bool], None]) -> None:
        pass

    async def aclose(self) -> None:
        pass


class OpenGate:
    """Lets everybody in, and counts."""

    def __init__(self) -> None:
        self.inside = 0

    def speak(self, hello: object, address: str) -> Callable[[], None]:
        return self._enter()

    def listen(self, wish: object, address: str) -> Callable[[], None]:
        return self._enter()

    def open(self, address: str) -> Callable[[], None]:
        return self._enter()

    def adapt(self, token: str | None, address: str) -> Callable[[], None]:
        return self._enter()

    def pace(self) -> Callable[[int], float]:
        return lambda size: 0.0

    def _enter(self) -> Callable[[], None]:
        self.inside += 1

        def leave() -> None:
            self.inside -= 1

        return leave


def fake_app(voices: FakeVoices | None = None, pages: Adapting | None = None) -> App:
    """A server of fake voices that lets everybody in, in real time."""
    service = Service(voices or FakeVoices(), MonotonicClock(), lambda: ("generic",))
    return App(service, Site(), Lobby(service, FakeBus(), ("news",)), OpenGate(), pages)
