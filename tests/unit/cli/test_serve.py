"""`fapstream serve` as its own process: it says where it is, answers, and goes when asked to."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from collections.abc import AsyncIterator

import pytest

from fapstream.cli import main
from fapstream.cli.serve import _shown
from fapstream.client import connect
from fapstream.records import Packet


@pytest.fixture
async def served() -> AsyncIterator[tuple[asyncio.subprocess.Process, str]]:
    """(process, address) of a server on a free port."""
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-m", "fapstream", "serve", "--port", "0",
        stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.PIPE,
    )  # fmt: skip
    assert process.stdout is not None
    line = (await asyncio.wait_for(process.stdout.readline(), 30)).decode()
    assert line.startswith("fapstream speaks at http://127.0.0.1:"), line
    yield process, line.split()[-1].removeprefix("http://").rstrip("/")
    if process.returncode is None:
        process.kill()
    await process.wait()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
async def test_it_speaks_and_goes_when_asked(
    served: tuple[asyncio.subprocess.Process, str], number: signal.Signals
) -> None:
    process, address = served
    async with connect(f"ws://{address}/ws") as talker:
        assert "generic" in talker.ready.heads
        turn = await talker.say("Hello.")
        packets = [event async for event in turn if isinstance(event, Packet)]
        assert sum(len(p.pcm) for p in packets) > 0.2 * 16000
    os.kill(process.pid, number)
    assert await asyncio.wait_for(process.wait(), 10) == 0
    assert process.stderr is not None
    assert (await process.stderr.read()).decode().strip() == "closing"


async def test_a_port_that_is_taken(
    served: tuple[asyncio.subprocess.Process, str], capsys: pytest.CaptureFixture[str]
) -> None:
    port = served[1].rpartition(":")[2]
    assert await asyncio.to_thread(_main_in_thread, ["serve", "--port", port]) == 1
    assert "address already in use" in capsys.readouterr().err


def _main_in_thread(argv: list[str]) -> int:
    """Signals can only be handled in the main thread; here nobody sends any."""
    real = asyncio.SelectorEventLoop.add_signal_handler
    asyncio.SelectorEventLoop.add_signal_handler = lambda *_: None  # type: ignore[method-assign]
    try:
        return main(argv)
    finally:
        asyncio.SelectorEventLoop.add_signal_handler = real  # type: ignore[method-assign]


@pytest.mark.parametrize(
    ("argv", "message"),
    [
        (["--voice", "nobody"], "no voice called 'nobody'"),
        (["--head", "/nowhere/head.glb"], "/nowhere/head.glb: No such file"),
    ],
)
def test_what_cannot_be_done_exits_1(
    argv: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["serve", "--port", "0", *argv]) == 1
    error = capsys.readouterr().err
    assert error.startswith("fapstream: ")
    assert message in error


@pytest.mark.parametrize("argv", [["--port", "x"], ["--port=99999"], ["--lang", "xx"], ["x"]])
def test_a_wrong_call_exits_2(argv: list[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        main(["serve", *argv])
    assert caught.value.code == 2


async def test_an_address_that_is_not_ours(capsys: pytest.CaptureFixture[str]) -> None:
    argv = ["serve", "--port", "0", "--host", "192.0.2.1", "--open"]
    assert await asyncio.to_thread(_main_in_thread, argv) == 1
    assert "cannot listen at 192.0.2.1, port 0: " in capsys.readouterr().err


@pytest.mark.parametrize(
    ("host", "shown"),
    [("0.0.0.0", "localhost"), ("::", "localhost"), ("::1", "[::1]"), ("10.1.2.3", "10.1.2.3")],
)
def test_the_address_shown_can_be_opened(host: str, shown: str) -> None:
    assert _shown(host) == shown
