"""Timed phones in, FAP frames out: the face of one turn on the turn's sample clock."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from fapstream.motion.chance import BACK_S, minimum_jerk
from fapstream.motion.feeling import Feeling
from fapstream.motion.gestures import Gestures
from fapstream.motion.hermite import Values, hermite, limited_slope
from fapstream.motion.idle import Idle, IdleLife, Look
from fapstream.motion.mixer import Mouth, Streams, mix
from fapstream.motion.visemes import N_CHANNELS, Keyframe, keyframes, mouth
from fapstream.records import N_FAPS, FapFrame, TimedPhone

BLOCK = 32
"""So many frames are made at once, where the phones are known: numpy takes hardly longer than for one, and
no more than a millisecond."""

IDLE_BLOCK = 4 * BLOCK
"""The same of idle life, which waits for nobody."""

SEAM_S = 0.1
"""After a cut the mouth takes so long from what it showed to the new track."""


class FaceTrack:
    """Mixes the streams of a turn as its phones come.

    A frame can be given once the two keyframes after it are known, or the one after it if that is at
    rest, or when everything that will come has come up to a pause.
    """

    def __init__(self, lang: str, sample_rate: int, fps: int, seed: int = 0) -> None:
        self._lang = lang
        self._sample_rate = sample_rate
        self._fps = fps
        self._seed = seed
        self._idle = _Ahead(IdleLife(seed), fps)
        self._frame = 0
        self._shown: deque[FapFrame] = deque(maxlen=round(BACK_S * fps))
        self._made: deque[FapFrame] = deque()
        self._speech = SpeechTrack(sample_rate, fps)
        self._feeling = Feeling(sample_rate)
        self._gestures = Gestures(seed, sample_rate)
        self._end = 0
        """Where the last phone ends."""
        self._seam = 0.0
        """When the last cut was, s."""
        self._offset: Values = np.zeros(N_FAPS)
        """How far the face was then from where the new track has it."""

    def add(self, phones: Iterable[TimedPhone]) -> None:
        """The next phones, in order of time."""
        for timed in phones:
            self._speech.add(keyframes(timed, self._lang, self._sample_rate), timed.end)
            self._feeling.add(timed)
            self._gestures.add(timed)
            self._end = timed.end

    def cut(self, sample: int) -> None:
        """What was to come from `sample` on is void, given out or not; the phones that come now begin there.

        Frames before it that were not given yet still come. The mouth goes on from what it showed; gestures
        and expressions that had begun come to their end. May go back up to BACK_S.
        """
        before = self.frames(sample)
        while self._shown and self._shown[-1].sample >= sample:
            self._shown.pop()
        self._seam, self._end = sample / self._sample_rate, sample
        self._speech = SpeechTrack(self._sample_rate, self._fps, sample)
        self._feeling.cut(self._seam)
        self._gestures.cut(self._seam)
        self._offset = np.zeros(N_FAPS)
        if self._shown:
            last = self._shown[-1]
            self._offset = last.values - self._faces(self._number(last.sample), np.array([last.sample]))[0]
        while before and self._shown and self._shown[-1].sample >= before[0].sample:
            self._shown.pop()
        self._frame = min(self._frame, self._number(sample)) - len(before)
        self._made = deque(before)

    def _number(self, sample: int) -> int:
        """Of the first frame that holds at a sample or after it."""
        return -(-sample * self._fps // self._sample_rate)

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
        out: list[FapFrame] = []
        while self.next_sample < until:
            if not self._made:
                self._make(until)
            out.append(self._made.popleft())
            self._frame += 1
        if out:
            self._speech.rest_until(out[-1].sample)
            self._shown.extend(out)
        return out

    def _make(self, until: int) -> None:
        """The next frames before `until`, and those after it that no phone to come can change."""
        limit = max(until, min(self._speech.settled_until(), self._end))
        ordinals = np.arange(self._frame, self._frame + BLOCK - self._frame % BLOCK)
        samples = ordinals * self._sample_rate // self._fps
        samples = samples[: np.searchsorted(samples, limit)]
        faces = self._faces(self._frame, samples)
        if samples[0] < (self._seam + SEAM_S) * self._sample_rate:
            new = minimum_jerk((samples / self._sample_rate - self._seam) / SEAM_S)
            faces += (1.0 - new)[:, None] * self._offset
        rows = np.rint(faces).astype(np.int32)
        self._made.extend(FapFrame(int(sample), row) for sample, row in zip(samples, rows, strict=True))

    def _faces(self, first: int, samples: NDArray[np.int64]) -> Values:
        """What the streams make of the frames from number `first` on, shape (n, 68)."""
        t = samples / self._sample_rate
        gesture, shut = self._gestures.at(t)
        idle = self._idle.at(first, len(t))
        return mix(Streams(self._speech.at(samples), self._feeling.at(t), gesture, idle, shut))


class _Ahead:
    """Idle life made a block of frames at a time, for nothing that is said changes it."""

    def __init__(self, life: IdleLife, fps: int) -> None:
        self._life, self._fps = life, fps
        self._block = -1
        self._rows: Values = np.zeros((7, IDLE_BLOCK))

    def at(self, first: int, n: int) -> Idle:
        """Of frames `first` to `first + n`, which lie in one block."""
        block, at = divmod(first, IDLE_BLOCK)
        if block != self._block:
            made = self._life.at((block * IDLE_BLOCK + np.arange(IDLE_BLOCK)) / self._fps)
            look = made.look
            self._rows = np.array([made.shut, look.yaw, look.pitch, look.nearness, *made.head])
            self._block = block
        shut, yaw, pitch, nearness, *head = self._rows[:, at : at + n]
        return Idle(shut, Look(yaw, pitch, nearness), (head[0], head[1], head[2]))


class SpeechTrack:
    """The speech stream: interpolates the mouth's keyframes as they come."""

    def __init__(self, sample_rate: int, fps: int, start: int = 0) -> None:
        """The mouth is at rest before `start`."""
        self._sample_rate, self._fps = sample_rate, fps
        self._keys: deque[Keyframe] = deque([Keyframe(start - 1, np.zeros(N_CHANNELS), rest=True)])
        self._slope = np.zeros(N_CHANNELS)
        """At the first of the keyframes."""
        self._silent_until = start

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

    def settled_until(self) -> int:
        """The mouth before this sample will not change, whatever comes."""
        return self._keys[-1].sample if self._keys[-1].rest else self.ready_until()

    def at(self, samples: int | NDArray[np.int64]) -> Mouth:
        """The mouth at a sample that is ready, or at many, ascending. They may not go back."""
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
        return mouth(found if np.ndim(samples) else found[0])

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
