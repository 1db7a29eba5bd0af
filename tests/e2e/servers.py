"""A real server in processes of its own, on a free port of this machine, that a test may treat badly."""

from __future__ import annotations

import asyncio
import signal
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from tests.benchmarks.load import tree

START_S = 40.0


class Server:
    """`address`: host:port."""

    def __init__(self, process: asyncio.subprocess.Process, address: str) -> None:
        self.process = process
        self.address = address

    @property
    def url(self) -> str:
        """Its websocket."""
        return f"ws://{self.address}/ws"

    def programs(self, name: str) -> list[int]:
        """Processes of that name under it."""
        found = []
        for pid in tree(self.process.pid):
            try:
                if Path(f"/proc/{pid}/comm").read_text().strip() == name:
                    found.append(pid)
            except OSError:
                continue
        return found

    def open_files(self) -> int:
        """Of the process itself."""
        return len(list(Path(f"/proc/{self.process.pid}/fd").iterdir()))

    async def stop(self, within_s: float = 20.0) -> int:
        """Ask it to end; the exit status."""
        if self.process.returncode is None:
            self.process.send_signal(signal.SIGTERM)
        return await asyncio.wait_for(self.process.wait(), within_s)


@asynccontextmanager
async def serving(*options: str) -> AsyncIterator[Server]:
    """`fapstream serve` with these options."""
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-m", "fapstream", "serve", "--port", "0", *options,
        stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.PIPE,
    )  # fmt: skip
    assert process.stdout
    try:
        line = (await asyncio.wait_for(process.stdout.readline(), START_S)).decode()
        if "://" not in line:
            assert process.stderr
            raise RuntimeError(f"no server: {line} {(await process.stderr.read()).decode()}")
        yield Server(process, line.split("://")[1].strip().rstrip("/"))
    finally:
        if process.returncode is None:
            process.terminate()
            try:
                await asyncio.wait_for(process.wait(), 20)
            except TimeoutError:
                process.kill()
                await process.wait()
