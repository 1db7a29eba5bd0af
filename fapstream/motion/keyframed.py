"""The mouth of keyframes: one or two shapes a phone, and curves between them."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from fapstream.motion.articulation import COLUMNS
from fapstream.motion.hermite import Values, hermite, limited_slope
from fapstream.motion.mixer import Mouth
from fapstream.motion.speech import Speaking
from fapstream.motion.visemes import N_CHANNELS, Keyframe, keyframes, mouth
from fapstream.records import TimedPhone


class KeyframedMouth:
    """See `MouthTrack`. A frame can be told once the two keyframes after it are known, or the one after it if
    that is at rest."""

    def __init__(self, speaking: Speaking, fps: int) -> None:
        start = speaking.start
        self._lang, self._sample_rate, self._fps = speaking.lang, speaking.rate, fps
        self._gain = np.ones(N_CHANNELS)
        self._gain[COLUMNS] = speaking.gain
        self._keys: deque[Keyframe] = deque([Keyframe(start - 1, np.zeros(N_CHANNELS), rest=True)])
        self._slope = np.zeros(N_CHANNELS)
        """At the first of the keyframes."""
        self._silent_until = start

    def add(self, timed: TimedPhone) -> None:
        """See `MouthTrack`."""
        self.add_keys(keyframes(timed, self._lang, self._sample_rate), timed.end)

    def add_keys(self, keys: Iterable[Keyframe], end: int) -> None:
        """The keyframes of the next phone, which ends at sample `end`."""
        found = list(keys)
        for key in self._seen(found) if found[0].contact else found:
            newest = self._keys[-1].sample
            if key.sample > newest:
                self._keys.append(key)
            elif key.rest:
                self._keys.append(replace(key, sample=newest + 1))
        if self._keys[-1].rest:
            self._silent_until = end

    def ready_until(self) -> int:
        """See `MouthTrack`."""
        if self._keys[-1].rest:
            return self._silent_until
        return self._keys[-2].sample if len(self._keys) > 1 else 0

    def settled_until(self) -> int:
        """See `MouthTrack`."""
        return self._keys[-1].sample if self._keys[-1].rest else self.ready_until()

    def at(self, samples: int | NDArray[np.int64]) -> Mouth:
        """See `MouthTrack`."""
        wanted = np.atleast_1d(samples)
        keys = self._until(int(wanted[-1]))
        at = np.array([key.sample for key in keys])
        values = np.array([key.values for key in keys])
        slopes = self._slopes(keys, at, values)
        here = np.maximum(np.searchsorted(at, wanted, side="right") - 1, 0)
        there = np.minimum(here + 1, len(keys) - 1)
        width = np.maximum(at[there] - at[here], 1)[:, None]
        x = np.where(here < there, np.maximum(wanted - at[here], 0), 0)[:, None] / width
        found = hermite(x, values[here], values[there], width * slopes[here], width * slopes[there])
        self._slope = slopes[here[-1]]
        for _ in range(here[-1]):
            self._keys.popleft()
        return mouth(self._gain * (found if np.ndim(samples) else found[0]))

    def _until(self, sample: int) -> list[Keyframe]:
        """The keyframes up to the second after `sample`, as far as there are."""
        after = next((i for i, key in enumerate(self._keys) if key.sample > sample), len(self._keys))
        return list(islice(self._keys, after + 2))

    def _slopes(self, keys: list[Keyframe], at: NDArray[np.int64], values: Values) -> Values:
        """At each keyframe; at the last, whose successor is not looked at, and at rest: none."""
        slopes = np.zeros_like(values)
        slopes[0] = self._slope
        if len(keys) > 2:
            width, rise = np.diff(at)[:, None], np.diff(values, axis=0)
            slopes[1:-1] = limited_slope(width[:-1], width[1:], rise[:-1], rise[1:])
        slopes[[key.rest for key in keys]] = 0.0
        return slopes

    def rest_until(self, sample: int) -> None:
        """See `MouthTrack`."""
        last = self._keys[-1]
        if last.rest and sample > last.sample:
            self._keys.append(Keyframe(sample, last.values, rest=True))

    def _seen(self, keys: list[Keyframe]) -> list[Keyframe]:
        """A contact, moved by less than a frame so that one frame falls into it however short it is.

        Not before the newest keyframe: what lies before that may have been shown, and the contact before
        this one may have been moved over its beginning.
        """
        first, last = keys[0].sample, keys[-1].sample
        newest = self._keys[-1].sample
        if self._frame_from(max(first, newest + 1)) <= last:
            return keys
        earliest = max(newest + 1, self._silent_until)
        middle = (first + last) / 2
        frame = self._frame_from(max(earliest, round(middle - self._sample_rate / self._fps / 2)))
        start = max(earliest, min(first, frame))
        return [replace(keys[0], sample=start), replace(keys[-1], sample=max(frame, last))]

    def _frame_from(self, sample: int) -> int:
        """The first sample at or after this one at which a frame holds."""
        frame = -(-sample * self._fps // self._sample_rate)
        while frame * self._sample_rate // self._fps < sample:
            frame += 1
        return frame * self._sample_rate // self._fps
