"""Turns, the face of what is heard, and the end of the show, with window, renderer and sound card made up."""

from __future__ import annotations

import asyncio
from typing import Any

import numpy as np
import pytest

from fapstream.adapters.audio import Render
from fapstream.protocol.generated import Ack
from fapstream.records import FapFrame, Packet
from fapstream.viewer.face import TURN_S, FaceMixer
from fapstream.viewer.show import Show, Shown, run_show
from fapstream.viewer.sound import SilentDevice

RATE = 16_000


class Screen:
    """Window and renderer: remembers the faces it was shown."""

    def __init__(self) -> None:
        self.closed, self.faces, self.titles = False, [], []
        self.head = type("Head", (), {"name": "nobody"})()

    def deform(self, values: np.ndarray) -> None:
        self.faces.append(values.copy())

    def show(self, _renderer: Any) -> None:
        """Nothing to be seen."""

    def title(self, text: str) -> None:
        self.titles.append(text)


class Time:
    def __init__(self) -> None:
        self.now = 50.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Time:
    found = Time()
    monkeypatch.setattr("fapstream.viewer.show.time.monotonic", found)
    return found


def show_of(screen: Screen, clock: Time) -> Show:
    def open_(rate: int, render: Render) -> SilentDevice:
        return SilentDevice(rate, render, clock)

    return Show(screen, screen, FaceMixer(None), open_)  # type: ignore[arg-type]


def say(show: Show, turn: int, seconds: float = 1.0, rate: int = RATE) -> None:
    """FAP 5 is the number of milliseconds since the turn began."""
    show.begin(turn, rate)
    frames = tuple(
        FapFrame(round(k * rate / 25), np.eye(68, dtype=np.int32)[4] * 40 * k)
        for k in range(round(25 * seconds) + 1)
    )
    show.push(Packet(turn, 0, np.full(round(seconds * rate), 5, np.int16), frames))
    show.end(turn)


def play(show: Show, clock: Time, seconds: float) -> None:
    for _ in range(round(seconds * 50)):
        clock.now += 0.02
        show.frame()


def test_the_face_is_that_of_the_sample_heard(clock: Time) -> None:
    screen = Screen()
    show = show_of(screen, clock)
    shown: list[Shown] = []
    show.told = shown.append
    show.frame()
    say(show, 1)
    assert show.busy
    start = clock.now
    for _ in range(40):
        clock.now += 0.02
        show.frame()
        if clock.now - start > TURN_S:
            assert screen.faces[-1][4] == pytest.approx(1000 * (clock.now - start), abs=1.0)
    playing = [s for s in shown if s.face is not None and s.heard is not None]
    assert len(playing) == 40
    assert all(s.face == s.heard for s in playing)
    assert shown[0].as_dict() == {"at": shown[0].at, "face": None, "heard": None}


def test_the_server_is_told_what_is_heard_how_late_the_face_is_and_what_ran_dry(clock: Time) -> None:
    show = show_of(Screen(), clock)
    show.begin(1, RATE)
    assert show.ack(1) is None
    show.push(Packet(1, 0, np.full(RATE * 4 // 5, 5, np.int16)))
    play(show, clock, 0.2)
    assert show.ack(1) == Ack(turn=1, sample=3200, queue=9600, underruns=0, skew=0)
    assert show.ack(2) is None
    late = show._renderer.deform
    show._renderer.deform = lambda values: (late(values), setattr(clock, "now", clock.now + 0.02))  # type: ignore[method-assign]
    show._lead = 0.0
    show.frame()
    ack = show.ack(1)
    assert ack is not None
    assert ack.skew == pytest.approx(0.15 * 20_000, abs=1)
    play(show, clock, 1.0)
    show.close()
    assert show.underruns == 1


def test_when_all_is_heard_it_is_not_busy_and_the_face_eases_out(clock: Time) -> None:
    screen = Screen()
    show = show_of(screen, clock)
    say(show, 1, 0.2)
    play(show, clock, 0.3)
    assert not show.busy
    assert screen.faces[-1][4] > 0
    play(show, clock, 0.3)
    assert screen.faces[-1][4] == 0
    assert show.ack(1) is None


def test_turns_follow_each_other_also_at_another_rate(clock: Time) -> None:
    screen = Screen()
    show = show_of(screen, clock)
    say(show, 1, 0.2)
    say(show, 2, 0.2)
    play(show, clock, 0.3)
    heard = show.heard()
    assert heard is not None
    assert heard.turn == 2
    play(show, clock, 0.3)
    assert not show.busy
    say(show, 3, 0.2, rate=22_050)
    play(show, clock, 0.1)
    heard = show.heard()
    assert heard is not None
    assert heard.turn == 3
    assert heard.sample == pytest.approx(0.1 * 22_050, abs=1)
    show.close()
    assert not show.busy


def test_its_title_tells_how_fast_it_is(clock: Time) -> None:
    screen = Screen()
    play(show_of(screen, clock), clock, 5.0)
    assert screen.titles[-1] == "nobody: 50 pictures a second"
    assert len(screen.titles) in (4, 5)


async def test_the_show_ends_with_its_script_and_the_last_sample() -> None:
    screen = Screen()
    show = Show(screen, screen, FaceMixer(None), SilentDevice)  # type: ignore[arg-type]

    async def script() -> None:
        say(show, 1, 0.2)

    async with asyncio.timeout(5):
        await run_show(show, script())
    assert max(face[4] for face in screen.faces) > 100
    assert not show.busy


async def test_a_closed_window_ends_it_at_once_and_a_fault_comes_through() -> None:
    screen = Screen()
    show = Show(screen, screen, FaceMixer(None), SilentDevice)  # type: ignore[arg-type]
    stopped = []

    async def forever() -> None:
        try:
            await asyncio.sleep(0.05)
            screen.closed = True
            await asyncio.Event().wait()
        finally:
            stopped.append(True)

    async with asyncio.timeout(5):
        await run_show(show, forever())
    assert stopped

    async def fails() -> None:
        raise OSError("gone")

    screen.closed = False
    with pytest.raises(OSError, match="gone"):
        await run_show(show, fails())
