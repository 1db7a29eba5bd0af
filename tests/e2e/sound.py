"""A sound card made of software: PulseAudio with a null sink, and a recorder on its monitor."""

from __future__ import annotations

import os
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

RATE = 48_000


@contextmanager
def sound_card(folder: Path) -> Iterator[dict[str, str]]:
    """The environment in which programs play to it."""
    (folder / "run").mkdir(mode=0o700)
    socket = folder / "sock"
    env = {
        **os.environ,
        "PULSE_RUNTIME_PATH": str(folder / "run"),
        "HOME": str(folder),
        "XDG_CONFIG_HOME": str(folder),
    }
    sink = f"module-null-sink sink_name=fap rate={RATE} channels=1 format=s16le norewinds=1"
    command = [
        "pulseaudio", "-n", "--daemonize=no", "--use-pid-file=no", "--exit-idle-time=-1", "--disable-shm=yes",
        "-L", sink, "-L", f"module-native-protocol-unix socket={socket} auth-anonymous=1",
    ]  # fmt: skip
    with (folder / "log").open("w") as log:
        process = subprocess.Popen(command, env=env, stderr=log)
    try:
        deadline = time.monotonic() + 10
        while not socket.exists():
            if process.poll() is not None or time.monotonic() > deadline:
                raise RuntimeError(f"PulseAudio did not start: {(folder / 'log').read_text()}")
            time.sleep(0.02)
        yield {"PULSE_SERVER": f"unix:{socket}", "HOME": str(folder)}
    finally:
        process.terminate()
        process.wait(5)


@dataclass(frozen=True, slots=True)
class Recording:
    """What was heard. `start`: wall clock of the first sample, seconds since the epoch."""

    pcm: NDArray[np.int16]
    start: float

    def at(self, sample: float) -> float:
        """Wall clock of a sample."""
        return self.start + sample / RATE


class Recorder:
    """Records what the card plays, with the wall clock of every sample."""

    def __init__(self, env: dict[str, str]) -> None:
        command = ["parec", "--raw", "-d", "fap.monitor", f"--rate={RATE}", "--channels=1", "--format=s16le"]
        self._process = subprocess.Popen(
            [*command, "--latency-msec=10"], stdout=subprocess.PIPE, env={**os.environ, **env}
        )
        self._chunks: list[tuple[float, bytes]] = []
        self._thread = threading.Thread(target=self._drain, daemon=True)
        self._thread.start()

    def heard_so_far(self) -> NDArray[np.int16]:
        """The sound until now."""
        data = b"".join(chunk for _, chunk in list(self._chunks))
        return np.frombuffer(data[: len(data) // 2 * 2], "<i2")

    def stop(self) -> Recording:
        """End and return everything."""
        self._process.terminate()
        self._thread.join(5)
        self._process.wait(5)
        data = b"".join(chunk for _, chunk in self._chunks)
        pcm = np.frombuffer(data[: len(data) // 2 * 2], "<i2")
        ends = np.cumsum([len(chunk) // 2 for _, chunk in self._chunks])
        times = np.array([t for t, _ in self._chunks])
        return Recording(pcm, float(np.percentile(times - ends / RATE, 10)))

    def _drain(self) -> None:
        assert self._process.stdout is not None
        fd = self._process.stdout.fileno()
        while data := os.read(fd, 4096):
            self._chunks.append((time.time(), data))
