"""When a packet may leave: at most so far ahead of what is being heard. `now` is an argument."""

from __future__ import annotations

LEAD_S = 1.5
"""Packets are sent this far ahead of what is heard, so a listener never has more in store."""

SHARED_LEAD_S = 0.5
"""The same where many listen: what is in store is late for them."""

FIRST_S, BUILD_UP = 0.3, 2.5
"""A turn begins with so much at once; then it is sent so many times faster than real time until the lead is
reached. Whoever begins leaves time to those who speak, and less is made in vain if it is interrupted."""


GROUP_S = 0.32
"""Packets leave together by so much sound: with a second in store nobody hears that, and it spares half the
work of sending."""


class Pacer:
    """The clock of one turn as the listener is thought to hear it.

    `_origin` is the time at which sample 0 was heard, as far as we know: real time from the first
    packet on, later when the turn ran dry, corrected by what the listener acknowledges.
    """

    def __init__(
        self, sample_rate: int, lead_s: float = LEAD_S, group_s: float = 0.0, follows: float | None = None
    ) -> None:
        """`follows`: when the turn before it will have been heard; this one is heard no sooner."""
        self._follows = follows
        self._sample_rate = sample_rate
        self._lead_s = lead_s
        self._group = max(1, round(group_s * sample_rate))
        self._origin: float | None = None
        self._sent_end = 0
        self._paused_at: int | None = None

    def due(self, sample: int, now: float) -> float:
        """The time from which the packet that begins at `sample` may leave."""
        if self._origin is None:
            return now if self._follows is None else max(now, self._follows - self._lead_s)
        at = sample // self._group * self._group / self._sample_rate
        built_up = -self._lead_s if self._follows is not None else (at - FIRST_S) / BUILD_UP
        return self._origin + max(at - self._lead_s, built_up)

    def sent(self, start: int, end: int, now: float) -> None:
        """A packet has left. One that comes after its time shifts everything behind it."""
        late = now - start / self._sample_rate
        if self._origin is None:
            self._origin = max(late, self._follows or late)
        else:
            self._origin = max(self._origin, late)
        self._sent_end = max(self._sent_end, end)

    def discard(self, sample: int) -> None:
        """What was sent from `sample` on is void."""
        self._sent_end = min(self._sent_end, sample)

    def acknowledge(self, sample: int, now: float) -> None:
        """The listener hears `sample` now. What it cannot have is clamped."""
        sample = min(sample, self._sent_end)
        if self._paused_at is not None:
            self._paused_at = sample
        elif self._origin is not None:
            self._origin = now - sample / self._sample_rate

    def heard(self, now: float) -> int:
        """The sample thought to be heard, never beyond what was sent."""
        if self._paused_at is not None:
            return self._paused_at
        if self._origin is None:
            return 0
        return max(0, min(self._sent_end, int((now - self._origin) * self._sample_rate)))

    def ends(self, now: float) -> float:
        """When all that was sent will have been heard."""
        if self._origin is None or self._paused_at is not None:
            return now
        return max(now, self._origin + self._sent_end / self._sample_rate)

    def pause(self, now: float) -> None:
        """What is heard stands still."""
        self._paused_at = self.heard(now)

    def go_on(self, now: float) -> None:
        """It goes on where it stood."""
        if self._paused_at is not None and self._origin is not None:
            self._origin = now - self._paused_at / self._sample_rate
        self._paused_at = None
