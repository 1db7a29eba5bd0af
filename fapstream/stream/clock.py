"""Which frame of the sound card is being heard: its timestamps, smoothed, for the picture follows them."""

from __future__ import annotations

SMOOTH = 0.1
SNAP_S = 0.015
"""An error larger than this is no jitter: the card has stalled or changed, and is followed at once."""


class OutputClock:
    """Times of frames on one clock (card seconds) against another (the listener's)."""

    def __init__(self) -> None:
        self._offset: float | None = None

    def observe(self, frame_s: float, heard_s: float) -> None:
        """The frame at `frame_s` of the card's own time is heard at `heard_s`."""
        offset = frame_s - heard_s
        if self._offset is None or abs(offset - self._offset) > SNAP_S:
            self._offset = offset
        else:
            self._offset += SMOOTH * (offset - self._offset)

    def heard(self, now: float, rendered_s: float) -> float:
        """Card time heard at `now`, never below 0 or beyond what was rendered."""
        return 0.0 if self._offset is None else max(0.0, min(rendered_s, self._offset + now))
