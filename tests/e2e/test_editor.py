"""The editor page in a real browser: photos in, points dragged, a head made that speaks, everything saved."""

from __future__ import annotations

import asyncio
from pathlib import Path

import numpy as np
import pytest
from playwright.async_api import Browser, Page, expect

from fapstream.adapt import read_points
from fapstream.head.gltf import read_head
from tests.benchmarks.server import server
from tests.e2e.pages import until
from tests.e2e.sound import RATE, Recorder

PHOTOS = Path(__file__).parents[1] / "unit/adapters/photos"
NOSE = "tip of the nose"
SLOW_MS = 30_000


async def opened(browser: Browser, address: str) -> tuple[Page, list[str]]:
    """The page, connected, and what it complains of."""
    page = await browser.new_page(viewport={"width": 1360, "height": 980})
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    await page.goto(f"http://{address}/adapt")
    await expect(page.get_by_text("Connected")).to_be_visible()
    return page, complaints


async def give(page: Page, view: str) -> None:
    """Choose the person's photo."""
    await page.locator(f"#{view} .drop input").set_input_files(str(PHOTOS / f"person601.{view}.jpg"))
    await expect(page.locator(f"#{view} .count")).to_contain_text("points", timeout=SLOW_MS)


async def found_by_hovering(page: Page, view: str, title: str) -> tuple[float, float]:
    """Where on the page a point is: the mouse goes over the photo until the page names it."""
    canvas = page.locator(f"#{view} canvas")
    box = await canvas.bounding_box()
    assert box
    for share in np.linspace(0.25, 0.75, 26):
        for across in np.linspace(0.25, 0.75, 18):
            at = box["x"] + across * box["width"], box["y"] + share * box["height"]
            await page.mouse.move(*at)
            tag = page.locator(f"#{view} .tag")
            if await tag.is_visible() and title in (await tag.inner_text()).lower():
                return at
    raise AssertionError(f"no {title} to be found")


async def error_px(page: Page) -> float:
    """The error of the fit, once it has settled."""
    seen, same = "", 0
    while same < 8:
        now = await page.locator("#numbers").inner_text()
        seen, same = now, same + 1 if now == seen else 0
        await asyncio.sleep(0.15)
    return float((await page.locator("#fit-error").inner_text()).split()[0])


async def saved(page: Page, button: str, path: Path) -> Path:
    async with page.expect_download() as download:
        await page.get_by_role("button", name=button).click()
    await (await download.value).save_as(path)
    return path


async def test_two_photos_are_dragged_into_a_head_that_speaks(
    browser: Browser, card: dict[str, str], tmp_path: Path
) -> None:
    with server() as (address, _):
        page, complaints = await opened(browser, address)
        await give(page, "front")
        await give(page, "profile")
        await expect(page.locator("#numbers")).to_be_visible(timeout=SLOW_MS)
        good = await error_px(page)
        before = read_points((await saved(page, "Save points", tmp_path / "a.json")).read_text())

        x, y = await found_by_hovering(page, "front", NOSE)
        await page.mouse.down()
        await page.mouse.move(x + 60, y + 20, steps=8)
        await page.mouse.up()
        await expect(page.locator("#front .count")).to_contain_text("points")
        assert await error_px(page) > good + 0.05, "a point that is off is told"
        dragged = read_points((await saved(page, "Save points", tmp_path / "b.json")).read_text())
        moved = np.subtract(dragged.front.points["9.3"], before.front.points["9.3"])
        assert moved[0] > 10, "to the right"
        assert 2 < moved[0] / moved[1] < 4.5, "as the mouse went"
        others = set(before.front.points) - {"9.3"}
        assert all(dragged.front.points[name] == before.front.points[name] for name in others)

        await page.keyboard.press("Control+z")
        assert await error_px(page) == pytest.approx(good, abs=0.11)
        undone = read_points((await saved(page, "Save points", tmp_path / "c.json")).read_text())
        assert undone.front.points == before.front.points

        await page.get_by_role("button", name="Make the head").click()
        await page.locator("#stage fap-head").wait_for(timeout=SLOW_MS)
        await until(page, "document.querySelector('#stage fap-head').server !== null")
        await asyncio.sleep(2.0)
        recorder = Recorder(card)
        await asyncio.sleep(0.5)
        await page.locator("#text").fill("Papa pop. Hello, this is me.")
        await page.get_by_role("button", name="Speak").click()
        await asyncio.sleep(4.0)
        recording = recorder.stop()
        assert loud_seconds(recording.pcm, RATE) > 1.0, "it is heard"
        head = read_head((await saved(page, "Save head", tmp_path / "me.glb")).read_bytes())
        assert head.part("skin").material.texture is not None
        await page.screenshot(path=str(tmp_path / "editor.png"))
    assert not complaints


def loud_seconds(samples: np.ndarray, rate: int) -> float:
    """How long the sound is louder than silence."""
    step = rate // 50
    pieces = samples[: len(samples) // step * step].reshape(-1, step).astype(float)
    return float((np.sqrt((pieces**2).mean(1)) > 300).sum() / 50)


async def test_keys_move_points_and_symmetry_moves_the_other_side(browser: Browser, tmp_path: Path) -> None:
    with server() as (address, _):
        page, complaints = await opened(browser, address)
        await give(page, "front")
        before = read_points((await saved(page, "Save points", tmp_path / "a.json")).read_text())
        x, y = await found_by_hovering(page, "front", "left corner of the mouth")
        await page.mouse.click(x, y)
        await page.keyboard.press("s")
        await page.keyboard.press("Shift+ArrowRight")
        await page.keyboard.press("ArrowUp")
        after = read_points((await saved(page, "Save points", tmp_path / "b.json")).read_text())
        left, right = (np.subtract(after.front.points[n], before.front.points[n]) for n in ("8.3", "8.4"))
        assert left == pytest.approx([10, -1], abs=0.3)
        assert right[0] == pytest.approx(-10, abs=2.5), "the other side goes the other way"
        await page.locator("#front canvas").focus()
        await page.keyboard.press("Delete")
        gone = read_points((await saved(page, "Save points", tmp_path / "c.json")).read_text())
        assert "8.3" not in gone.front.points
    assert not complaints


async def test_what_is_no_photo_is_said_beside_it(browser: Browser, tmp_path: Path) -> None:
    wrong = tmp_path / "notes.jpg"
    wrong.write_bytes(b"no picture at all")
    with server() as (address, _):
        page, complaints = await opened(browser, address)
        await page.locator("#front .drop input").set_input_files(str(wrong))
        await expect(page.locator("#front .note")).to_be_visible(timeout=SLOW_MS)
        assert "picture" in (await page.locator("#front .note").inner_text()).lower()
        await give(page, "front")
        await expect(page.locator("#front .note")).to_be_hidden()
    assert not complaints
