"""Pictures a second of the web client at 512x512 in Chromium on software GL: a head that speaks and lives,
beside the same scene, materials, lights and textures drawn without any deformation; in turns, in one run.
"""

from __future__ import annotations

import argparse
import asyncio
import functools
import http.server
import json
import shutil
import subprocess
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
from playwright.async_api import Page, async_playwright

from fapstream.motion import FaceTrack
from fapstream.records import TimedPhone
from fapstream.tts import FrontEnd
from tests.e2e.conftest import CHROMIUM

ROOT = Path(__file__).parents[2]
WEB = ROOT / "clients" / "web"
HEADS = ROOT / "fapstream" / "assets" / "heads"
SENTENCE = "The quick brown fox jumps over the lazy dog, while seven small birds watch from a tree."
RATE, FPS = 16000, 25
BLOCK = 25
"""Pictures drawn at a stretch, before the other side has its turn."""


def spoken_frames() -> list[list[int]]:
    """FAP frames of a sentence with blinks and head motion: rows of 69 values, FAP n at n."""
    frontend = FrontEnd("en")
    phones = [p for u in frontend.feed(SENTENCE) + frontend.end() for p in u.phones]
    ends = [round(ms * RATE / 1000) for ms in accumulate(p.duration_ms for p in phones)]
    track = FaceTrack("en", RATE, FPS, seed=1)
    track.add(TimedPhone(p, a, b) for p, a, b in zip(phones, [0, *ends], ends, strict=False))
    return [[0, *map(int, frame.values)] for frame in track.frames(ends[-1])]


class _Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        pass


@contextmanager
def page_site(head: Path) -> Iterator[str]:
    """The address of a page that can draw `head`, built for this run."""
    with tempfile.TemporaryDirectory() as folder:
        if not (WEB / "node_modules").is_dir():
            subprocess.run(["npm", "ci", "--no-audit", "--no-fund", "--loglevel=error"], cwd=WEB, check=True)
        subprocess.run(["node", "bench/build.mjs", folder], cwd=WEB, check=True)
        shutil.copy(head, Path(folder) / "head.glb")
        handler = functools.partial(_Quiet, directory=folder)
        site = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
        threading.Thread(target=site.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{site.server_port}/index.html"
        site.shutdown()


async def measure(page: Page, frames: list[list[int]], rounds: int) -> dict[str, Any]:
    """Pictures a second of both sides, their ratio, and what one picture takes.

    Of each side the block that a quarter is faster than counts: other work on the machine only slows.
    """
    await page.evaluate("() => open(document.querySelector('canvas'), 'head.glb', null)")
    await page.evaluate("(frames) => { run(frames, true); run(frames, false); }", frames[:BLOCK])
    took: dict[bool, list[float]] = {True: [], False: []}
    for k in range(rounds):
        start = k * BLOCK % max(1, len(frames) - BLOCK)
        for deforming in (True, False) if k % 2 else (False, True):
            block = frames[start : start + BLOCK]
            took[deforming].append(await page.evaluate("([f, d]) => run(f, d)", [block, deforming]))
    moving, still = (1000 * BLOCK / float(np.percentile(took[side], 25)) for side in (True, False))
    cost = await page.evaluate("() => price()")
    return {
        "fps_deforming": round(moving, 1),
        "fps_static": round(still, 1),
        "ratio": round(moving / still, 3),
        "draw_calls": cost["calls"],
        "triangles": cost["triangles"],
        "texture_bytes": cost["textureBytes"],
    }


async def render(head: Path, rounds: int) -> dict[str, Any]:
    """The figures of one head file."""
    with page_site(head) as address:
        async with async_playwright() as playwright:
            browser = await playwright.chromium.launch(executable_path="/usr/bin/chromium", args=CHROMIUM)
            page = await browser.new_page(viewport={"width": 512, "height": 512})
            await page.goto(address)
            await page.wait_for_function("() => 'run' in window")
            figures = await measure(page, spoken_frames(), rounds)
            await browser.close()
    return figures


def main() -> None:
    """Print the table, or one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--rounds", type=int, default=16)
    parser.add_argument("--head", type=Path, default=HEADS / "generic.glb")
    args = parser.parse_args()
    figures = asyncio.run(render(args.head, args.rounds))
    if args.json:
        print(json.dumps(figures))
        return
    for name, value in figures.items():
        print(f"{name.replace('_', ' '):<16}{value:>14,}")


if __name__ == "__main__":
    main()
