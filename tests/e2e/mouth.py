"""The mouth as a camera would see it: pixels of the canvas, read by the test's own script."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from playwright.async_api import Page

from tests.e2e.sound import RATE, Recording

WATCH = """
async ([selector, box]) => {
  const head = document.querySelector(selector);
  const small = new OffscreenCanvas(64, 48);
  const paint = small.getContext("2d", { willReadFrequently: true });
  const seen = (window.seen = []);
  const look = () => {
    const canvas = head.shadowRoot.querySelector("canvas");
    const [x, y, w, h] = box;
    const [W, H] = [canvas.width, canvas.height];
    paint.drawImage(canvas, x * W, y * H, w * W, h * H, 0, 0, 64, 48);
    const { data } = paint.getImageData(0, 0, 64, 48);
    let open = 0;
    for (let i = 0; i < data.length; i += 4) open += data[i] - data[i + 2] < 35 ? 1 : 0;
    seen.push([performance.timeOrigin + performance.now(), open]);
    if (window.seen === seen) requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
}
"""


@dataclass(frozen=True, slots=True)
class Sight:
    """Frames: wall clock in seconds, and how many of 3072 pixels of the mouth's box are teeth or darkness.

    Those have hardly more red than blue; skin, lips and tongue have.
    """

    times: NDArray[np.float64]
    opening: NDArray[np.float64]


async def watch(page: Page, selector: str, box: Sequence[float]) -> None:
    """Begin to look at `box` (x, y, w, h as parts of the canvas) in every frame."""
    await page.evaluate(WATCH, [selector, list(box)])


async def seen(page: Page) -> Sight:
    """Everything seen; ends the looking."""
    rows = np.array(await page.evaluate("() => { const s = window.seen; window.seen = null; return s; }"))
    return Sight(rows[:, 0] / 1000, rows[:, 1])


def closures(times: NDArray[np.float64], opening: NDArray[np.float64], limit: float) -> list[float]:
    """The middles of the times in which `opening` is below `limit` for 30 to 250 ms, interpolated."""
    shut = opening < limit
    out = []
    edges = np.flatnonzero(shut[1:] != shut[:-1])
    for first, last in pairwise(edges):
        if shut[first]:
            continue
        start, end = (_crossing(times, opening, i, limit) for i in (first, last))
        if 0.03 <= end - start <= 0.25:
            out.append((start + end) / 2)
    return out


def _crossing(times: NDArray[np.float64], values: NDArray[np.float64], i: int, limit: float) -> float:
    share = (limit - values[i]) / (values[i + 1] - values[i])
    return float(times[i] + share * (times[i + 1] - times[i]))


def seen_closures(sight: Sight) -> list[float]:
    """Wall clock of the middles of short closures of the lips."""
    low, high = np.percentile(sight.opening, [5, 95])
    return closures(sight.times, sight.opening, low + (high - low) / 3)


def heard_closures(recording: Recording) -> list[float]:
    """The same for the voice: 15 dB below its usual loudness, in windows of 5 ms.

    Gaps in which the sound card got nothing at all are its own, not the voice's, and are left out.
    """
    step = RATE // 200
    windows = recording.pcm[: len(recording.pcm) // step * step].reshape(-1, step)
    level = 10 * np.log10((windows.astype(float) ** 2).mean(axis=1) + 1)
    times = recording.start + (np.arange(len(windows)) + 0.5) * step / RATE
    found = closures(times, np.convolve(level, np.ones(3) / 3, "same"), np.percentile(level, 95) - 15)
    nothing = (windows == 0).all(axis=1)
    centre = [int((t - recording.start) * RATE / step) for t in found]
    return [t for t, i in zip(found, centre, strict=True) if not nothing[max(0, i - 5) : i + 6].any()]


def offsets_ms(lips: Sequence[float], voice: Sequence[float]) -> NDArray[np.float64]:
    """For every closure heard, how much later the nearest one was seen."""
    return np.array([1000 * min((v - heard for v in lips), key=abs) for heard in voice])
