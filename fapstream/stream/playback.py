"""Sound on its way to the ear: player, its reports and the card's clock in one piece."""

from __future__ import annotations

from fapstream.records import Pcm
from fapstream.stream.clock import OutputClock
from fapstream.stream.heard import Heard, HeardMap
from fapstream.stream.player import Player


class Playback:
    """`player` takes the sound; the card fetches it with `render`; `heard` tells what has arrived."""

    def __init__(self, sample_rate: int) -> None:
        self.sample_rate = sample_rate
        self._map = HeardMap()
        self.player = Player(sample_rate, self._map.apply)
        self._clock = OutputClock()
        self._frame = 0

    def render(self, n: int, heard_s: float) -> Pcm:
        """The next n frames; the first of them is heard at `heard_s` of the listener's clock."""
        self._clock.observe(self._frame / self.sample_rate, heard_s)
        out = self.player.render(n, self._frame)
        self._frame += n
        return out

    def heard(self, now: float) -> Heard | None:
        """What is heard at `now` of the same clock; None before the first sound."""
        seconds = self._clock.heard(now, self._frame / self.sample_rate)
        return self._map.at(seconds * self.sample_rate)
