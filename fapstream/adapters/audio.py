"""Sound out through PyAudio (the extra `play`)."""

from __future__ import annotations

import os
import threading
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

from fapstream.errors import FapstreamError
from fapstream.records import Pcm

FRAMES_PER_BUFFER_MS = 10


class AudioUnavailable(FapstreamError):
    """There is no way to play sound here."""

    code = "no_audio"


Render = Callable[[int, float], Pcm]
"""(n, time): the next n samples, the first of which will be heard at `time` of the device's clock, s."""


class Output:
    """A sound device that fetches mono int16 sound with `render`, in a thread of its own."""

    def __init__(self, sample_rate: int, render: Render, buffer_ms: int = FRAMES_PER_BUFFER_MS) -> None:
        """`buffer_ms`: how much is fetched at once; some of these lie waiting. Raises AudioUnavailable."""
        self._render = render
        self.late = 0
        """Times the device was not served in time."""
        self._audio, self._stream = _open(sample_rate, self._callback, buffer_ms)

    def now(self) -> float:
        """The device's clock, seconds."""
        return float(self._stream.get_time())

    def poll(self) -> None:
        """Nothing to do: the device comes by itself."""

    def close(self) -> None:
        """Stop at once."""
        self._stream.close()
        self._audio.terminate()

    def _callback(self, _in: object, n: int, time: Mapping[str, float], status: int) -> tuple[bytes, int]:
        self.late += bool(status)
        at = time["output_buffer_dac_time"] or time["current_time"]
        return self._render(n, at).astype(np.int16, copy=False).tobytes(), 0


class Player:
    """Plays mono int16 sound as it is given, silence where there is none.

    What was given to the device is heard when its latency, by its own figure, has gone by; silence
    played after the last sample counts towards that.
    """

    def __init__(self, sample_rate: int) -> None:
        self.sample_rate = sample_rate
        self._chunks: deque[Pcm] = deque()
        self._lock = threading.Lock()
        self._played = 0
        self._latency = 0
        self._silence = 0
        self.given = 0
        self.heard = 0
        """Samples heard."""
        try:
            self._audio, self._stream = _open(sample_rate, self._callback)
        except AudioUnavailable as e:
            raise AudioUnavailable(f"{e}; or write a file with --wav") from e
        self._latency = round(self._stream.get_output_latency() * sample_rate)

    def write(self, pcm: Pcm) -> None:
        """More sound; never blocks."""
        with self._lock:
            self._chunks.append(pcm)
            self.given += len(pcm)

    @property
    def idle(self) -> bool:
        """Everything given has been heard."""
        return self.heard >= self.given

    def close(self) -> None:
        """Stop at once."""
        self._stream.close()
        self._audio.terminate()

    def _callback(self, _in: object, n: int, _time: object, _status: int) -> tuple[bytes, int]:
        out = np.zeros(n, np.int16)
        filled = 0
        with self._lock:
            while filled < n and self._chunks:
                chunk = self._chunks.popleft()
                part = chunk[: n - filled]
                out[filled : filled + len(part)] = part
                filled += len(part)
                if len(part) < len(chunk):
                    self._chunks.appendleft(chunk[len(part) :])
            self._played += filled
            self._silence = n - filled if filled else self._silence + n
            self.heard = max(self.heard, self._played - max(0, self._latency - self._silence))
        return out.tobytes(), 0


def _open(sample_rate: int, callback: Any, buffer_ms: int = FRAMES_PER_BUFFER_MS) -> tuple[Any, Any]:
    try:
        import pyaudio
    except ImportError:
        raise AudioUnavailable("playing needs PyAudio: pip install 'fapstream[play]'") from None
    with _quiet():
        audio = pyaudio.PyAudio()
    try:
        with _quiet():
            stream = audio.open(
                rate=sample_rate, channels=1, format=pyaudio.paInt16, output=True,
                frames_per_buffer=sample_rate * buffer_ms // 1000, stream_callback=callback,
            )  # fmt: skip
    except OSError as e:
        audio.terminate()
        raise AudioUnavailable(f"no sound device can be opened ({e})") from e
    return audio, stream


@contextmanager
def _quiet() -> Iterator[None]:
    """PortAudio's back-ends print a hundred lines to stderr while they look for devices."""
    saved, null = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(null, 2)
        yield
    finally:
        os.dup2(saved, 2)
        os.close(saved)
        os.close(null)
