"""What the end-to-end tests stand on: a real server, a real browser, a sound card made of software."""

from __future__ import annotations

import functools
import http.server
import os
import threading
from collections.abc import AsyncIterator, Iterator
from pathlib import Path

import pytest
import pytest_asyncio
from playwright.async_api import Browser, async_playwright

from tests.benchmarks.server import server
from tests.e2e.sound import sound_card

CHROMIUM = [
    "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--use-gl=angle", "--use-angle=gl-egl",
    "--ignore-gpu-blocklist",
]  # fmt: skip
AUTOPLAY = "--autoplay-policy=no-user-gesture-required"


@pytest.fixture(scope="session")
def card(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, str]]:
    """The environment of programs that play to the recorded sound card."""
    with sound_card(tmp_path_factory.mktemp("sound")) as env:
        yield env


@pytest.fixture(scope="session")
def address() -> Iterator[str]:
    """A running server."""
    with server() as (found, _):
        yield found


class _Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture
def elsewhere(tmp_path: Path) -> Iterator[tuple[Path, str]]:
    """A folder, and the address of another web server that serves it: a page that embeds the head."""
    handler = functools.partial(_Quiet, directory=str(tmp_path))
    site = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=site.serve_forever, daemon=True).start()
    yield tmp_path, f"http://127.0.0.1:{site.server_port}"
    site.shutdown()


@pytest_asyncio.fixture
async def browser(card: dict[str, str]) -> AsyncIterator[Browser]:
    """Chromium that may play sound unasked and plays it to the card."""
    async with async_playwright() as playwright:
        found = await playwright.chromium.launch(
            executable_path="/usr/bin/chromium",
            args=[*CHROMIUM, AUTOPLAY],
            env={**os.environ, **card},
            ignore_default_args=["--mute-audio"],
        )
        yield found
        await found.close()
