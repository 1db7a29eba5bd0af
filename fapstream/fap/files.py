"""The text file `.fap`: header, then a mask line and a value line for each frame."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fapstream.records import N_FAPS, FapFrame


def format_fap(frames: Sequence[FapFrame], name: str, fps: int) -> str:
    """A `.fap` file in the profile that every known player reads.

    Header `2.1 name fps count` on line 1, frames numbered 0..n-1, 68 mask columns, integers, single
    spaces, final newline. FAPs that are never moved are masked off.
    """
    values = np.array([f.values for f in frames], np.int32).reshape(-1, N_FAPS)
    mask = _used(values)
    mask_line = " ".join("1" if used else "0" for used in mask)
    safe_name = "_".join(name.split()) or "untitled"
    lines = [f"2.1 {safe_name} {fps} {len(frames)}"]
    for number, row in enumerate(values):
        lines.append(mask_line)
        lines.append(" ".join(map(str, [number, *row[mask].tolist()])))
    return "\n".join(lines) + "\n"


def _used(values: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Which FAPs move in any frame; never 1 and 2, whose values are composite."""
    used: NDArray[np.bool_] = (values != 0).any(axis=0)
    used[:2] = False
    return used
