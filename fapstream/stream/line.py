"""One turn's sound on its way to the card, in the order in which it is played.

What lies in the line may have been joined, shortened and stretched; knots say which sample of the turn is
where. Twin of clients/web/src/stream/line.ts.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fapstream.records import Pcm
from fapstream.stream import stretch

RAMP_S = 0.005
"""How long the old sound goes over into the new where it was cut, or where some is missing."""
PAST_S = 0.035
"""Sound that was played is kept for so long: what may have to be continued or repeated."""
SCALE = 32_768.0


@dataclass(frozen=True, slots=True)
class Knot:
    """`sample` lies at `index` of the line; from there on `pace` samples of the turn to a place.

    Where a period is left out the pace is 2, where one is said twice 0: the very mean of what is mixed there.
    """

    index: int
    sample: int
    pace: int


class Change(NamedTuple):
    """The line has become longer by `samples`, in a pause (`quiet`) or in speech."""

    samples: int
    quiet: bool


class Line:
    """Sound in, addressed by sample of the turn; sound out, in order. `at` and `end` count what went by."""

    def __init__(self, rate: int) -> None:
        self.at = self.end = 0
        self.next: int | None = None
        """The sample of the turn that is expected; None before the first."""
        self._rate = rate
        self._ramp, self._past = round(RAMP_S * rate), round(PAST_S * rate)
        self._data: Pcm = np.zeros(0, np.int16)
        self._base = 0
        self._knots = deque([Knot(0, 0, 1)])
        """The first holds at `at`."""
        self._falling = np.zeros(0)
        """What was to follow at the end, and does not: the next sound grows out of it."""
        self._flows = False

    @property
    def queued(self) -> int:
        """Samples that lie ready."""
        return self.end - self.at

    @property
    def knot(self) -> Knot:
        """What holds at `at`."""
        while len(self._knots) > 1 and self._knots[1].index <= self.at:
            self._knots.popleft()
        return self._knots[0]

    @property
    def sample(self) -> int:
        """Of the turn, the one that is to be played next."""
        return _sample(self.knot, self.at)

    # --- in

    def push(self, sample: int, pcm: Pcm) -> int:
        """The sound from `sample` on, what is here already left out; returns how much was new.

        Where some is missing the sound is bridged and the sample leaps.
        """
        if self.next is None:
            self._tie(Knot(self.end, sample, 1))
            self.next = sample
        pcm = pcm[max(0, self.next - sample) :]
        if len(pcm) == 0:
            return 0
        if sample > self.next:
            self._leap(sample)
        self._append(pcm)
        self.next = max(self.next, sample) + len(pcm)
        return len(pcm)

    def discard(self, sample: int) -> None:
        """Forget the sound from `sample` on, as far as it was not played: the next push goes on there."""
        if self.next is None or sample >= self.next:
            return
        index = max(self.at, self._index(sample))
        if index < self.end:
            self._falling = self._beyond(index)
        self.next = _sample(self._holding(index), index)
        self._data, self.end = self._data[: index - self._base], index
        self._tie(Knot(index, self.next, 1))

    def skip(self, left: int) -> None:
        """Leave out what was not played, but for the last `left` samples; it is bridged."""
        index = self.end - left
        if index <= self.at:
            return
        at, rest = self.at - self._base, index - self._base
        ramp = min(self._ramp, left)
        mixed = stretch.fade(self._float(self.at, self.at + ramp), self._float(index, index + ramp))
        self._data = np.concatenate([self._data[:at], _pcm(mixed), self._data[rest + ramp :]])
        holding = self._holding(index)
        after = [Knot(k.index - index + self.at, k.sample, k.pace) for k in self._knots if k.index > index]
        self._tie(Knot(self.at, _sample(holding, index), holding.pace))
        self._knots.extend(after)
        self.end = self.at + left

    def rest(self) -> None:
        """The sound has died away: nothing has to be bridged."""
        self._flows = False
        self._falling = np.zeros(0)

    # --- out

    def take(self, n: int) -> Pcm:
        """At most n samples, as far as one knot holds."""
        knot = self.knot
        more = self._knots[1].index if len(self._knots) > 1 else self.end
        n = min(n, self.queued, max(more, knot.index) - self.at)
        start = self.at - self._base
        self.at += n
        self._flows = self._flows or n > 0
        return self._data[start : start + n]

    def alter(self, way: int) -> Change | None:
        """Say a period twice (1) or leave one out (-1), from `at` on; None if that would be heard."""
        _, longest = stretch.periods(self._rate)
        low, high = max(self._base, self.at - longest), min(self.end, self.at + 2 * longest)
        if any(low < knot.index < high for knot in self._knots):
            return None
        sound, at = self._float(low, high), self.at - low
        lag, quiet = _lag(sound, at, -way, self._rate)
        if lag == 0:
            return None
        old, new = sound[at : at + lag], sound[at - way * lag : at - way * lag + lag]
        self._splice(stretch.fade(old, new), way, lag)
        return Change(way * lag, quiet)

    def _splice(self, mixed: stretch.Sound, way: int, lag: int) -> None:
        start = self.at - self._base
        rest = start + (1 - way) * lag
        self._data = np.concatenate([self._data[:start], _pcm(mixed), self._data[rest:]])
        sample = self.sample
        before = [knot for knot in self._knots if knot.index < self.at]
        after = [Knot(k.index + way * lag, k.sample, k.pace) for k in self._knots if k.index > self.at]
        between = Knot(self.at, sample, 1 - way), Knot(self.at + lag, sample + (1 - way) * lag, 1)
        self._knots = deque([*before, *between, *after])
        self.end += way * lag

    # --- within

    def _append(self, pcm: Pcm) -> None:
        n = min(len(self._falling), len(pcm))
        if n:
            grown = stretch.fade(
                self._falling[:n], pcm[:n] / SCALE, self._ramp - len(self._falling), self._ramp
            )
            pcm = np.concatenate([_pcm(grown), pcm[n:]])
            self._falling = self._falling[n:]  # a packet may be shorter than the ramp
        forget = max(0, self.at - self._past - self._base)
        self._data = np.concatenate([self._data[forget:], pcm])
        self._base += forget
        self.end += len(pcm)

    def _leap(self, sample: int) -> None:
        if len(self._falling) < self._ramp and (self.queued or self._flows):
            self._falling = self._beyond(self.end)
        self._tie(Knot(self.end, sample, 1))

    def _beyond(self, index: int) -> stretch.Sound:
        """What would be played from `index` on, made up where it is not known."""
        known = self._float(index, min(self.end, index + self._ramp))
        past = self._float(max(self._base, self.end - self._past), self.end)
        found = np.zeros(self._ramp)
        further = np.concatenate([known, stretch.fall(past, self._rate, 2 * RAMP_S)])[: self._ramp]
        found[: len(further)] = further
        return found

    def _float(self, start: int, end: int) -> stretch.Sound:
        return self._data[start - self._base : end - self._base] / SCALE

    def _tie(self, knot: Knot) -> None:
        while self._knots and self._knots[-1].index >= knot.index:
            self._knots.pop()
        last = self._knots[-1] if self._knots else None
        if last is None or last.pace != knot.pace or _sample(last, knot.index) != knot.sample:
            self._knots.append(knot)

    def _holding(self, index: int) -> Knot:
        return [knot for knot in self._knots if knot.index <= index][-1]

    def _index(self, sample: int) -> int:
        """Where a sample lies in the line, or what follows the place where it is missing."""
        end = self.end
        for knot in reversed(self._knots):
            if knot.sample <= sample:
                ahead = (sample - knot.sample) // knot.pace if knot.pace else 0
                return min(end, knot.index + ahead)
            end = knot.index
        return self.at


def _lag(sound: stretch.Sound, at: int, way: int, rate: int) -> tuple[int, bool]:
    """How much may be left out ahead of `at` (way 1), or said again from behind it (-1), 0 for nothing.

    And whether it is quiet there.
    """
    _, longest = stretch.periods(rate)
    around = sound[at:] if way > 0 else sound[at - longest if at > longest else 0 : at + longest]
    room = (len(sound) - at) // 2 if way > 0 else min(at, len(sound) - at)
    if room and stretch.is_quiet(around):
        return min(longest, room), True
    lag, alike = stretch.period(sound, at, way, rate)
    return (lag, False) if alike >= stretch.ALIKE else (0, False)


def _sample(knot: Knot, index: int) -> int:
    return knot.sample + knot.pace * (index - knot.index)


def _pcm(sound: stretch.Sound) -> Pcm:
    return np.clip(np.rint(sound * SCALE), -SCALE, SCALE - 1).astype(np.int16)
