"""Somebody else's avatar, with nothing of ours in the file, speaks in the browser."""

from __future__ import annotations

import asyncio
import shutil
from pathlib import Path

import numpy as np
import pytest
from playwright.async_api import Browser, Page

from tests.benchmarks.server import server
from tests.e2e.mouth import heard_closures, offsets_ms, seen, seen_closures, watch
from tests.e2e.pages import embed
from tests.e2e.sound import Recorder

AVATAR = Path(__file__).parents[2] / "protocol/vectors/foreign/avatar.glb"
"""ARKit names, node transforms, several primitives; another mesh than our heads'."""
MOUTH = (0.40, 0.54, 0.20, 0.12)
SAY = "(text) => document.querySelector('#head').speak(text, { lang: 'en' }).finished"
TEXT = "Papa pop, papa pop papa. Papa papa pop, papa pop. Papa papa, papa pop papa."
WEAR = "(name) => document.querySelector('#head').setAttribute('head', name)"


@pytest.mark.parametrize("way", ["from its own address", "from our server"])
async def test_an_avatar_speaks(
    browser: Browser, card: dict[str, str], elsewhere: tuple[Path, str], way: str
) -> None:
    """Its lips close where the voice does, whether the browser reads the file or the server converts it."""
    page = await browser.new_page(viewport={"width": 320, "height": 320})
    served = ["--head", str(AVATAR)] if way == "from our server" else []
    with server(*served) as (address, _):
        complaints = await embed(page, elsewhere, address, address)
        if not served:
            shutil.copy(AVATAR, elsewhere[0] / "avatar.glb")
            await page.evaluate(WEAR, "avatar.glb")
            await asyncio.sleep(3.0)
        offsets = await offsets_while_it_speaks(page, card)
    print(f"{way}: {len(offsets)} closures, face minus voice {np.median(offsets):+.0f} ms")
    assert not complaints
    assert len(offsets) >= 8
    assert np.percentile(np.abs(offsets), 90) <= 40


async def offsets_while_it_speaks(page: Page, card: dict[str, str]) -> np.ndarray:
    """For each closure heard, how much later it was seen, ms."""
    recorder = Recorder(card)
    await asyncio.sleep(0.5)
    await watch(page, "#head", MOUTH)
    end = await page.evaluate(SAY, TEXT)
    await asyncio.sleep(0.5)
    sight, recording = await seen(page), recorder.stop()
    assert end["reason"] == "end"
    assert np.ptp(sight.opening) > 100, "the mouth did not move"
    return offsets_ms(seen_closures(sight), heard_closures(recording))
