"""The faces that have been received of one turn, addressed by sample. The player has the sound.

Twin of clients/web/src/stream/buffer.ts.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right

import numpy as np
from numpy.typing import NDArray

from fapstream.records import N_FAPS, FapFrame, Packet

KEEP_FRAMES = 256
MOST_FRAMES = 2048
"""Also where nobody looks at them; more than a player keeps in store."""
HOLD_S = 0.12
"""A frame stands for what follows it for so long, or twice the distance of frames if that is more."""


class TurnBuffer:
    """Packets in, in order; the face of a sample out. `received`: the sample after the last one there is."""

    def __init__(self, sample_rate: int) -> None:
        self.sample_rate = sample_rate
        self.received = 0
        self._samples: list[int] = []
        self._frames: list[FapFrame] = []
        self._hold = HOLD_S * sample_rate
        self._spacing = float("inf")

    def push(self, packet: Packet) -> None:
        """More of the turn; frames that are here already are left out."""
        last = self._samples[-1] if self._samples else -1
        for frame in packet.frames:
            if frame.sample > last:
                self._space(frame.sample)
                self._samples.append(frame.sample)
                self._frames.append(frame)
        self._forget(len(self._frames) - MOST_FRAMES)
        self.received = max(self.received, packet.start + len(packet.pcm))

    def discard(self, sample: int) -> None:
        """Forget the frames from `sample` on: others are to come."""
        kept = bisect_left(self._samples, sample)
        del self._samples[kept:], self._frames[kept:]
        self.received = min(self.received, sample)

    def holds(self, sample: float) -> bool:
        """Is there a frame that tells what the face is like at `sample`?"""
        after = bisect_right(self._samples, sample)
        return self._joined(after) or (after > 0 and sample - self._samples[after - 1] <= self._hold)

    def face(self, sample: float) -> NDArray[np.float64]:
        """FAPs (68,), FAP n at n-1, at `sample`: linear between frames, held where the next one is missing.

        Asked about samples that lie back by more than some seconds, it knows nothing any more.
        """
        if not self._frames:
            return np.zeros(N_FAPS)
        after = bisect_right(self._samples, sample)
        low = max(0, after - 1)
        a, b = self._frames[low], self._frames[after if self._joined(after) else low]
        share = (sample - a.sample) / (b.sample - a.sample) if b.sample > a.sample else 0.0
        face: NDArray[np.float64] = a.values + (b.values - a.values) * share
        self._forget(low)
        return face

    def _joined(self, after: int) -> bool:
        """Do frame `after` and the one before it follow each other?"""
        inside = 0 < after < len(self._samples)
        return inside and self._samples[after] - self._samples[after - 1] <= self._hold

    def _space(self, sample: int) -> None:
        if self._samples:
            self._spacing = min(self._spacing, sample - self._samples[-1])
            self._hold = max(HOLD_S * self.sample_rate, 2.0 * self._spacing)

    def _forget(self, index: int) -> None:
        if index >= 2 * KEEP_FRAMES:
            del self._samples[:KEEP_FRAMES], self._frames[:KEEP_FRAMES]
