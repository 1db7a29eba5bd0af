"""A second client, written from protocol/SPEC.md alone, in another language, gets along with a server."""

from __future__ import annotations

import asyncio
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.e2e.servers import serving

CLIENT = Path(__file__).parent / "foreign" / "client.pl"
SCHEMA = Path(__file__).parents[2] / "protocol" / "schema"
ACTS = (
    "speak",
    "pacing",
    "interrupt",
    "resume",
    "listen",
    "pause",
    "splice",
    "seek",
    "errors",
    "queue",
    "ahead",
    "live",
)


def missing() -> str:
    """Why it cannot run here; empty if it can."""
    if shutil.which("perl") is None:
        return "perl is not installed"
    modules = ("-MProtocol::WebSocket::Frame", "-MData::MessagePack", "-e1")
    if subprocess.run(["perl", *modules], capture_output=True, check=False).returncode:
        return "libprotocol-websocket-perl or libdata-messagepack-perl is not installed"
    return "MBROLA is not installed" if shutil.which("mbrola") is None else ""


@pytest.mark.skipif(bool(missing()), reason=missing())
@pytest.mark.timeout(120)
@pytest.mark.parametrize("workers", [1, 2])
async def test_a_client_that_knows_only_the_specification(workers: int) -> None:
    async with serving("--workers", str(workers)) as server:
        client = await asyncio.create_subprocess_exec(
            "perl", str(CLIENT), server.address, env={**os.environ, "FAPSTREAM_SCHEMA": str(SCHEMA)},
            stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.PIPE,
        )  # fmt: skip
        out, err = await client.communicate()
    assert client.returncode == 0, err.decode()
    assert out.decode().split() == [word for act in ACTS for word in ("ok", "-", act)]
