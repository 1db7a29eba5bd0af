"""Sound out: what the device's thread does, and what is said where there is no device."""

from __future__ import annotations

import builtins
import sys
import types
from typing import Any

import numpy as np
import pytest

from fapstream.adapters import audio
from fapstream.adapters.audio import AudioUnavailable, Output

RATE = 16000


class Device:
    """A stream and a PortAudio that only remember."""

    def __init__(self) -> None:
        self.closed = self.terminated = False

    def close(self) -> None:
        self.closed = True

    def terminate(self) -> None:
        self.terminated = True


def silence(n: int, _at: float) -> np.ndarray:
    return np.zeros(n, np.int16)


@pytest.fixture
def device(monkeypatch: pytest.MonkeyPatch) -> Device:
    made = Device()
    monkeypatch.setattr(audio, "_open", lambda rate, callback, buffer_ms=0: (made, made))
    return made


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


def test_without_pyaudio_the_way_out_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def missing(name: str, *args: Any, **kwargs: Any) -> Any:
        if name == "pyaudio":
            raise ImportError(name)
        return real(name, *args, **kwargs)

    monkeypatch.delitem(sys.modules, "pyaudio", raising=False)
    monkeypatch.setattr(builtins, "__import__", missing)
    with pytest.raises(AudioUnavailable, match=r"fapstream\[play\]"):
        Output(RATE, silence)


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
    with pytest.raises(AudioUnavailable, match="Invalid output device"):
        Output(RATE, silence)
    assert closed == [True]
    assert AudioUnavailable.code == "no_audio"


def test_what_the_back_ends_print_is_kept_off_the_terminal(capfd: pytest.CaptureFixture[str]) -> None:
    import os

    with audio._quiet():
        os.write(2, b"noise\n")
    os.write(2, b"signal\n")
    assert capfd.readouterr().err == "signal\n"
