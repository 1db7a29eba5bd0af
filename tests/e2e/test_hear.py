"""A microphone in a real browser moves the head: the sound comes back later, the face in step with it."""

from __future__ import annotations

import asyncio
import os
import wave
from pathlib import Path

import numpy as np
from playwright.async_api import async_playwright

from fapstream import connect
from fapstream.motion.articulation import COLUMNS
from fapstream.records import Packet
from tests.benchmarks.speech import spoken
from tests.e2e.conftest import AUTOPLAY, CHROMIUM
from tests.e2e.pages import until, visit
from tests.e2e.sound import RATE, Recorder

TEXT = "Bring the blue box back by five, and tell me more about it."
MOST_LATE_S = 0.3
FAKE = ["--use-fake-device-for-media-stream", "--use-fake-ui-for-media-stream"]

HEAR = """
async (seconds) => {
  const head = document.querySelector("#head");
  const seen = { begin: null, skews: [] };
  head.addEventListener("begin", (event) => (seen.begin = event.detail));
  head.addEventListener("stats", ({ detail }) => detail.skewMs !== null && seen.skews.push(detail.skewMs));
  const { turn } = await head.hear();
  setTimeout(() => turn.end(), seconds * 1000);
  seen.end = (await turn).reason;
  return seen;
}
"""


async def microphone(folder: Path) -> tuple[Path, float]:
    """A file that a fake microphone plays: a voice, with silence around; and how long it is, s."""
    rate, packets = await spoken(TEXT)
    silence = np.zeros(rate // 2, np.int16)
    pcm = np.concatenate([silence, *(p.pcm for p in packets), silence])
    path = folder / "microphone.wav"
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(rate)
        file.writeframes(pcm.tobytes())
    return path, len(pcm) / rate


async def test_a_microphone_is_said_by_the_head(
    card: dict[str, str], elsewhere: tuple[Path, str], address: str, tmp_path: Path
) -> None:
    path, seconds = await microphone(tmp_path)
    async with async_playwright() as playwright:
        browser = await playwright.chromium.launch(
            executable_path="/usr/bin/chromium",
            args=[*CHROMIUM, AUTOPLAY, *FAKE, f"--use-file-for-fake-audio-capture={path}%noloop"],
            env={**os.environ, **card}, ignore_default_args=["--mute-audio"],
        )  # fmt: skip
        page = await browser.new_page(viewport={"width": 320, "height": 320})
        await visit(page, elsewhere, address, address)
        await page.wait_for_function("document.querySelector('#head').server !== null")
        recorder = Recorder(card)
        seen = await page.evaluate(HEAR, seconds + 0.5)
        await asyncio.sleep(0.5)
        loud = np.abs(recorder.stop().pcm.astype(int)) > 500
        await browser.close()
    assert seen["end"] == "end"
    assert seen["begin"]["voice"] == ""
    assert loud.sum() > 0.3 * RATE, "the voice came back"
    assert np.abs(np.median(seen["skews"])) < 60


async def test_the_page_has_a_microphone(card: dict[str, str], address: str, tmp_path: Path) -> None:
    """Its button, under the policy with which it is served; once more, and it falls silent."""
    path, _ = await microphone(tmp_path)
    async with async_playwright() as playwright:
        browser = await playwright.chromium.launch(
            executable_path="/usr/bin/chromium",
            args=[*CHROMIUM, AUTOPLAY, *FAKE, f"--use-file-for-fake-audio-capture={path}"],
            env={**os.environ, **card}, ignore_default_args=["--mute-audio"],
        )  # fmt: skip
        page = await browser.new_page(viewport={"width": 1000, "height": 700})
        await page.goto(f"http://{address}/")
        await until(page, "document.querySelector('#head').server !== null")
        await page.click("#mic")
        await page.wait_for_selector("#mic[aria-pressed=true]")
        await page.wait_for_selector("#stop:not([disabled])")
        await asyncio.sleep(1.5)
        await page.click("#mic")
        await page.wait_for_selector("#mic[aria-pressed=false]")
        box = await page.locator("#mic").bounding_box()
        panel = await page.locator(".panel").bounding_box()
        await browser.close()
    assert box is not None
    assert panel is not None
    assert box["x"] + box["width"] <= panel["x"] + panel["width"], "the button lies on the panel"


async def test_the_face_is_in_step_with_the_sound_and_not_far_behind(address: str) -> None:
    """Sound is sent as it would be recorded; packets bring it back within 300 ms and their own length, with
    lips that do what ours do for the same words."""
    rate, packets = await spoken(TEXT)
    pcm = np.concatenate([p.pcm for p in packets])
    wanted = np.array([f.values for p in packets for f in p.frames])[:, COLUMNS]
    sent, came, faces = 0, [], []
    async with connect(f"ws://{address}/ws") as head:
        turn = await head.hear(rate)

        async def speak() -> None:
            nonlocal sent
            started = asyncio.get_running_loop().time()
            while sent < len(pcm):
                now = asyncio.get_running_loop().time()
                upto = min(len(pcm), int((now - started) * rate))
                await turn.feed(pcm[sent:upto])
                sent = upto
                await asyncio.sleep(0.02)
            await turn.end()

        speaking = asyncio.create_task(speak())
        async for event in turn:
            if isinstance(event, Packet):
                came.append((event.start + len(event.pcm), sent))
                faces += [f.values for f in event.frames]
        await speaking
    late = [(now - end) / rate for end, now in came if now < len(pcm)]
    assert len(late) > 20
    assert np.percentile(late, 90) <= MOST_LATE_S + 0.06
    made = np.array(faces)[:, COLUMNS]
    n = min(len(made), len(wanted))
    lips = [-(rows[:n, 1] + rows[:n, 2]) for rows in (made, wanted)]
    assert np.corrcoef(*lips)[0, 1] > 0.25, "another voice than the one it was learned from"
