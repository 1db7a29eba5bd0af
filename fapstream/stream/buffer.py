"""The faces that have been received of one turn, addressed by sample. The player has the sound."""

from __future__ import annotations

from bisect import bisect_right

import numpy as np
from numpy.typing import NDArray

from fapstream.records import N_FAPS, FapFrame, Packet

KEEP_FRAMES = 256


class TurnBuffer:
    """Packets in, in order; the face of a sample out. `received`: samples of sound so far."""

    def __init__(self) -> None:
        self.received = 0
        self._samples: list[int] = []
        self._frames: list[FapFrame] = []

    def push(self, packet: Packet) -> None:
        """The next packet of the turn."""
        self._samples += [frame.sample for frame in packet.frames]
        self._frames += packet.frames
        self.received += len(packet.pcm)

    def face(self, sample: float) -> NDArray[np.float64]:
        """FAPs (68,), FAP n at n-1, at `sample`: linear between frames, the first and the last one held.

        Asked about samples that lie back by more than some seconds, it knows nothing any more.
        """
        if not self._frames:
            return np.zeros(N_FAPS)
        after = bisect_right(self._samples, sample)
        low, high = max(0, after - 1), min(after, len(self._samples) - 1)
        a, b = self._frames[low], self._frames[high]
        share = (sample - a.sample) / (b.sample - a.sample) if b.sample > a.sample else 0.0
        face: NDArray[np.float64] = a.values + (b.values - a.values) * min(1.0, max(0.0, share))
        self._forget(low)
        return face

    def _forget(self, index: int) -> None:
        if index >= 2 * KEEP_FRAMES:
            del self._samples[:KEEP_FRAMES], self._frames[:KEEP_FRAMES]
