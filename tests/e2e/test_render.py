"""The picture in a real browser on software GL: what it costs to move the face, and whose face it is."""

from __future__ import annotations

import io
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from PIL import Image as Picture
from playwright.async_api import Browser, Page

from fapstream.head.gltf import read_head
from tests.benchmarks.bench_render import HEADS, render
from tests.conformance.test_head_budget import DRAW_CALLS, TEXTURE_BYTES

WEAR = """
(name) => new Promise((resolve) => {
  const head = document.querySelector("#head");
  const next = (then) => () => requestAnimationFrame(then);
  const drawn = next(next(next(resolve)));
  head.addEventListener("head", drawn, { once: true });
  const face = document.querySelector("#face");
  face.value = name;
  face.dispatchEvent(new Event("change"));
})
"""


async def test_deforming_keeps_four_fifths_of_the_frame_rate() -> None:
    """Same scene, materials, lights and textures, with and without deformation, in turns."""
    figures = await render(HEADS / "generic.glb", rounds=6)
    assert figures["ratio"] >= 0.8, figures
    head = read_head((HEADS / "generic.glb").read_bytes(), "generic.glb")
    assert figures["triangles"] > sum(len(part.triangles) for part in head.parts), "shadows are not counted"
    assert len(head.parts) < figures["draw_calls"] <= DRAW_CALLS
    assert figures["texture_bytes"] <= TEXTURE_BYTES


async def face_colour(page: Page) -> NDArray[np.float64]:
    """RGB in the middle of the picture."""
    shot = Picture.open(io.BytesIO(await page.locator("#head").screenshot())).convert("RGB")
    pixels = np.asarray(shot, float)
    y, x = (n // 2 for n in pixels.shape[:2])
    return np.asarray(pixels[y - 10 : y + 10, x - 10 : x + 10].mean((0, 1)))


async def test_the_page_offers_every_head(browser: Browser, address: str) -> None:
    """Chosen on the page, another head is drawn in place of the first: skins differ."""
    page = await browser.new_page(viewport={"width": 900, "height": 600}, reduced_motion="reduce")
    await page.goto(f"http://{address}/")
    await page.wait_for_selector("#status[data-state=on]")
    offered = await page.evaluate("() => [...document.querySelector('#face').options].map((o) => o.value)")
    assert sorted(offered) == sorted(path.stem for path in HEADS.glob("*.glb"))
    colours = {}
    for name in offered:
        await page.evaluate(WEAR, name)
        colours[name] = await face_colour(page)
    for one, other in combinations(colours, 2):
        assert np.abs(colours[one] - colours[other]).max() > 3, (one, other, colours)
    await page.close()
