"""One turn as it is played: when it may start, how loud it is, and how it keeps its store.

Twin of clients/web/src/stream/voice.ts. Frames are the sound card's, which has the turn's sample rate.
"""

from __future__ import annotations

import numpy as np

from fapstream.records import Pcm
from fapstream.stream.jitter import Jitter, steer
from fapstream.stream.line import Knot, Line

FADE_OUT_S = 0.02
FADE_IN_S = 0.003
FADE_BACK_S = 0.01
"""A turn that goes on within a sound comes back more softly than one that begins."""
SPEECH_EVERY, QUIET_EVERY = 20, 2
"""After a change, this many times its length passes unchanged: 5 % in speech, half of a pause."""
PATIENCE_S = 3.0
"""A store has to be too large for so long before it shrinks: the network may turn out to need it."""
RETRY_S = 0.01
OVERDUE_S = 0.06
"""A packet that does not come for so long, and longer than the network is known for, is missing."""
SCANT_S = 0.3
"""With less in store and a packet missing, time is gained."""


class Voice:
    """`live`: the talk is sent in real time, and a store larger than needed is latency."""

    def __init__(self, turn: int, live: bool, rate: int, jitter: Jitter) -> None:
        self.turn, self.live = turn, live
        self.line = Line(rate)
        self.held = self.ended = self.stopped = self.playing = self.started = False
        self.gain = 0.0
        self.told: Knot | None = None
        """What the listener's map was told last."""
        self.dry: int | None = None
        """The frame since which sound is missing."""
        self._rate, self._jitter = rate, jitter
        self._rise = 1 / (FADE_IN_S * rate)
        self._arrived = 0
        self._level_s: float | None = None
        self._above: int | None = None
        """The frame since which the store is too large."""
        self._free = 0
        """Where in the line the next change may be."""

    # --- in

    def push(self, sample: int, pcm: Pcm, hold: bool, frame: int) -> bool:
        """More of the turn, at `frame`; True if it came too late."""
        if self.line.next is None or self.held:
            self._jitter.restart()
        before = self.line.queued
        late = self.line.push(sample, pcm) > 0 and self._note(before, frame)
        self.held = hold
        return late

    def discard(self, sample: int) -> None:
        """See Line.discard. What replaces it is sent when it is there."""
        self.line.discard(sample)
        self.held = False
        self.interrupt()

    def catch_up(self) -> None:
        """Go on with what is being said now, leaving out all of the store that is not needed."""
        self.line.skip(int(np.ceil(self._jitter.target_s * self._rate)))
        self._level_s = self._above = None

    def interrupt(self) -> None:
        """The sender's time has stopped or leapt; what was known of it is worth nothing."""
        self._jitter.restart()
        self._level_s = self.dry = None

    def _note(self, before: int, frame: int) -> bool:
        """New sound has come at `frame`, when `before` samples were in store. Is it late?"""
        self._arrived = frame
        now = frame / self._rate
        if self.dry is not None and before == 0:
            self._jitter.underrun((frame - self.dry) / self._rate)
        if self.live and self.line.next is not None:
            lateness = self._jitter.observe(self.line.next / self._rate, now)
            self._level_s = self.line.queued / self._rate + lateness
        else:
            self._jitter.ease(now)
        return self.dry is not None and frame - self.dry >= before

    # --- out

    def startable(self, frame: int) -> bool:
        """Is enough in store? In a live talk time does as well: what is not yet played is gained."""
        if self.ended or self.line.queued == 0:
            return self.ended
        store_s = self.line.queued / self._rate
        if self._level_s is not None:
            store_s = self._level_s + (frame - self._arrived) / self._rate
        return self.held or store_s >= self._jitter.target_s

    def start(self, frame: int) -> None:
        """From this frame on it is heard."""
        if self._level_s is not None:
            self._level_s += (frame - self._arrived) / self._rate
        if self.started:
            self._rise = 1 / (FADE_BACK_S * self._rate)
        self.started = self.playing = True
        self.dry, self.gain = None, 0.0

    def rest(self) -> None:
        """It is no longer heard."""
        self.playing = False
        self.line.rest()

    def take(self, n: int, fading: bool) -> Pcm:
        """At most n samples; none if there are none, or once it has faded away."""
        step = -1 / (FADE_OUT_S * self._rate) if fading else self._rise
        if fading:
            n = min(n, int(np.ceil(self.gain / -step)))
        pcm = self.line.take(n)
        if len(pcm) and (self.gain < 1.0 or fading):
            gains = np.clip(self.gain + step * np.arange(1, len(pcm) + 1), 0.0, 1.0)
            self.gain = float(gains[-1])
            pcm = np.rint(pcm * gains).astype(np.int16)
        return pcm

    def fit(self, frame: int) -> int:
        """Shorten or lengthen what comes next, if the store asks for it; by how many samples."""
        way = self._wish(frame) if self.line.at >= self._free else 0
        if way == 0:
            return 0
        change = self.line.alter(way)
        if change is None:
            self._free = self.line.at + round(RETRY_S * self._rate)
            return 0
        size = abs(change.samples)
        self._free = self.line.at + size * (QUIET_EVERY if change.quiet else SPEECH_EVERY)
        if self._level_s is not None:
            self._level_s += change.samples / self._rate
        return size

    def _wish(self, frame: int) -> int:
        if self.ended or self.stopped:
            return 0
        target_s = self._jitter.target_s
        way = self._patient(0 if self._level_s is None else steer(self._level_s, target_s), frame)
        missing = frame - self._arrived > max(OVERDUE_S, target_s) * self._rate
        if missing and self.line.queued < SCANT_S * self._rate:
            way = 1
        return 0 if self.held and way > 0 else way

    def _patient(self, way: int, frame: int) -> int:
        if way >= 0:
            self._above = None
            return way
        self._above = frame if self._above is None else self._above
        return way if frame - self._above >= PATIENCE_S * self._rate else 0
