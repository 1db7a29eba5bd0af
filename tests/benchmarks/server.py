"""A real server in a process of its own, on a free port of this machine."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def server(*arguments: str) -> Iterator[tuple[str, int]]:
    """Its address, such as `127.0.0.1:40123`, and its pid."""
    command = [sys.executable, "-m", "fapstream", "serve", "--port", "0", *arguments]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        line = process.stdout.readline()
        if "http://" not in line:
            raise RuntimeError(f"the server did not start: {line!r}")
        yield line.split("http://")[1].strip().rstrip("/"), process.pid
    finally:
        process.terminate()
        process.wait(40)
