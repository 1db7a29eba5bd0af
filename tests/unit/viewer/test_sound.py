"""Sound through a device, or without one."""

from __future__ import annotations

import numpy as np
import pytest

from fapstream.adapters.audio import AudioUnavailable, Render
from fapstream.viewer import sound
from fapstream.viewer.sound import SilentDevice, Sound, open_device

RATE = 16_000


class Card:
    """A device of which the test is the clock."""

    def __init__(self, rate: int, render: Render) -> None:
        self.time, self.closed = 100.0, False
        self._rate, self._render, self._next = rate, render, 100.0
        self.out: list[int] = []

    def now(self) -> float:
        return self.time

    def poll(self) -> None:
        """Comes by itself."""

    def fetch(self, n: int) -> None:
        """Fetch n samples to be heard 50 ms after they are due."""
        self.out += [int(v) for v in self._render(n, self._next + 0.05)]
        self._next += n / self._rate

    def close(self) -> None:
        self.closed = True


def test_what_is_heard_follows_the_devices_clock() -> None:
    cards: list[Card] = []

    def open_(rate: int, render: Render) -> Card:
        cards.append(Card(rate, render))
        return cards[0]

    playing = Sound(RATE, open_)
    card = cards[0]
    assert playing.heard() is None
    playing.begin(1)
    playing.push(1, 0, np.arange(8000).astype(np.int16), hold=False)
    playing.end(1)
    for _ in range(60):
        card.fetch(160)
    card.time = 100.25
    heard = playing.heard()
    assert heard is not None
    assert (heard.turn, heard.state) == (1, "playing")
    assert heard.sample == pytest.approx(0.2 * RATE)
    later = playing.heard(later_s=0.1)
    assert later is not None
    assert later.sample == pytest.approx(0.3 * RATE)
    assert card.out[1000:7000] == list(range(1000, 7000))
    card.time = 101.0
    end = playing.heard()
    assert end is not None
    assert (end.state, end.sample) == ("over", 8000)
    assert playing.underruns == 0
    playing.close()
    assert card.closed


def test_silence_keeps_real_time() -> None:
    now = [5.0]
    fetched: list[tuple[int, float]] = []

    def render(n: int, at: float) -> np.ndarray:
        fetched.append((n, at))
        return np.zeros(n, np.int16)

    device = SilentDevice(RATE, render, lambda: now[0])
    device.poll()
    for step in (0.01, 0.5, 0.0, 0.033):
        now[0] += step
        device.poll()
    assert sum(n for n, _ in fetched) == round(0.543 * RATE)
    assert [at for _, at in fetched] == pytest.approx([5.0, 5.01, 5.51], abs=1e-4)
    assert device.now() == now[0]
    device.close()


def test_without_a_card_there_is_one_warning_and_silence(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object) -> None:
        raise AudioUnavailable("no sound device can be opened (-9996)")

    monkeypatch.setattr(sound, "Output", fails)
    warnings: list[str] = []
    playing = Sound(RATE, open_device(warnings.append))
    assert warnings == ["no sound device can be opened (-9996); it goes on in silence"]
    playing.begin(1)
    playing.end(1)
    heard = playing.heard()
    assert heard is None or heard.turn == 1
    playing.close()
