"""A Redis server of one's own: it keeps nothing on disk and can be killed and started again."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

COMMAND = "redis-server"
START_S = 10.0


def installed() -> bool:
    """Whether this machine has one."""
    return shutil.which(COMMAND) is not None


class Broker:
    """Listens on a Unix socket in its folder until it is killed. `options`: more of the server's own."""

    def __init__(self, folder: Path, *options: str) -> None:
        self._folder = folder
        self._options = options
        self._process: subprocess.Popen[bytes] | None = None
        self.socket = str(folder / "redis")
        self.url = f"unix://{self.socket}"

    @property
    def pid(self) -> int:
        """The process, which must run."""
        assert self._process
        return self._process.pid

    def start(self) -> None:
        """With an empty memory. Returns when it answers."""
        Path(self.socket).unlink(missing_ok=True)
        command = [COMMAND, "--port", "0", "--unixsocket", self.socket, "--save", "", "--appendonly", "no"]
        self._process = subprocess.Popen(
            [*command, "--dir", str(self._folder), *self._options], stdout=subprocess.DEVNULL
        )
        give_up = time.monotonic() + START_S
        while not self._answers():
            if time.monotonic() > give_up or self._process.poll() is not None:
                raise RuntimeError("redis-server did not start")
            time.sleep(0.01)

    def kill(self) -> None:
        """As a crash would: without a goodbye."""
        if self._process:
            self._process.kill()
            self._process.wait()
            self._process = None

    def _answers(self) -> bool:
        with socket.socket(socket.AF_UNIX) as asking:
            asking.settimeout(1.0)
            try:
                asking.connect(self.socket)
                asking.sendall(b"PING\r\n")
                return asking.recv(64).startswith(b"+PONG")
            except OSError:
                return False


@contextmanager
def broker(*options: str) -> Iterator[Broker]:
    """One that is not running yet; it is killed at the end."""
    with tempfile.TemporaryDirectory(prefix="fapstream-") as folder:
        made = Broker(Path(folder), *options)
        try:
            yield made
        finally:
            made.kill()


def cpu_s(pid: int) -> float:
    """Seconds that the main thread of a process has computed."""
    fields = Path(f"/proc/{pid}/task/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
