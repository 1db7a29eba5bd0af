"""Timed phones in, FAP frames out: the face of one turn on the turn's sample clock."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from fapstream.motion.feeling import Feeling
from fapstream.motion.gestures import Gestures
from fapstream.motion.hermite import Values, hermite, limited_slope
from fapstream.motion.idle import IdleLife
from fapstream.motion.mixer import Mouth, Streams, mix
from fapstream.motion.visemes import N_CHANNELS, Keyframe, keyframes, mouth
from fapstream.records import FapFrame, TimedPhone


class FaceTrack:
    """Mixes the streams of a turn as its phones come.

    A frame can be given once the two keyframes after it are known, or the one after it if that is at
    rest, or when everything that will come has come up to a pause.
    """

    def __init__(self, lang: str, sample_rate: int, fps: int, seed: int = 0) -> None:
        self._lang = lang
        self._sample_rate = sample_rate
        self._fps = fps
        self._speech = SpeechTrack(sample_rate, fps)
        self._feeling = Feeling(sample_rate)
        self._gestures = Gestures(seed, sample_rate)
        self._idle = IdleLife(seed)
        self._frame = 0

    def add(self, phones: Iterable[TimedPhone]) -> None:
        """The next phones, in order of time."""
        for timed in phones:
            self._speech.add(keyframes(timed, self._lang, self._sample_rate), timed.end)
            self._feeling.add(timed)
            self._gestures.add(timed)

    @property
    def next_sample(self) -> int:
        """The sample at which the next frame holds."""
        return self._frame * self._sample_rate // self._fps

    def ready_until(self) -> int:
        """Frames before this sample can be given now."""
        return self._speech.ready_until()

    def frames(self, until: int) -> list[FapFrame]:
        """The frames that hold at samples below `until` and are not given yet, as far as they can be."""
        until = min(until, self.ready_until())
        out = []
        while self.next_sample < until:
            out.append(self._frame_at(self.next_sample))
            self._frame += 1
        if out:
            self._speech.rest_until(out[-1].sample)
        return out

    def _frame_at(self, sample: int) -> FapFrame:
        t = sample / self._sample_rate
        gesture, shut = self._gestures.at(t)
        streams = Streams(self._speech.at(sample), self._feeling.at(t), gesture, self._idle.at(t), shut)
        return FapFrame(sample, np.rint(mix(streams)).astype(np.int32))


class SpeechTrack:
    """The speech stream: interpolates the mouth's keyframes as they come."""

    def __init__(self, sample_rate: int, fps: int) -> None:
        self._sample_rate, self._fps = sample_rate, fps
        self._keys: deque[Keyframe] = deque([Keyframe(-1, np.zeros(N_CHANNELS), rest=True)])
        self._slope = np.zeros(N_CHANNELS)
        self._silent_until = 0

    def add(self, keys: Iterable[Keyframe], end: int) -> None:
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
        """The mouth before this sample can be told now."""
        if self._keys[-1].rest:
            return self._silent_until
        return self._keys[-2].sample if len(self._keys) > 1 else 0

    def at(self, sample: int) -> Mouth:
        """The mouth at a sample that is ready. Samples may not go back."""
        while len(self._keys) > 1 and self._keys[1].sample <= sample:
            self._slope = self._slope_at(1)
            self._keys.popleft()
        return mouth(self._interpolate(sample))

    def rest_until(self, sample: int) -> None:
        """The mouth was shown at rest up to here: it leaves rest no earlier."""
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

    def _interpolate(self, sample: int) -> Values:
        here = self._keys[0]
        if len(self._keys) == 1:
            return here.values
        there = self._keys[1]
        width = there.sample - here.sample
        x = (sample - here.sample) / width
        return hermite(x, here.values, there.values, width * self._slope, width * self._slope_at(1))

    def _slope_at(self, i: int) -> Values:
        key = self._keys[i]
        if key.rest or i + 1 == len(self._keys):
            return np.zeros(N_CHANNELS)
        before, after = self._keys[i - 1], self._keys[i + 1]
        return limited_slope(
            key.sample - before.sample,
            after.sample - key.sample,
            key.values - before.values,
            after.values - key.values,
        )
