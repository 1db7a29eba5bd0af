"""A mouth that says what it hears: articulatory parameters by regression on the sound, 0.2 s behind it.

What is heard every 10 ms: the energies of 24 bands from 100 to 3800 Hz, equally far apart in mel, as
logarithms, less a reference that follows the loudness of whoever speaks. From 150 ms on either side of an
instant a small network makes the parameters that a person's face had with such sound (learn/hearing.py); they
are smoothed, and where nobody speaks the mouth comes to rest. Nothing here is told by phones: lips need not
meet in p, b and m.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fapstream.motion.articulation import COLUMNS, Articulation
from fapstream.motion.mixer import Mouth
from fapstream.motion.spline import STEP_S
from fapstream.records import N_FAPS, Pcm, TimedPhone

Floats = NDArray[np.float64]

FRAME_S, WINDOW_S = 0.01, 0.025
BANDS, LOWEST_HZ, HIGHEST_HZ = 24, 100.0, 3800.0
"""Of 8 kHz sound there is no more, and lips are told by formants."""
REACH, APART = 15, 3
"""Frames on either side of an instant that count, and every which of them."""
STACKED = 2 * REACH // APART + 1
DEEP = 9.0
"""Bands more than so many nats below the reference are silent."""
ABOVE = 8.0
"""What is heard is less than speech until it is so many nats above the quietest that was heard."""
FALL, RISE = 0.3, 1.0
"""Nats a second: how fast the loudest sinks that was heard, and how fast the quietest rises."""
QUIETEST = 3.0
"""Nats of squared samples: no recording is quieter."""
SPEECH = (-6.5, -4.5)
"""Nats from the reference between which somebody begins to speak."""
LATER = (REACH + 1) // 2 - 1
"""Instants after one whose sound counts."""
SMOOTH = np.hanning(7)[1:-1] / np.hanning(7)[1:-1].sum()
"""Of the five instants around each."""
HANG, EASE = 2, 2
"""Somebody who speaks so many instants before or after one speaks; and what speaks is a mean of so many
more."""


@dataclass(frozen=True, slots=True)
class Heard:
    """The network: `mean`, `scale`, shape (STACKED x BANDS,), of what goes in; `hidden`, shape (in + 1,
    units), and `out`, shape (units + 1, parameters), whose last rows are added."""

    mean: Floats
    scale: Floats
    hidden: Floats
    out: Floats

    def parameters(self, stacked: Floats) -> Floats:
        """Of one instant (in,), shape (parameters,), or of many."""
        x = (stacked - self.mean) / self.scale
        inner = np.tanh(x @ self.hidden[:-1] + self.hidden[-1])
        found: Floats = inner @ self.out[:-1] + self.out[-1]
        return found


def _edges() -> Floats:
    """Where every band begins, which is where the one before it is highest, and the last one ends, Hz."""
    low, high = 1127 * np.log1p(np.array([LOWEST_HZ, HIGHEST_HZ]) / 700)
    found: Floats = 700 * np.expm1(np.linspace(low, high, BANDS + 2) / 1127)
    return found


def centres() -> Floats:
    """Where every band is highest, Hz."""
    return _edges()[1:-1]


@cache
def _bands(rate: int) -> tuple[Floats, Floats]:
    """The window, and weights of the spectrum's lines, shape (lines, BANDS), so that each band is a mean of
    squared samples, whatever the rate."""
    n = round(WINDOW_S * rate)
    window = np.hanning(n + 2)[1:-1]
    size = 1 << (n - 1).bit_length()
    hz = np.fft.rfftfreq(size, 1 / rate)
    edges = _edges()
    up = (hz[:, None] - edges[:-2]) / (edges[1:-1] - edges[:-2])
    down = (edges[2:] - hz[:, None]) / (edges[2:] - edges[1:-1])
    shape = np.maximum(0.0, np.minimum(up, down))
    return window, shape / shape.sum(axis=0) / (window**2).sum() * (16_000 / rate)


class Listener:
    """Sound to frames: the bands' logarithms, less the reference, and how loud it is, one every 10 ms."""

    def __init__(self, rate: int) -> None:
        self._rate = rate
        self._window, self._weights = _bands(rate)
        self._size = 2 * (len(self._weights) - 1)
        self._kept = np.zeros(len(self._window) // 2)
        """Sound from the beginning of the next window on; the first one is half before the beginning."""
        self._from = -len(self._kept)
        self._frame = 0
        self._loudest, self._quietest = QUIETEST, 99.0

    def add(self, pcm: Pcm) -> None:
        """More sound."""
        self._kept = np.concatenate([self._kept, pcm])

    def frames(self, last: bool = False) -> list[tuple[Floats, float]]:
        """Those that are complete, two at a time: bands (2, BANDS), and the louder one's nats from the
        reference. `last`: silence follows."""
        found = []
        if last:
            self._kept = np.concatenate([self._kept, np.zeros(len(self._window))])
        n = len(self._window)
        while (start := self._start(self._frame + 1)) + n <= self._from + len(self._kept):
            first = self._start(self._frame) - self._from
            second = start - self._from
            found.append(
                self._heard(np.stack([self._kept[first : first + n], self._kept[second : second + n]]))
            )
            self._frame += 2
            done = self._start(self._frame) - self._from
            if done > 0:
                self._kept = self._kept[done:]
                self._from += done
        return found

    def _start(self, frame: int) -> int:
        """The first sample of a frame's window, whose middle is the frame's instant."""
        return round(frame * FRAME_S * self._rate) - len(self._window) // 2

    def _heard(self, sound: Floats) -> tuple[Floats, float]:
        power = np.abs(np.fft.rfft(sound * self._window, self._size)) ** 2 @ self._weights
        bands = np.log(power + np.exp(QUIETEST))
        loudness = np.log(power.mean(axis=1) + np.exp(QUIETEST))
        loud = float(loudness.max())
        self._quietest = min(loud, self._quietest + RISE * STEP_S)
        self._loudest = max(loud, self._loudest - FALL * STEP_S)
        reference = max(self._loudest, self._quietest + ABOVE, QUIETEST + ABOVE)
        return np.maximum(bands - reference, -DEEP), loud - reference


class HearingMouth:
    """See `MouthTrack`; but it is told by sound and not by phones. `delay_s`: so much later than the sound
    the mouth is known."""

    delay_s = 2 * (LATER + len(SMOOTH) // 2 + 1) * FRAME_S + WINDOW_S / 2

    def __init__(self, rate: int, heard: Heard, articulation: Articulation, gain: float = 1.0) -> None:
        self._rate, self._heard, self._articulation, self._gain = rate, heard, articulation, gain
        self._listener = Listener(rate)
        silent = np.full(BANDS, -DEEP)
        self._frames = deque([silent] * (2 * REACH + 1), maxlen=2 * REACH + 1)
        self._speech = deque(
            [0.0] * (2 * (HANG + EASE) + 1 + self._behind), maxlen=2 * (HANG + EASE) + 1 + self._behind
        )
        self._raw: deque[Floats] = deque(maxlen=len(SMOOTH))
        """FAPs of the last instants, not smoothed."""
        self._taken = 0
        """Instants heard."""
        self._rows: deque[tuple[Floats, float]] = deque()
        """FAPs, and whether somebody speaks, of instants that are told or can be."""
        self._first = 0
        """The instant of the first of them."""
        self._samples = 0
        self._ended = False

    @property
    def _behind(self) -> int:
        """Instants heard after the one whose row is made, less those that its speech looks at."""
        return LATER + len(SMOOTH) // 2 - HANG - EASE

    def hear(self, pcm: Pcm) -> None:
        """More sound, int16 (n,)."""
        self._samples += len(pcm)
        self._listener.add(pcm)
        self._take(self._listener.frames())

    def end(self) -> None:
        """No more will come: silence follows."""
        self._take(self._listener.frames(last=True))
        silence = (np.full((2, BANDS), -DEEP), -DEEP)
        while (self._first + len(self._rows)) * self._step < self._samples:
            self._take([silence])
        self._ended = True

    def add(self, timed: TimedPhone) -> None:
        """See `MouthTrack`: phones tell nothing here."""

    def ready_until(self) -> int:
        """See `MouthTrack`."""
        known = int((self._first + len(self._rows)) * self._step)
        return max(known, self._samples) if self._ended else known

    def settled_until(self) -> int:
        """See `MouthTrack`."""
        return self.ready_until()

    def rest_until(self, sample: int) -> None:
        """See `MouthTrack`."""

    def at(self, samples: NDArray[np.int64]) -> Mouth:
        """See `MouthTrack`."""
        numbers = np.rint(samples / self._step).astype(np.int64) - self._first
        numbers = np.minimum(numbers, len(self._rows) - 1)
        rows = [self._rows[number] for number in numbers]
        values = np.zeros((len(rows), N_FAPS))
        values[:, COLUMNS] = [row for row, _ in rows]
        for _ in range(numbers[-1]):
            self._rows.popleft()
        self._first += int(numbers[-1])
        return Mouth(values, np.array([speaks for _, speaks in rows]), jaw=False)

    @property
    def _step(self) -> float:
        """Samples from one instant to the next."""
        return STEP_S * self._rate

    def _take(self, heard: list[tuple[Floats, float]]) -> None:
        """Instants heard, and the rows that can be made now."""
        for bands, level in heard:
            self._frames.extend(bands)
            self._speech.append(float(np.clip((level - SPEECH[0]) / (SPEECH[1] - SPEECH[0]), 0.0, 1.0)))
            self._taken += 1
            if self._taken > LATER:
                self._raw.append(self._faps())
            if self._taken > LATER + len(SMOOTH) // 2:
                self._rows.append(self._row())

    def _faps(self) -> Floats:
        stacked = np.concatenate(list(self._frames)[::APART])
        return self._articulation.faps(self._heard.parameters(stacked))

    def _row(self) -> tuple[Floats, float]:
        """Of an instant whose neighbours are known; before the first one it was the same."""
        raw = [self._raw[0]] * (len(SMOOTH) - len(self._raw)) + list(self._raw)
        speech = list(self._speech)[: 2 * (HANG + EASE) + 1]
        near = [max(speech[i : i + 2 * HANG + 1]) for i in range(2 * EASE + 1)]
        speaks = sum(near) / len(near)
        return self._gain * speaks * (SMOOTH @ np.array(raw)), speaks
