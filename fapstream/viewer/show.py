"""A head at work in a window: every picture shows the sample that is heard while it is shown."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Coroutine
from dataclasses import asdict, dataclass
from typing import Any

from fapstream.protocol import generated as g
from fapstream.records import Packet
from fapstream.stream import Heard, TurnBuffer
from fapstream.viewer.face import FaceMixer
from fapstream.viewer.renderer import Renderer
from fapstream.viewer.sound import OpenDevice, Sound
from fapstream.viewer.window import Window

FOLLOW = 0.15
"""How quickly lead, skew and frame rate follow, as a share of each new value."""
MOST_LEAD_S = 0.1
"""The picture is never drawn for a sample further ahead than this."""
MOST_FPS = 60
TITLE_S = 1.0


@dataclass(frozen=True, slots=True)
class Shown:
    """One picture: `at` is when it was handed over (wall clock, s), `face` the sample that it shows.

    `heard` is the sample heard at that moment; both are None in silence.
    """

    at: float
    face: float | None
    heard: float | None

    def as_dict(self) -> dict[str, float | None]:
        """For JSON."""
        return asdict(self)


class Show:
    """Takes turns as they come, draws when asked to."""

    def __init__(self, window: Window, renderer: Renderer, mixer: FaceMixer, open_device: OpenDevice) -> None:
        self.window = window
        self._renderer, self._mixer, self._open = renderer, mixer, open_device
        self._sound: Sound | None = None
        self._buffers: dict[int, TurnBuffer] = {}
        self._start = self._drawn = self._titled = time.monotonic()
        self._lead = self._skew = 0.0
        self._dry = 0
        self.fps = 0.0
        self.told: Callable[[Shown], None] | None = None
        """Hears of every picture."""

    # --- what is said

    def begin(self, turn: int, sample_rate: int, live: bool = False) -> None:
        """A turn is going to be heard. `live`: it is sent as it is said, see Voice."""
        if self._sound and self._sound.sample_rate != sample_rate:
            self.close()
        self._sound = self._sound or Sound(sample_rate, self._open)
        self._buffers[turn] = TurnBuffer(sample_rate)
        self._sound.begin(turn, live)

    def push(self, packet: Packet) -> None:
        """More of a turn."""
        if self._sound and packet.turn in self._buffers:
            self._buffers[packet.turn].push(packet)
            self._sound.push(packet.turn, packet.start, packet.pcm, packet.hold)

    def end(self, turn: int) -> None:
        """The turn is complete."""
        if self._sound:
            self._sound.end(turn)

    def discard(self, turn: int, sample: int) -> None:
        """What the turn had from a sample on is void."""
        if self._sound and turn in self._buffers:
            self._buffers[turn].discard(sample)
            self._sound.discard(turn, sample)

    def pause(self, on: bool) -> None:
        """Stand still, or go on."""
        if self._sound:
            self._sound.pause(on)

    @property
    def busy(self) -> bool:
        """Is something said that has not been heard to its end?"""
        return bool(self._buffers)

    def heard(self) -> Heard | None:
        """What is heard now."""
        return self._sound.heard() if self._sound else None

    def ack(self, turn: int) -> g.Ack | None:
        """What the server is to know of a turn; None unless it is being heard."""
        heard, buffer = self.heard(), self._buffers.get(turn)
        if not heard or not buffer or (heard.turn, heard.state) != (turn, "playing"):
            return None
        sample = int(heard.sample)
        queue, skew = max(0, buffer.received - sample), round(1e6 * self._skew)
        return g.Ack(turn=turn, sample=sample, queue=queue, underruns=self.underruns, skew=skew)

    @property
    def underruns(self) -> int:
        """Times that the sound ran dry."""
        return self._dry + (self._sound.underruns if self._sound else 0)

    # --- what is seen

    def frame(self) -> None:
        """Draw one picture and show it."""
        now = time.monotonic()
        heard = self._sound.heard(self._lead) if self._sound else None
        self._forget(heard)
        buffer = self._buffers.get(heard.turn) if heard else None
        self._renderer.deform(self._mixer.show(buffer, heard, now - self._start))
        self.window.show(self._renderer)
        self._measure(now, heard)
        if now - self._titled > TITLE_S:
            self._titled = now
            self.window.title(f"{self._renderer.head.name}: {self.fps:.0f} pictures a second")

    def close(self) -> None:
        """Fall silent."""
        self._dry = self.underruns
        if self._sound:
            self._sound.close()
        self._sound = None
        self._buffers.clear()

    def _forget(self, heard: Heard | None) -> None:
        """Turns that are over, and those before them."""
        if heard:
            over = [turn for turn in self._buffers if turn < heard.turn + (heard.state == "over")]
            for turn in over:
                del self._buffers[turn]

    def _measure(self, began: float, shown: Heard | None) -> None:
        now = time.monotonic()
        self._lead += FOLLOW * (min(MOST_LEAD_S, now - began) - self._lead)
        self.fps += FOLLOW * (1 / max(1e-3, now - self._drawn) - self.fps)
        self._drawn = now
        heard = self.heard()
        pair: tuple[float, float] | tuple[None, None] = (None, None)
        if self._sound and shown and heard and heard.state == shown.state == "playing":
            pair = shown.sample, heard.sample
            late = (heard.sample - shown.sample) / self._sound.sample_rate
            self._skew += FOLLOW * (late - self._skew)
        if self.told:
            self.told(Shown(time.time(), *pair))


async def run_show(show: Show, script: Coroutine[Any, Any, None]) -> None:
    """Pictures until the window is closed, or the script is at its end and everything heard.

    Raises what the script raises.
    """
    task = asyncio.create_task(script)
    try:
        while not show.window.closed and not (task.done() and not show.busy):
            began = time.monotonic()
            show.frame()
            await asyncio.sleep(max(0.0, 1 / MOST_FPS - (time.monotonic() - began)))
            if task.done():
                task.result()
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
