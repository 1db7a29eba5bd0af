"""The outline of a person in a photo: from a coarse mask, made exact by the photo's own colours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_fill_holes, gaussian_filter, label, zoom

Floats = NDArray[np.float64]
Field = NDArray[np.float32]

COARSE = 1.2
"""Cells of the mask on both sides of its edge where the photo decides."""
DISTINCT = 12.0
"""Distance between the colours of two sides (0..255) above which they are told apart."""
SURELY, EDGE = 0.97, 0.01
"""Shares of the surroundings above which colours are taken from, and from which on a pixel is at the edge."""
LEVEL = 0.5

# Marching squares: for the corners that are inside (upper left 1, upper right 2, lower right 4, lower left 8)
# the sides of the cell (0 top, 1 right, 2 bottom, 3 left) that the outline enters and leaves by.
_WAYS: dict[int, tuple[tuple[int, int], ...]] = {
    1: ((0, 3),), 2: ((1, 0),), 3: ((1, 3),), 4: ((2, 1),), 5: ((0, 3), (2, 1)), 6: ((2, 0),),
    7: ((2, 3),), 8: ((3, 2),), 9: ((0, 2),), 10: ((1, 0), (3, 2)), 11: ((1, 2),), 12: ((3, 1),),
    13: ((0, 1),), 14: ((3, 0),),
}  # fmt: skip


def sharpened(mask: Field, picture: Field) -> Field:
    """How much of each pixel of `picture` (n, n, 3), 0..255, is the person: (n, n), 0..1.

    Near the edge of `mask` (m, m), 0..1, m <= n, a pixel is taken for a mixture of the colours that the two
    sides have near by; where those are alike, and elsewhere, the mask decides.
    """
    n = len(picture)
    rough = np.clip(np.nan_to_num(zoom(mask, n / len(mask), order=1, grid_mode=True, mode="nearest")), 0, 1)
    rough = largest(rough)
    for cells in (COARSE, COARSE / 2):
        width = cells * n / len(mask)
        spread = gaussian_filter(rough, width)
        sure = [(side > SURELY).astype(np.float32) for side in (spread, 1 - spread)]
        person, ground = (_means(picture, side, 1.5 * width) for side in sure)
        apart = person - ground
        length = (apart**2).sum(-1)
        mixed = np.clip(((picture - ground) * apart).sum(-1) / np.maximum(length, 1e-6), 0, 1)
        trust = np.clip(np.sqrt(length) / DISTINCT - 1, 0, 1) * ((spread > EDGE) & (spread < 1 - EDGE))
        rough = largest(rough + trust * (mixed - rough))
    return rough


def _means(picture: Field, weight: Field, width: float) -> Field:
    """Colours (n, n, 3) near each pixel, of those with a weight (n, n)."""
    total = gaussian_filter(weight, width) + 1e-6
    layers = [gaussian_filter(picture[..., k] * weight, width) / total for k in range(3)]
    means: Field = np.stack(layers, -1)
    return means


def largest(mask: Field) -> Field:
    """The mask (n, n) without all but its largest piece, and without holes."""
    pieces, count = label(mask > LEVEL)
    if not count:
        return np.zeros_like(mask)
    piece = pieces == 1 + int(np.bincount(pieces.ravel())[1:].argmax())
    full = binary_fill_holes(piece)
    cleaned: Field = np.where(full & ~piece, 1, np.where((pieces > 0) & ~piece, 0, mask)).astype(np.float32)
    return cleaned


def trace(field: Field) -> Floats:
    """The longest closed line (k, 2) around what is above LEVEL in a field (h, w): x and y in pixels.

    The inside is on the right of who walks it. (0, 2) if there is none.
    """
    padded = np.pad(field, 1).astype(float)
    width = padded.shape[1]
    high = padded > LEVEL
    codes = high[:-1, :-1] + 2 * high[:-1, 1:] + 4 * high[1:, 1:] + 8 * high[1:, :-1]
    after: dict[int, int] = {}
    for row, column in np.argwhere((codes > 0) & (codes < 15)).tolist():
        at = row * width + column
        sides = (2 * at, 2 * (at + 1) + 1, 2 * (at + width), 2 * at + 1)
        for enter, leave in _WAYS[int(codes[row, column])]:
            after[sides[enter]] = sides[leave]
    loop = max(_loops(after), key=len, default=[])
    return _crossings(padded, np.array(loop, int)) - 0.5


def _loops(after: dict[int, int]) -> list[list[int]]:
    left, loops = dict(after), []
    while left:
        first, at = left.popitem()
        loop = [first]
        while at != first:
            loop.append(at)
            at = left.pop(at)
        loops.append(loop)
    return loops


def _crossings(padded: Floats, sides: NDArray[np.int64]) -> Floats:
    """Where the field has LEVEL on sides of cells (k,): twice their corner's number, plus 1 if upright."""
    corner, down = sides // 2, sides % 2
    row, column = np.divmod(corner, padded.shape[1])
    a, b = padded[row, column], padded[row + down, column + 1 - down]
    share = (LEVEL - a) / np.where(a == b, 1, b - a)
    return np.column_stack([column + (1 - down) * share, row + down * share]).reshape(-1, 2)


def resampled(line: Floats, step: float) -> Floats:
    """A closed line (k, 2) as points about `step` apart, smoothed over as much."""
    closed = np.vstack([line, line[:1]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    count = max(int(along[-1] / step), 1)
    at = np.arange(count) * along[-1] / count
    even = np.column_stack([np.interp(at, along, closed[:, k]) for k in range(2)])
    smooth: Floats = gaussian_filter(even, (1.0, 0.0), mode="wrap")
    return smooth


def headings(line: Floats) -> Floats:
    """Directions (k,) of a closed line at its points, radians, without jumps of a whole turn."""
    ahead = np.roll(line, -1, axis=0) - np.roll(line, 1, axis=0)
    return np.unwrap(np.arctan2(ahead[:, 1], ahead[:, 0]))
