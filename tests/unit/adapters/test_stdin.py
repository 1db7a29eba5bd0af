"""Reading that neither blocks the loop nor the end of the program."""

from __future__ import annotations

import asyncio
import fcntl
import os
import signal
import subprocess
import sys
import termios
import time
from pathlib import Path
from typing import IO

import pytest

from fapstream.adapters.stdin import AHEAD, READ_BYTES, chunks


async def test_it_gives_what_comes_when_it_comes() -> None:
    out, into = os.pipe()
    stream = chunks(out)
    for piece in (b"one", "δύο".encode()[:1], "δύο".encode()[1:]):
        os.write(into, piece)
        assert await asyncio.wait_for(anext(stream), 5) == piece
    os.close(into)
    with pytest.raises(StopAsyncIteration):
        await asyncio.wait_for(anext(stream), 5)
    os.close(out)


async def test_a_file_is_read_whole_and_not_far_ahead(tmp_path: Path) -> None:
    path = tmp_path / "text"
    path.write_bytes(os.urandom(READ_BYTES * (AHEAD + 6) + 5))
    with path.open("rb") as file:
        stream = chunks(file.fileno())
        first = await anext(stream)
        await asyncio.sleep(0.05)
        assert file.tell() <= READ_BYTES * (AHEAD + 1)
        assert first + b"".join([data async for data in stream]) == path.read_bytes()


async def test_what_cannot_be_read_is_said() -> None:
    out, into = os.pipe()
    os.close(into)
    os.close(out)
    with pytest.raises(OSError, match="descriptor"):
        await anext(chunks(out))


def heed_interrupts() -> None:
    """Programs started in the background are made to ignore them; this one shall not."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def unread(pipe: IO[bytes]) -> int:
    """How many bytes are in a pipe."""
    return int.from_bytes(fcntl.ioctl(pipe, termios.FIONREAD, bytes(4)), sys.byteorder)


def test_a_program_that_waits_for_input_can_be_interrupted() -> None:
    command = [sys.executable, "-m", "fapstream", "say", "-", "--wav", os.devnull]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdin=pipe, stderr=pipe, preexec_fn=heed_interrupts) as process:
        assert process.stdin
        process.stdin.write(b"Hello")
        process.stdin.flush()
        deadline = time.monotonic() + 20
        while unread(process.stdin) and time.monotonic() < deadline:
            time.sleep(0.05)
        time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        assert process.wait(10) == 130
