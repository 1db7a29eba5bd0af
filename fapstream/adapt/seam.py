"""The corner of the mouth in a profile: where the dark line between the lips ends."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from fapstream.adapt.crop import Crop
from fapstream.adapt.silhouette import Laid, chain

Floats = NDArray[np.float64]

SIDE = 96
"""Pixels of the square in which the line is followed."""
SHOWN, AHEAD = 0.4, 0.1
"""Its side, and how far its middle lies behind the outline, heights of the face."""
FINE, WIDE = 0.7, 4.0
"""sd of what is compared: a line is darker than what surrounds it, pixels."""
DARKEST = 8.0
"""Brightness (0..255) under which it is all the same dark."""
LUMA = np.array([0.299, 0.587, 0.114], np.float32)
STEEPEST, BEND = 2, 0.015
"""Pixels that the line rises or falls in one, and what each costs."""
ENDS = 0.3
"""Of its mean darkness: where it is less, the line has ended."""
FIRST, LAST = 8, 90
"""Pixels after which a line may end: the mouth is neither a point nor the face."""
LEAST = 0.02
"""Mean darkness (of the logarithm of brightness) of a line that can be seen."""
CORNER = (-0.0055, 0.0075)
"""From there to 8.3, heights of the face, forward and down: the corner proper lies just beyond."""
CONFIDENCE = 0.3


def mouth_corner(picture: NDArray[np.uint8], laid: Laid) -> tuple[float, float, float] | None:
    """x and y of 8.3 or 8.4, pixels, and its confidence; None where no line between the lips is seen."""
    side = -1.0 if laid.facing == "left" else 1.0
    x, y = laid.points[chain().names.index("stomion")].tolist()
    crop = Crop((x - side * AHEAD * laid.height, y), SHOWN * laid.height, laid.tilt * side)
    shown = crop.cut(picture, SIDE)[:, :: int(side)]
    end = _end(_lines(shown), np.array([SIDE * (0.5 + AHEAD / SHOWN), SIDE / 2]))
    if end is None:
        return None
    at = end / SIDE + np.array(CORNER) / SHOWN
    placed = crop.place(np.array([at[0] if side > 0 else 1 - at[0], at[1]]))
    return float(placed[0]), float(placed[1]), CONFIDENCE


def _lines(shown: NDArray[np.float32]) -> Floats:
    """(SIDE, SIDE): how much darker each pixel is than what surrounds it, of the logarithm of brightness."""
    bright = np.log(np.maximum(shown @ LUMA, DARKEST)).astype(float)
    lines: Floats = gaussian_filter(bright, WIDE) - gaussian_filter(bright, FINE)
    return lines


def _end(lines: Floats, start: Floats) -> Floats | None:
    """Where the darkest line from `start` (2,) to the left ends, (x, y).

    The best line to each column is found first; taken is the one that is dark all along, the longest such.
    """
    rows, first = np.arange(SIDE), int(start[0])
    best = lines[:, first] - 0.05 * ((rows - start[1]) / 3) ** 2
    ends, darkness = [], []
    for column in range(first - 1, max(first - LAST, 0), -1):
        ends.append((column + 1, int(best.argmax())))
        darkness.append(float(best.max()))
        best = lines[:, column] + _widened(best)
    usual = float(np.median(np.diff(darkness[: 2 * FIRST])))
    if not usual > LEAST:
        return None
    gain = np.array(darkness) - ENDS * usual * np.arange(len(darkness))
    x, y = ends[FIRST + int(gain[FIRST:].argmax())]
    return np.array([x + 0.5, y + 0.5])


def _widened(best: Floats) -> Floats:
    """The best (SIDE,) of lines that come from some rows above or below."""
    tries = [best]
    for step in range(1, STEEPEST + 1):
        apart = np.full(step, -np.inf)
        above, below = np.concatenate([apart, best[:-step]]), np.concatenate([best[step:], apart])
        tries += [above - BEND * step, below - BEND * step]
    widened: Floats = np.max(tries, axis=0)
    return widened
