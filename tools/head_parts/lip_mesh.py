"""The triangles of the skin and of the mouth's lining, with lips as dense as wanted.

The lips are a tube of edge loops about the mouth. Each loop is a closed smooth curve (a periodic cubic)
through its own vertices, the control points, and `lip_density` says into how many parts each stretch between
two of them is cut (Reveret, Bailly, Badin 2000: 30 points, 144 quads, adjustable density). New vertices
are linear in the control points, so every motion of these carries over to those by the same weights.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import scipy.sparse as sp
from scipy.interpolate import CubicSpline

from fapstream.head.mesh import Material
from head_parts import paint
from head_parts.assemble import Piece, seamed
from head_parts.bust import Bust
from head_parts.surface import Array, Ints, Rings, mixed_triangles, normals

LAST_LOOP = 537
"""Vertex of the base mesh on the loop, behind where the lips meet, at which the skin ends."""


def skin_piece(name: str, bust: Bust, keep: np.ndarray, fine: np.ndarray, material: Material) -> Piece:
    """The coarse quads to `keep` as a part, subdivided where `fine`, both bool (quads,); lips denser."""
    loops, density = lip_loops(bust), bust.lip_density
    lips = np.isin(bust.quads, loops).all(1) & keep & (density > 1)
    triangles = mixed_triangles(bust.quads, len(bust.control), keep & ~lips, fine)
    skin, count = bust.skin, len(bust.skin.points)
    blend = sp.identity(count, format="csr")
    if lips.any():
        curves = [_between(skin.points[loop], loop, density, count) for loop in loops[1:-1]]
        blend = sp.vstack([blend, *curves])
        strips = _strips(loops, density, count)
        agree = (normals(blend @ skin.points, strips)[:count] * skin.normals)[loops].sum() > 0
        triangles = np.concatenate([triangles, strips if agree else strips[:, ::-1]])
    blend = blend.tocsr()
    *arrays, used = seamed(blend @ skin.points, blend @ skin.normals, blend @ paint.wrap(bust), triangles)
    points, directions, uvs, triangles = arrays
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    rows = blend[used]
    nearest = np.asarray(rows.argmax(1)).ravel()
    return Piece(name, points, directions, uvs, triangles, material, nearest, rows)


def lip_loops(bust: Bust) -> Ints:
    """Fine vertices (loops, around), from the outer contour inwards to where the skin ends."""
    rings = Rings(bust.step.faces)
    loop, last = bust.skin.outer.vertices, bust.at(LAST_LOOP)
    found, seen = [loop], set(loop.tolist())
    ahead = min(rings.neighbours[int(loop[0])] - seen, key=lambda v: bust.skin.points[v, 1])
    while last not in found[-1]:
        row = [ahead]
        for vertex in found[-1][1:].tolist():
            row.append(next(iter((rings.neighbours[vertex] & rings.neighbours[row[-1]]) - seen)))
        seen |= set(row)
        found.append(np.array(row))
        ahead = next(iter(rings.neighbours[ahead] - seen))
    return np.array(found)


def _between(line: Array, loop: Ints, density: int, count: int) -> sp.csr_matrix:
    """Weights (around * (density - 1), count) of points between a loop's own, on the curve through them."""
    n = len(loop)
    steps = np.linalg.norm(np.roll(line, -1, 0) - line, axis=1)
    at = np.r_[0, np.cumsum(steps)]
    curve = CubicSpline(at, np.eye(n)[np.r_[:n, 0]], bc_type="periodic")
    share = np.arange(1, density) / density
    weights = sp.csr_matrix(curve((at[:-1, None] + steps[:, None] * share).ravel()))
    spread = sp.csr_matrix((np.ones(n), (np.arange(n), loop)), (n, count))
    return weights @ spread


def _strips(loops: Ints, density: int, count: int) -> Ints:
    """Triangles between neighbouring loops; the first and the last loop keep their own vertices."""
    rows, around = loops.shape
    outlines = []
    for k, loop in enumerate(loops):
        inner = 0 < k < rows - 1
        new = count + ((k - 1) * around + np.arange(around)[:, None]) * (density - 1) + np.arange(density - 1)
        parts = np.c_[loop, new] if inner else loop[:, None]
        outlines.append([np.r_[parts[j], loop[(j + 1) % around]] for j in range(around)])
    triangles = []
    for above, below in pairwise(outlines):
        for top, bottom in zip(above, below, strict=True):
            triangles += _zipped(top.tolist(), bottom.tolist())
    return np.array(triangles)


def _zipped(top: list[int], bottom: list[int]) -> list[list[int]]:
    """Triangles between two rows of vertices that run the same way."""
    i = j = 0
    found = []
    while i < len(top) - 1 or j < len(bottom) - 1:
        further = (i + 1) / max(len(top) - 1, 1) <= (j + 1) / max(len(bottom) - 1, 1)
        if i < len(top) - 1 and (further or j == len(bottom) - 1):
            found.append([top[i], top[i + 1], bottom[j]])
            i += 1
        else:
            found.append([top[i], bottom[j + 1], bottom[j]])
            j += 1
    return found
