"""The command that draws everything the heads can do."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
from PIL import Image

TOOL = Path(__file__).parents[2] / "tools/gallery.py"
SHEETS = {
    "generic-three-sides.png": 6,
    "generic-speaking.png": 12,
    "generic-visemes.png": 14,
    "generic-expressions.png": 12,
    "generic-every-fap-at-its-limits.png": 110,
    "generic-feature-points.png": 9,
}
"""File, and how many pictures are on it at least."""


def test_every_sheet_is_drawn_and_shown(tmp_path: Path) -> None:
    """Six sheets of one head, none of them blank, all on the page; no two faces of a sheet are the same."""
    command = [sys.executable, str(TOOL), "--head", "generic", "--tile", "64", "--out", str(tmp_path)]
    subprocess.run(command, check=True, timeout=110)
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert page.count("<img") == len(SHEETS)
    for name, count in SHEETS.items():
        assert name in page
        pixels = np.asarray(Image.open(tmp_path / name).convert("RGB"))
        assert pixels.std() > 20
        if name != "generic-feature-points.png":
            assert len(faces(pixels)) >= count


def faces(pixels: np.ndarray) -> set[bytes]:
    """The different pictures on a sheet of tiles of 64 or 128 pixels, labels of 22 below."""
    tile = 128 if (pixels.shape[0] % (128 + 22), pixels.shape[1]) == (0, 3 * 128) else 64
    rows, columns = pixels.shape[0] // (tile + 22), pixels.shape[1] // tile
    tiles = (
        pixels[r * (tile + 22) :][:tile, c * tile : (c + 1) * tile]
        for r in range(rows)
        for c in range(columns)
    )
    return {t.tobytes() for t in tiles if t.min() < 250}
