"""Sound out through PyAudio (the extra `play`)."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

from fapstream.errors import FapstreamError
from fapstream.records import Pcm

BUFFER_MS = 20


class AudioUnavailable(FapstreamError):
    """There is no way to play sound here."""

    code = "no_audio"


Render = Callable[[int, float], Pcm]
"""(n, time): the next n samples, the first of which will be heard at `time` of the device's clock, s."""


class Output:
    """A sound device that fetches mono int16 sound with `render`, in a thread of its own."""

    def __init__(self, sample_rate: int, render: Render, buffer_ms: int = BUFFER_MS) -> None:
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


def _open(sample_rate: int, callback: Any, buffer_ms: int) -> tuple[Any, Any]:
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
