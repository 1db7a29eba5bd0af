"""What is played, without the sound card: turns in, frames for the card out, and reports of what is where.

All turns have the card's sample rate, so that one frame of the card is one sample of the sound. Twin of
clients/web/src/stream/player.ts.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fapstream.records import Pcm
from fapstream.stream import stretch
from fapstream.stream.heard import Report, State
from fapstream.stream.jitter import Jitter
from fapstream.stream.line import SCALE
from fapstream.stream.voice import Voice

STEP_S = 0.01
"""The store is looked after once in so much sound."""
FALL_S, STARVED_FALL_S = 0.005, 0.04
"""How a sound dies away that breaks off: at the end of what there is, and where more should have come."""
PAST_S = 0.035
BEHIND_S = 5.0
"""A live talk of which more than this has not been played goes on with what is being said now: the card may
have stood still for hours."""


@dataclass(frozen=True, slots=True)
class PlayerStats:
    """How it goes. `store_ms` is of the turn being played; `stretched_ms` what was left out or said twice."""

    underruns: int
    late: int
    store_ms: float
    target_ms: float
    stretched_ms: float


class Player:
    """Turns one after the other. `report` is told when one starts, leaps, has to wait, and is over."""

    def __init__(
        self, sample_rate: int, report: Callable[[Report], None], jitter: Jitter | None = None
    ) -> None:
        self._rate = sample_rate
        self._report = report
        self._jitter = Jitter()
        self._queue: deque[Voice] = deque()
        self._frame = 0
        """The one to be rendered next."""
        self._paused = False
        self._past = np.zeros(round(PAST_S * sample_rate), np.int16)
        self._tail = np.zeros(0)
        """Sound that dies away."""
        self._underruns = self._late = self._stretched = 0

    # --- what is said

    def begin(self, turn: int, live: bool = False) -> None:
        """A turn is to be played when those before it are over. `live`: see Voice."""
        self._queue.append(Voice(turn, live, self._rate, self._jitter))

    def push(self, turn: int, sample: int, pcm: Pcm, hold: bool = False) -> None:
        """More of a turn, from `sample` on. `hold`: what follows may be late without being a fault."""
        for voice in self._of(turn):
            self._late += voice.push(sample, pcm, hold, self._frame)
            if voice.live and self._store_s > BEHIND_S:
                self._catch_up(voice)

    def discard(self, turn: int, sample: int) -> None:
        """What was not played from `sample` on is not to be played: the next push goes on there."""
        for voice in self._of(turn):
            voice.discard(sample)

    def end(self, turn: int) -> None:
        """The turn is complete."""
        for voice in self._of(turn):
            voice.ended = True

    def stop(self, turn: int) -> None:
        """Fall silent at once."""
        for voice in self._of(turn):
            voice.stopped = True

    def pause(self, on: bool) -> None:
        """Fall silent, and go on with the next sample when it is over."""
        if on == self._paused:
            return
        self._paused = on
        for voice in self._queue:
            voice.interrupt()
        if self._queue and self._queue[0].started and not self._queue[0].playing:
            self._tell("paused" if on else "waiting", self._queue[0], self._frame)

    @property
    def stats(self) -> PlayerStats:
        """How it goes."""
        ms = 1000 / self._rate
        store = self._queue[0].line.queued * ms if self._queue else 0.0
        target = 1000 * self._jitter.target_s
        return PlayerStats(self._underruns, self._late, store, target, self._stretched * ms)

    # --- what is heard

    def render(self, n: int, frame: int) -> Pcm:
        """The next n frames, the first of which is the card's frame `frame`."""
        out = np.zeros(n, np.int16)
        at = 0
        while at < n and self._queue:
            voice = self._queue[0]
            if not voice.playing and not self._start(voice, frame + at):
                break
            if voice.playing:
                at = self._play(voice, out, at, frame)
        self._sink(out[at:])
        self._past = np.concatenate([self._past, out])[-len(self._past) :]
        self._frame = frame + n
        return out

    def _of(self, turn: int) -> list[Voice]:
        return [voice for voice in self._queue if voice.turn == turn]

    @property
    def _store_s(self) -> float:
        return sum(voice.line.queued for voice in self._queue) / self._rate

    def _catch_up(self, voice: Voice) -> None:
        """Play this turn next, from where it is now."""
        for other in list(self._queue)[: self._queue.index(voice)]:
            if other.playing:
                other.stopped = True
            else:
                self._leave(other, self._frame)
        voice.catch_up()

    def _start(self, voice: Voice, frame: int) -> bool:
        """False if there is nothing to do for this turn yet."""
        if voice.stopped:
            self._leave(voice, frame)
            return True
        if self._paused or not voice.startable(frame):
            return False
        voice.start(frame)
        voice.told = None
        self._follow(voice, frame)
        return True

    def _play(self, voice: Voice, out: Pcm, at: int, frame: int) -> int:
        """Fill `out` from `at` on as far as this turn goes; where that is."""
        fading = voice.stopped or self._paused
        step = round(STEP_S * self._rate)
        while at < len(out):
            if not fading:
                self._stretched += voice.fit(frame + at)
            self._follow(voice, frame + at)
            pcm = voice.take(min(step, len(out) - at), fading)
            if len(pcm) == 0:
                self._halt(voice, out[:at], frame + at)
                break
            out[at : at + len(pcm)] = pcm
            self._sink(out[at : at + len(pcm)])
            at += len(pcm)
        return at

    def _follow(self, voice: Voice, frame: int) -> None:
        """Tell what is played from here on, if that is not what was to be expected."""
        knot = voice.line.knot
        if knot is not voice.told:
            voice.told = knot
            self._report(Report("playing", voice.turn, frame, voice.line.sample, knot.pace))

    def _halt(self, voice: Voice, out: Pcm, frame: int) -> None:
        """The sound stops at `frame`, after `out`: the turn is over, or has to wait for more."""
        dry = voice.line.queued == 0
        voice.rest()
        if voice.stopped or (dry and voice.ended):
            self._leave(voice, frame)
        elif self._paused:
            self._tell("paused", voice, frame)
        elif voice.held:
            self._tell("waiting", voice, frame)
        else:
            self._underruns += 1
            voice.dry = frame
            self._tell("starved", voice, frame)
        if voice.gain > 0:
            past = np.concatenate([self._past, out])[-len(self._past) :]
            self._tail = stretch.fall(
                past / SCALE, self._rate, FALL_S if voice.dry is None else STARVED_FALL_S
            )

    def _leave(self, voice: Voice, frame: int) -> None:
        self._queue.remove(voice)
        self._tell("over", voice, frame)

    def _tell(self, state: State, voice: Voice, frame: int) -> None:
        self._report(Report(state, voice.turn, frame, voice.line.sample, 0))

    def _sink(self, out: Pcm) -> None:
        """Add to `out` what dies away."""
        n = min(len(out), len(self._tail))
        if n:
            out[:n] = np.clip(out[:n] + np.rint(self._tail[:n] * SCALE), -SCALE, SCALE - 1)
            self._tail = self._tail[n:]
