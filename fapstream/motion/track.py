"""Timed phones in, FAP frames out: the face of one turn on the turn's sample clock."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from fapstream.motion.chance import BACK_S, minimum_jerk
from fapstream.motion.feeling import Feeling
from fapstream.motion.gestures import Gestures
from fapstream.motion.hermite import Values
from fapstream.motion.idle import Idle, IdleLife, Look
from fapstream.motion.mixer import Streams, mix
from fapstream.motion.mouths import Motion, mouth_track
from fapstream.motion.speech import MouthTrack
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

    A frame can be given once as many phones after it are known as the mouth's model looks ahead, or when
    everything that will come has come up to a pause.
    """

    def __init__(
        self,
        lang: str,
        sample_rate: int,
        fps: int,
        seed: int = 0,
        motion: Motion | None = None,
        mouth: MouthTrack | None = None,
    ) -> None:
        """`motion`: how the mouth moves; or the `mouth` itself, and then the track cannot be cut."""
        self._motion = motion or Motion()
        self._lang = lang
        self._sample_rate = sample_rate
        self._fps = fps
        self._seed = seed
        self._idle = _Ahead(IdleLife(seed), fps)
        self._frame = 0
        self._shown: deque[FapFrame] = deque(maxlen=round(BACK_S * fps))
        self._made: deque[FapFrame] = deque()
        self._speech = mouth or mouth_track(self._motion, lang, sample_rate, fps)
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
            self._speech.add(timed)
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
        self._speech = mouth_track(self._motion, self._lang, self._sample_rate, self._fps, sample)
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
