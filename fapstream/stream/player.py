"""What is played, without the sound card: turns in, frames for the card out, and reports of what is where.

All turns have the card's sample rate, so that one frame of the card is one sample of the turn.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

import numpy as np

from fapstream.records import Pcm
from fapstream.stream.heard import Report

PREBUFFER_S = 0.08
"""Sound in store before it starts, or starts again."""
FADE_OUT_S = 0.02
FADE_IN_S = 0.003
DECAY_S = 0.0014
"""A sound that is cut off dies away with this time constant instead of clicking."""


class _Voice:
    """One turn's sound: what was received and not yet played."""

    def __init__(self, turn: int) -> None:
        self.turn = turn
        self.sample = 0
        self.held = self.ended = self.stopped = self.playing = False
        self.gain = 0.0
        self._chunks: deque[Pcm] = deque()
        self.queued = 0

    def push(self, pcm: Pcm, hold: bool) -> None:
        if len(pcm):
            self._chunks.append(pcm)
        self.queued += len(pcm)
        self.held = hold

    def startable(self, prebuffer: int) -> bool:
        return self.ended or (self.queued > 0 and (self.held or self.queued >= prebuffer))

    def take(self, n: int, step: float) -> Pcm:
        """At most n samples, under a gain that moves by `step` a sample; none once it has reached 0."""
        n = min(n, self.queued)
        if step < 0:
            n = min(n, int(np.ceil(self.gain / -step)))
        pcm = self._cut(n)
        if self.gain < 1.0 or step < 0:
            gains = np.clip(self.gain + step * np.arange(1, n + 1), 0.0, 1.0)
            self.gain = float(gains[-1]) if n else self.gain
            pcm = np.rint(pcm * gains).astype(np.int16)
        return pcm

    def _cut(self, n: int) -> Pcm:
        out = np.zeros(n, np.int16)
        filled = 0
        while filled < n:
            chunk = self._chunks.popleft()
            part = chunk[: n - filled]
            out[filled : filled + len(part)] = part
            filled += len(part)
            if len(part) < len(chunk):
                self._chunks.appendleft(chunk[len(part) :])
        self.queued -= n
        self.sample += n
        return out


class Player:
    """Turns one after the other. `report` is told when one starts, has to wait, and is over."""

    def __init__(self, sample_rate: int, report: Callable[[Report], None]) -> None:
        self._rate = sample_rate
        self._report = report
        self._queue: deque[_Voice] = deque()
        self._last = 0.0

    def begin(self, turn: int) -> None:
        """A turn is to be played when those before it are over."""
        self._queue.append(_Voice(turn))

    def push(self, turn: int, pcm: Pcm, hold: bool = False) -> None:
        """More of a turn. `hold`: what follows may be late without being a fault."""
        for voice in self._of(turn):
            voice.push(pcm, hold)

    def end(self, turn: int) -> None:
        """The turn is complete."""
        for voice in self._of(turn):
            voice.ended = True

    def stop(self, turn: int) -> None:
        """Fall silent at once."""
        for voice in self._of(turn):
            voice.stopped = True

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
        if at < n:
            self._die_away(out[at:])
        else:
            self._last = float(out[-1]) if n else self._last
        return out

    def _of(self, turn: int) -> list[_Voice]:
        return [voice for voice in self._queue if voice.turn == turn]

    def _start(self, voice: _Voice, frame: int) -> bool:
        """False if there is nothing to do for this turn yet."""
        if voice.stopped:
            self._leave(voice, frame)
            return True
        if not voice.startable(round(PREBUFFER_S * self._rate)):
            return False
        voice.playing, voice.gain = True, 0.0
        self._report(Report("playing", voice.turn, frame, voice.sample))
        return True

    def _play(self, voice: _Voice, out: Pcm, at: int, frame: int) -> int:
        fade_s = -FADE_OUT_S if voice.stopped else FADE_IN_S
        pcm = voice.take(len(out) - at, 1 / (fade_s * self._rate))
        out[at : at + len(pcm)] = pcm
        at += len(pcm)
        if at:
            self._last = float(out[at - 1])
        if at < len(out):
            self._halt(voice, frame + at)
        return at

    def _halt(self, voice: _Voice, frame: int) -> None:
        """The sound stops at `frame`: the turn is over, or has to wait for more."""
        voice.playing = False
        if voice.stopped or voice.ended:
            self._leave(voice, frame)
        else:
            self._report(Report("waiting" if voice.held else "starved", voice.turn, frame, voice.sample))

    def _leave(self, voice: _Voice, frame: int) -> None:
        self._queue.popleft()
        self._report(Report("over", voice.turn, frame, voice.sample))

    def _die_away(self, out: Pcm) -> None:
        falling = self._last * np.exp(-np.arange(1, len(out) + 1) / (DECAY_S * self._rate))
        out[:] = np.trunc(falling)
        self._last = float(falling[-1])
