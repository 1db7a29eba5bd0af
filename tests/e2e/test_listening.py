"""A page that listens to a channel: how far it is behind, and what happens while it may not make a sound."""

from __future__ import annotations

import asyncio
import os
from pathlib import Path
from typing import Any

import numpy as np
from playwright.async_api import Browser, Page, async_playwright

from fapstream.client import connect
from tests.e2e.conftest import CHROMIUM
from tests.e2e.pages import visit
from tests.e2e.servers import serving
from tests.e2e.sound import Recorder

TEXT = "One two three four five six seven eight nine ten. "

WATCH = """
() => {
  const head = document.querySelector("#head");
  window.seen = [];
  window.live = false;
  head.addEventListener("stats", (e) => window.seen.push(e.detail));
  head.addEventListener("live", (e) => (window.live = e.detail.on));
}
"""


async def listener(browser: Browser, elsewhere: tuple[Path, str], address: str) -> Page:
    page = await browser.new_page(viewport={"width": 320, "height": 320})
    await visit(page, elsewhere, address, address, 'channel="news"')
    await page.evaluate(WATCH)
    await page.wait_for_function("document.querySelector('#head').server !== null")
    return page


async def store_ms(page: Page, samples: int) -> list[float]:
    """What the next so many reports, each a quarter of a second or so, say of the store."""
    await page.evaluate("window.seen = []")
    await page.wait_for_function("(n) => window.seen.length >= n", arg=samples)
    seen: list[dict[str, Any]] = await page.evaluate("window.seen")
    print(*(f"{s['storeMs']:.0f}/{s['targetMs']:.0f}/{s['underruns']}" for s in seen))
    return [s["storeMs"] for s in seen]


async def test_a_page_is_little_behind_the_speaker(browser: Browser, elsewhere: tuple[Path, str]) -> None:
    """The store that a listener begins with comes down to what the network needs."""
    async with serving("--channel", "news") as server:
        page = await listener(browser, elsewhere, server.address)
        await asyncio.sleep(2)  # its sound is still being opened
        async with connect(server.url, channel="news") as talker:
            await talker.say(TEXT * 8)
            first = await store_ms(page, 8)
            await asyncio.sleep(10)
            later = await store_ms(page, 8)
        assert 300 < np.median(first) < 700, "what the server sends ahead"
        assert np.median(later) < np.median(first) / 2
        await page.close()


async def test_sound_that_is_turned_on_late_is_of_now(
    card: dict[str, str], elsewhere: tuple[Path, str]
) -> None:
    """Where autoplay is blocked the talk passes; whoever clicks hears what is being said."""
    async with serving("--channel", "news") as server, async_playwright() as playwright:
        browser = await playwright.chromium.launch(
            executable_path="/usr/bin/chromium", args=CHROMIUM, env={**os.environ, **card},
            ignore_default_args=["--mute-audio"],
        )  # fmt: skip
        page = await browser.new_page(viewport={"width": 320, "height": 320})
        await page.add_init_script("addEventListener('load', " + WATCH.strip() + ")")
        await visit(page, elsewhere, server.address, server.address, 'channel="news"')
        button = page.locator("#head .unlock")
        async with connect(server.url, channel="news") as talker:
            for _ in range(3):
                await talker.say(TEXT * 3)
            await button.wait_for(state="visible", timeout=10_000)
            await asyncio.sleep(10)
            recorder = Recorder(card)
            await button.click()
            await page.wait_for_function("window.seen.some((s) => s.storeMs > 0)")
            behind = await store_ms(page, 4)
            await asyncio.sleep(1)
            assert (np.abs(recorder.stop().pcm.astype(int)) > 1000).any()
        assert max(behind) < 1500
        assert not await button.is_visible()
        await browser.close()
