"""Sound for the viewer: a turn's samples to the card, and the sample that is heard now."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Protocol

from fapstream.adapters.audio import BUFFER_MS, AudioUnavailable, Output, Render
from fapstream.records import Pcm
from fapstream.stream import Heard, Playback, PlayerStats

BUSY_BUFFER_MS = 100


class Device(Protocol):
    """What fetches the sound."""

    def now(self) -> float:
        """Seconds on the clock of which `render` is told."""

    def poll(self) -> None:
        """Called once a picture."""

    def close(self) -> None:
        """Stop at once."""


OpenDevice = Callable[[int, Render], Device]


class SilentDevice:
    """Keeps the time of a sound card that nobody hears."""

    def __init__(self, sample_rate: int, render: Render, clock: Callable[[], float] = time.monotonic) -> None:
        self._rate, self._render, self._clock = sample_rate, render, clock
        self._start = clock()
        self._fetched = 0

    def now(self) -> float:
        """See Device."""
        return self._clock()

    def poll(self) -> None:
        """Fetch what would have been heard by now."""
        due = int((self._clock() - self._start) * self._rate) - self._fetched
        if due > 0:
            self._render(due, self._start + self._fetched / self._rate)
            self._fetched += due

    def close(self) -> None:
        """See Device."""


def open_device(warn: Callable[[str], None], busy: bool = False) -> OpenDevice:
    """The sound card; where there is none, `warn` is told why and silence takes its place.

    `busy`: the processor is, with drawing; much sound lies waiting then, so that none is missed.
    """
    buffer_ms = BUSY_BUFFER_MS if busy else BUFFER_MS

    def open_(sample_rate: int, render: Render) -> Device:
        try:
            return Output(sample_rate, render, buffer_ms)
        except AudioUnavailable as e:
            warn(f"{e}; it goes on in silence")
            return SilentDevice(sample_rate, render)

    return open_


class Sound:
    """Turns of one sample rate, played in order. The device's thread and the viewer's share it."""

    def __init__(self, sample_rate: int, open_: OpenDevice) -> None:
        self.sample_rate = sample_rate
        self._playback = Playback(sample_rate)
        self._lock = threading.Lock()
        self._device = open_(sample_rate, self._render)

    @property
    def underruns(self) -> int:
        """Times that it ran dry."""
        return self.stats.underruns

    @property
    def stats(self) -> PlayerStats:
        """See Player."""
        with self._lock:
            return self._playback.player.stats

    def begin(self, turn: int, live: bool = False) -> None:
        """See Player."""
        with self._lock:
            self._playback.player.begin(turn, live)

    def push(self, turn: int, sample: int, pcm: Pcm, hold: bool) -> None:
        """See Player."""
        with self._lock:
            self._playback.player.push(turn, sample, pcm, hold)

    def end(self, turn: int) -> None:
        """See Player."""
        with self._lock:
            self._playback.player.end(turn)

    def discard(self, turn: int, sample: int) -> None:
        """See Player."""
        with self._lock:
            self._playback.player.discard(turn, sample)

    def pause(self, on: bool) -> None:
        """See Player."""
        with self._lock:
            self._playback.player.pause(on)

    def heard(self, later_s: float = 0.0) -> Heard | None:
        """What is heard now, or will be in a moment."""
        self._device.poll()
        with self._lock:
            return self._playback.heard(self._device.now() + later_s)

    def close(self) -> None:
        """Stop at once."""
        self._device.close()

    def _render(self, n: int, heard_s: float) -> Pcm:
        with self._lock:
            return self._playback.render(n, heard_s)
