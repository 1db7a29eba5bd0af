"""Sound, frames and marks of a turn, cut into packets on the sample clock."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence

import numpy as np

from fapstream.records import FapFrame, Mark, Packet, Pcm, TurnFormat

PACKET_MS = 40


class Packetizer:
    """Collects sound and marks in order and cuts them; frames are handed in at the cut."""

    def __init__(self, turn: TurnFormat) -> None:
        self._turn = turn.turn
        self.packet_samples = turn.sample_rate * PACKET_MS // 1000
        self.cut_end = 0
        """Sample at which the next packet begins."""
        self.pcm_end = 0
        """Sample after the last one collected."""
        self._border = 0
        """A packet begins here."""
        self._chunks: deque[Pcm] = deque()
        self._marks: deque[Mark] = deque()

    def add(self, start: int, pcm: Pcm, marks: Iterable[Mark] = ()) -> None:
        """More of the turn. Raises ValueError if `start` leaves a gap or overlaps."""
        if start != self.pcm_end:
            raise ValueError(f"sound at {start}, expected {self.pcm_end}")
        self._marks.extend(marks)
        if len(pcm):
            self._chunks.append(pcm)
            self.pcm_end += len(pcm)

    def next_end(self, last: bool = False) -> int | None:
        """Where the next packet would end; None if there is not enough sound. `last` allows a short one."""
        end = self.cut_end + self.packet_samples
        if self.cut_end < self._border:
            end = min(end, self._border)
        if end <= self.pcm_end:
            return end
        return self.pcm_end if last and self.pcm_end > self.cut_end else None

    def cut(self, end: int, frames: Sequence[FapFrame], hold: bool = False) -> Packet:
        """The packet up to `end`, which `next_end` gave."""
        start, self.cut_end = self.cut_end, end
        marks = []
        while self._marks and self._marks[0].sample < end:
            marks.append(self._marks.popleft())
        return Packet(self._turn, start, self._take(end - start), tuple(frames), tuple(marks), hold)

    def cut_back(self, sample: int) -> None:
        """Everything from a sample on is void, in packets already or not; what comes now begins there, with a
        packet of its own. Raises ValueError beyond what was collected."""
        if sample > self.pcm_end:
            raise ValueError(f"a cut at {sample}, beyond the last sample {self.pcm_end}")
        kept = self._take(max(0, sample - self.cut_end))
        self._chunks = deque([kept] if len(kept) else [])
        self._marks = deque(mark for mark in self._marks if mark.sample < sample)
        self.cut_end = min(self.cut_end, sample)
        self.pcm_end = self._border = sample

    def _take(self, n: int) -> Pcm:
        parts = []
        while n:
            chunk = self._chunks.popleft()
            parts.append(chunk[:n])
            if len(chunk) > n:
                self._chunks.appendleft(chunk[n:])
            n -= len(parts[-1])
        return parts[0] if len(parts) == 1 else np.concatenate(parts or [np.zeros(0, np.int16)])
