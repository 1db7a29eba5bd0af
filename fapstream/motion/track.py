"""Timed phones in, FAP frames out: the face of one turn on the turn's sample clock."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from fapstream.motion.hermite import hermite, limited_slope
from fapstream.motion.idle import IdleLife
from fapstream.motion.visemes import Keyframe, keyframes
from fapstream.records import N_FAPS, FapFrame, TimedPhone


class FaceTrack:
    """Interpolates keyframes as they come.

    A frame can be given once the two keyframes after it are known, or the one after it if that is at
    rest, or when everything that will come has come up to a pause.
    """

    def __init__(self, lang: str, sample_rate: int, fps: int, seed: int = 0) -> None:
        self._lang = lang
        self._sample_rate = sample_rate
        self._fps = fps
        self._idle = IdleLife(seed, sample_rate)
        self._keys: deque[Keyframe] = deque([Keyframe(-1, np.zeros(N_FAPS), rest=True)])
        self._slope = np.zeros(N_FAPS)
        self._frame = 0
        self._silent_until = 0

    def add(self, phones: Iterable[TimedPhone]) -> None:
        """The next phones, in order of time."""
        for timed in phones:
            for key in keyframes(timed, self._lang, self._sample_rate):
                if key.sample > self._keys[-1].sample:
                    self._keys.append(key)
            if self._keys[-1].rest:
                self._silent_until = timed.end

    @property
    def next_sample(self) -> int:
        """The sample at which the next frame holds."""
        return self._frame * self._sample_rate // self._fps

    def ready_until(self) -> int:
        """Frames before this sample can be given now."""
        if self._keys[-1].rest:
            return self._silent_until
        return self._keys[-2].sample if len(self._keys) > 1 else 0

    def frames(self, until: int) -> list[FapFrame]:
        """The frames that hold at samples below `until` and are not given yet, as far as they can be."""
        until = min(until, self.ready_until())
        out = []
        while self.next_sample < until:
            out.append(self._frame_at(self.next_sample))
            self._frame += 1
        last = self._keys[-1]
        if last.rest and out and out[-1].sample > last.sample:
            self._keys.append(Keyframe(out[-1].sample, last.values, rest=True))
        return out

    def _frame_at(self, sample: int) -> FapFrame:
        while len(self._keys) > 1 and self._keys[1].sample <= sample:
            self._slope = self._slope_at(1)
            self._keys.popleft()
        values = self._interpolate(sample)
        self._idle.add_to(values, sample)
        return FapFrame(sample, np.rint(values).astype(np.int32))

    def _interpolate(self, sample: int) -> NDArray[np.float64]:
        here = self._keys[0]
        if len(self._keys) == 1:
            return here.values.copy()
        there = self._keys[1]
        width = there.sample - here.sample
        x = (sample - here.sample) / width
        return hermite(x, here.values, there.values, width * self._slope, width * self._slope_at(1))

    def _slope_at(self, i: int) -> NDArray[np.float64]:
        key = self._keys[i]
        if key.rest or i + 1 == len(self._keys):
            return np.zeros(N_FAPS)
        before, after = self._keys[i - 1], self._keys[i + 1]
        return limited_slope(
            key.sample - before.sample,
            after.sample - key.sample,
            key.values - before.values,
            after.values - key.values,
        )
