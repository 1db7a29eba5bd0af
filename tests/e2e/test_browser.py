"""A person's way: a page, a text, a voice and a face; measured from outside."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.async_api import Browser, Page

from tests.e2e.link import Link
from tests.e2e.mouth import heard_closures, offsets_ms, seen, watch
from tests.e2e.sound import Recorder

PAGE = """<!doctype html><meta charset="utf-8"><title>elsewhere</title>
<body style="margin:0"><script type="module" src="http://{server}/fap-head.js"></script>
<fap-head id="head" capture src="ws://{socket}/ws" style="display:block;width:320px;height:320px"></fap-head>
"""
MOUTH = (0.36, 0.56, 0.26, 0.16)
TEXTS = {
    "en": "Pop up a papa, pop up a papa. Up a pop, papa, up a pop. Papa up, papa up, a pop, a papa.",
    "el": "Παπάπα, πάπα παπά. Πάπα παπά πάπα. Παπά πάπα, παπάπα πάπα παπά.",
}
SAY = """
async ([text, lang]) => {
  const head = document.querySelector("#head");
  const said = { stats: [] };
  head.addEventListener("stats", (e) => said.stats.push(e.detail));
  const turn = head.speak(text, { lang });
  said.end = await turn.finished;
  return said;
}
"""


async def embed(page: Page, elsewhere: tuple[Path, str], server: str, socket: str) -> list[str]:
    """Open a page of another origin with the head in it; returns the list that collects its complaints."""
    folder, origin = elsewhere
    (folder / "page.html").write_text(PAGE.format(server=server, socket=socket), encoding="utf-8")
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda m: complaints.append(m.text) if m.type == "error" else None)
    await page.goto(f"{origin}/page.html")
    await page.wait_for_function("document.querySelector('#head').server !== null")
    await asyncio.sleep(1.0)
    return complaints


@pytest.mark.parametrize("lang", ["en", "el"])
@pytest.mark.parametrize("late_ms", [0, 400])
async def test_lips_are_on_the_voice(
    browser: Browser, card: dict[str, str], elsewhere: tuple[Path, str], address: str, lang: str, late_ms: int
) -> None:
    """At p95 at most one frame (40 ms) between voice and lips, also with a chunk 400 ms late."""
    page = await browser.new_page(viewport={"width": 320, "height": 320})
    async with Link(address) as link:
        complaints = await embed(page, elsewhere, address, link.address)
        recorder = Recorder(card)
        await asyncio.sleep(0.5)
        await watch(page, "#head", MOUTH)
        if late_ms:
            link.stall(after_bytes=24_000, seconds=late_ms / 1000)
        said: dict[str, Any] = await page.evaluate(SAY, [TEXTS[lang], lang])
        await asyncio.sleep(0.5)
        sight, recording = await seen(page), recorder.stop()
        assert link.stalls == bool(late_ms)
    voice, lips = (
        heard_closures(recording),
        __import__("tests.e2e.mouth", fromlist=["closures"]).closures(sight.times, sight.opening),
    )
    offsets = offsets_ms(lips, voice)
    np.savez(
        f"/tmp/sync_{lang}_{late_ms}.npz",
        t=sight.times,
        o=sight.opening,
        pcm=recording.pcm,
        start=recording.start,
    )
    print(
        lang,
        late_ms,
        "frames/s",
        len(sight.times) / np.ptp(sight.times),
        "closures",
        len(voice),
        len(lips),
        "median",
        np.median(offsets),
        "p95",
        np.percentile(np.abs(offsets), 95),
        np.round(offsets),
    )
    print(said["stats"][-3:], said["end"], complaints)
