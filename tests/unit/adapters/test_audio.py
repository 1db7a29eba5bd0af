"""Sound out: the callback's bookkeeping without a device, and what is said where there is none."""

from __future__ import annotations

import builtins
import sys
import types
from typing import Any

import numpy as np
import pytest

from fapstream.adapters import audio
from fapstream.adapters.audio import AudioUnavailable, Output, Player

RATE = 16000
LATENCY = 800


class Device:
    """A stream and a PortAudio that only remember."""

    def __init__(self) -> None:
        self.closed = self.terminated = False

    def get_output_latency(self) -> float:
        return LATENCY / RATE

    def close(self) -> None:
        self.closed = True

    def terminate(self) -> None:
        self.terminated = True


@pytest.fixture
def device(monkeypatch: pytest.MonkeyPatch) -> Device:
    made = Device()
    monkeypatch.setattr(audio, "_open", lambda rate, callback, buffer_ms=0: (made, made))
    return made


def pull(player: Player, n: int) -> list[int]:
    """What the device is given when it asks for n samples."""
    data, status = player._callback(None, n, None, 0)
    assert status == 0
    assert len(data) == 2 * n
    return [int(sample) for sample in np.frombuffer(data, np.int16)]


def test_sound_comes_out_in_order_and_then_silence(device: Device) -> None:
    player = Player(RATE)
    assert pull(player, 3) == [0, 0, 0]
    player.write(np.array([1, 2, 3], np.int16))
    player.write(np.array([4, 5, 6, 7], np.int16))
    assert pull(player, 2) == [1, 2]
    assert pull(player, 3) == [3, 4, 5]
    assert pull(player, 4) == [6, 7, 0, 0]
    assert pull(player, 2) == [0, 0]
    assert player.given == 7


def test_what_is_heard_lags_by_the_latency_and_arrives_in_the_end(device: Device) -> None:
    player = Player(RATE)
    player.write(np.ones(2000, np.int16))
    heard = []
    for _ in range(20):
        pull(player, 160)
        heard.append(player.heard)
    assert heard[4] == 0
    assert heard[9] == 1600 - LATENCY
    assert heard == sorted(heard)
    assert heard[-1] == 2000
    assert player.idle


def test_idle_only_when_the_last_sample_has_left_the_device(device: Device) -> None:
    player = Player(RATE)
    assert player.idle
    player.write(np.ones(320, np.int16))
    assert not player.idle
    for _ in range(2):
        pull(player, 160)
    assert not player.idle, "given to the device, but its latency has not gone by"
    for _ in range(LATENCY // 160):
        pull(player, 160)
    assert player.idle


def test_sound_after_a_gap_takes_nothing_back(device: Device) -> None:
    player = Player(RATE)
    heard = []
    for _ in range(3):
        player.write(np.ones(320, np.int16))
        for _ in range(12):
            pull(player, 160)
            heard.append(player.heard)
    assert heard == sorted(heard)
    assert heard[11] == 320
    assert heard[-1] == 960


def test_an_output_fetches_and_tells_when_it_will_be_heard(device: Device) -> None:
    asked: list[tuple[int, float]] = []

    def render(n: int, at: float) -> np.ndarray:
        asked.append((n, at))
        return np.arange(n, dtype=np.int16)

    device.get_time = lambda: 12.5  # type: ignore[attr-defined]
    output = Output(RATE, render)
    times = {"current_time": 7.0, "output_buffer_dac_time": 7.25}
    assert output._callback(None, 4, times, 0) == (np.arange(4, dtype=np.int16).tobytes(), 0)
    output._callback(None, 2, {**times, "output_buffer_dac_time": 0.0}, 4)
    assert asked == [(4, 7.25), (2, 7.0)]
    assert (output.late, output.now()) == (1, 12.5)
    output.poll()
    output.close()
    assert device.closed
    assert device.terminated


def test_close(device: Device) -> None:
    Player(RATE).close()
    assert device.closed
    assert device.terminated


def test_without_pyaudio_the_way_out_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def missing(name: str, *args: Any, **kwargs: Any) -> Any:
        if name == "pyaudio":
            raise ImportError(name)
        return real(name, *args, **kwargs)

    monkeypatch.delitem(sys.modules, "pyaudio", raising=False)
    monkeypatch.setattr(builtins, "__import__", missing)
    with pytest.raises(AudioUnavailable, match=r"fapstream\[play\].*--wav"):
        Player(RATE)


def test_without_a_device_the_way_out_is_told(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    closed = []

    class NoDevice:
        def open(self, **_: object) -> object:
            print("ALSA lib: a hundred lines", file=sys.stderr)
            raise OSError("Invalid output device")

        def terminate(self) -> None:
            closed.append(True)

    fake = types.SimpleNamespace(PyAudio=NoDevice, paInt16=8)
    monkeypatch.setitem(sys.modules, "pyaudio", fake)
    with pytest.raises(AudioUnavailable, match=r"Invalid output device.*--wav"):
        Player(RATE)
    assert closed == [True]
    assert AudioUnavailable.code == "no_audio"


def test_what_the_back_ends_print_is_kept_off_the_terminal(capfd: pytest.CaptureFixture[str]) -> None:
    import os

    with audio._quiet():
        os.write(2, b"noise\n")
    os.write(2, b"signal\n")
    assert capfd.readouterr().err == "signal\n"
