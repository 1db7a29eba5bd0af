"""Where the FDP feature points are: fine skin vertices by name, from the base mesh's own vertex numbers."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from head_parts.bust import Bust, nearest

LIP_POINTS = {
    # name: (contour, place, upper)
    "2.2": ("inner", 0.0, True), "2.3": ("inner", 0.0, False),
    "2.4": ("inner", 1.0, True), "2.5": ("inner", -1.0, True),
    "2.6": ("inner", 0.5, True), "2.7": ("inner", -0.5, True),
    "2.8": ("inner", 0.5, False), "2.9": ("inner", -0.5, False),
    "8.1": ("outer", 0.0, True), "8.2": ("outer", 0.0, False),
    "8.3": ("outer", 1.0, True), "8.4": ("outer", -1.0, True),
    "8.5": ("outer", 0.5, True), "8.6": ("outer", -0.5, True),
    "8.7": ("outer", 0.5, False), "8.8": ("outer", -0.5, False),
    "8.10": ("outer", 0.2, True), "8.9": ("outer", -0.2, True),
}  # fmt: skip


def on_skin(bust: Bust) -> dict[str, int]:
    """Fine vertex numbers of the feature points that lie on the skin."""
    table = json.loads(Path(__file__).with_name("points.json").read_text())
    found = {name: bust.at(vertex) for name, vertex in table["middle"].items()}
    for left, right, vertex in table["left_right"]:
        found[left] = bust.at(vertex)
        mirrored = bust.skin.points[found[left]] * (-1, 1, 1)
        found[right] = int(nearest(bust.skin.points, mirrored)[0])
    for name, (contour, place, upper) in LIP_POINTS.items():
        found[name] = getattr(bust.skin, contour).point(place, upper)
    return found | _lids(bust)


def _lids(bust: Bust) -> dict[str, int]:
    found = {}
    points = bust.skin.points
    for side, eye in bust.eyes.items():
        upper, lower = points[eye.upper], points[eye.lower]
        left = side == "l"
        found["3.1" if left else "3.2"] = int(eye.upper[np.argmin(np.abs(upper[:, 0] - eye.centre[0]))])
        found["3.3" if left else "3.4"] = int(eye.lower[np.argmin(np.abs(lower[:, 0] - eye.centre[0]))])
        margin = np.concatenate([eye.upper, eye.lower])
        most, least = margin[np.argmax(points[margin, 0])], margin[np.argmin(points[margin, 0])]
        found["3.7" if left else "3.8"] = int(most)
        found["3.11" if left else "3.12"] = int(least)
    return found
