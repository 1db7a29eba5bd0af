"""The body of the head: skin, mouth lining, lashes, tongue and shirt cut from the base mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from head_parts.fields import Contour, Skin
from head_parts.source import Quads, Source
from head_parts.surface import (
    Array,
    Ints,
    Rings,
    Subdivision,
    catmull_clark,
    edges_of,
    normals,
    triangulate,
)

ARM_BONES = ("upperarm01", "upperarm02", "lowerarm01", "lowerarm02", "wrist")
ARM_DROP_RAD = 0.60
CUT_LOW, CUT_WIDE = 4.55, 2.6
LIP_INNER, LIP_OUTER = (520, 523), (455, 492)
"""Midline vertices (upper, lower) of the two lip contours' edge loops."""
LIP_SEAL = {(468, 494): 0.6, (474, 493): 0.9, (520, 523): 1.0, (537, 540): 0.8, (554, 557): 0.4}
"""Edge loops of the lips, and how far each follows when they are closed."""
LIP_CONTACT, LIP_OVERLAP = LIP_INNER, 0.002
NOSE_TIP, PALATE = 294, 639
LIP_DENSITY = 2
MARGIN_RING = 2
"""Edge loops from the rim of the socket's chart to the visible margin of the lids."""
LID_CHART = {"l": (0.14, 0.44), "r": (-0.44, -0.14)}


@dataclass(frozen=True)
class Eye:
    """A ball fitted to the helper eye, and the fine vertices of the margin of its lids."""

    centre: Array
    radius: float
    upper: Ints
    lower: Ints


@dataclass(frozen=True)
class Bust:
    """Everything cut from the base mesh; decimetres. `control` are base vertex numbers."""

    shape: Array
    control: Ints
    quads: Ints
    step: Subdivision
    skin: Skin
    eyes: dict[str, Eye]
    charts: Ints
    """Per coarse quad: 0 face and neck, 1 mouth lining, 2 eye sockets, 3 torso."""
    lip_density: int = LIP_DENSITY
    """Into how many parts each stretch of a lip contour between two control points is cut."""

    def fine(self, values: Array) -> Array:
        """Per-base-vertex values to fine vertices."""
        return self.step.matrix @ values[self.control]

    def at(self, base_vertex: int) -> int:
        """The fine vertex number of a base vertex."""
        return int(np.searchsorted(self.control, base_vertex))


def lower_arms(source: Source, shape: Array) -> Array:
    """Arms turned down beside the body, so that the shoulders look at rest."""
    shape = shape.copy()
    for side, sign in (("L", 1.0), ("R", -1.0)):
        fingers = tuple(f"finger{i}-{j}.{side}" for i in range(1, 6) for j in range(1, 4))
        palm = tuple(f"metacarpal{i}.{side}" for i in range(1, 5))
        weights = source.bone_weights(tuple(f"{bone}.{side}" for bone in ARM_BONES) + fingers + palm)
        cube = source.groups[f"joint-{side.lower()}-shoulder"].vertices
        pivot = shape[np.unique(cube)].mean(0)
        angle = -sign * ARM_DROP_RAD * np.clip(weights, 0, 1)
        x, y = (shape - pivot)[:, 0].copy(), (shape - pivot)[:, 1].copy()
        shape[:, 0] = pivot[0] + np.cos(angle) * x - np.sin(angle) * y
        shape[:, 1] = pivot[1] + np.sin(angle) * x + np.cos(angle) * y
    return shape


def cut(source: Source, shape: Array) -> Bust:
    """The bust of a shaped base mesh."""
    body = source.groups["body"]
    keep = _bust_faces(source, shape, body)
    charts = _charts(source, Quads(body.vertices[keep], body.uvs[keep]))
    control, quads = np.unique(body.vertices[keep], return_inverse=True)
    quads = quads.reshape(-1, 4)
    step = catmull_clark(quads, len(control))
    rings = Rings(quads)
    shape = _sealed(rings, step, shape, control)
    points = step.matrix @ shape[control]
    triangles = triangulate(step.faces)
    contours = [_contour(rings, quads, control, points, pair[0]) for pair in (LIP_INNER, LIP_OUTER)]
    skin = Skin(points, triangles, normals(points, triangles), *contours)
    eyes = {side: _eye(source, shape, quads, charts, points, len(control), side) for side in "lr"}
    return Bust(shape, control, quads, step, skin, eyes, charts)


def reshaped(bust: Bust, shape: Array) -> Array:
    """Another shape of the base mesh as it would be cut, in the terms of this bust: its lips brought
    together.
    """
    return _sealed(Rings(bust.quads), bust.step, shape, bust.control)


def _sealed(rings: Rings, step: Subdivision, shape: Array, control: Ints) -> Array:
    """The shape with its lips brought together until the subdivided ones just touch."""
    loops = {}
    for pair, share in LIP_SEAL.items():
        top, bottom = (int(np.searchsorted(control, vertex)) for vertex in pair)
        first = max(rings.neighbours[top], key=lambda v: shape[control[v], 0])
        loop = np.array(rings.follow(top, first))
        half = int(np.flatnonzero(loop == bottom)[0])
        order = np.arange(-half // 2 + 1, half // 2 + 1)
        loops[pair] = (loop[order], loop[half - order], share)
    shape = shape.copy()
    upper, lower, _ = loops[LIP_CONTACT]
    for _ in range(12):
        fine = step.matrix @ shape[control]
        over, under = fine[upper], fine[lower]
        sink = over[:, 1] - np.interp(over[:, 0], under[:, 0], under[:, 1]) + LIP_OVERLAP
        lift = np.interp(under[:, 0], over[:, 0], over[:, 1]) - under[:, 1] + LIP_OVERLAP
        for above, below, share in loops.values():
            shape[control[above], 1] -= 0.5 * share * sink
            shape[control[below], 1] += 0.5 * share * lift
    return shape


def _bust_faces(source: Source, shape: Array, body: Quads) -> np.ndarray:
    corners = shape[body.vertices]
    inside = (corners[..., 1] > CUT_LOW).all(1) & (np.abs(corners[..., 0]) < CUT_WIDE).all(1)
    hands = source.bone_weights(
        tuple(f"{bone}.{s}" for bone in ("lowerarm01", "lowerarm02", "wrist") for s in "LR")
    )
    return inside & (hands[body.vertices] < 0.05).all(1)


def _charts(source: Source, quads: Quads) -> Ints:
    """Which connected piece of the atlas each quad is on, named by a vertex known to be on it."""
    pairs = np.stack([quads.uvs, np.roll(quads.uvs, -1, 1)], 2).reshape(-1, 2)
    n = len(source.uvs)
    _, label = connected_components(sp.csr_matrix((np.ones(len(pairs)), pairs.T), (n, n)), directed=False)
    of_quad = label[quads.uvs[:, 0]]
    kind = np.where(source.base[quads.vertices, 1].mean(1) > 6.9, 2, 3)
    kind[of_quad == of_quad[(quads.vertices == NOSE_TIP).any(1)][0]] = 0
    kind[of_quad == of_quad[(quads.vertices == PALATE).any(1)][0]] = 1
    return kind


def _with_midpoints(loop: list[int], quads: Ints, count: int) -> Ints:
    """A closed loop of coarse vertices as fine vertices, edge points between them."""
    edges, _, _ = edges_of(quads)
    number = {(int(a), int(b)): i for i, (a, b) in enumerate(edges)}
    fine = []
    for a, b in zip(loop, loop[1:] + loop[:1], strict=True):
        fine += [a, count + number[(min(a, b), max(a, b))]]
    return np.array(fine)


def _contour(rings: Rings, quads: Ints, control: Ints, points: Array, middle: int) -> Contour:
    """The edge loop through a midline vertex; a place is how far to the left, the corner being 1.

    By x, not by arc: what is above one another on two contours has one place, and moves together.
    """
    top = int(np.searchsorted(control, middle))
    first = max(rings.neighbours[top], key=lambda v: points[v, 0])
    vertices = _with_midpoints(rings.follow(top, first), quads, len(control))
    across = points[vertices, 0]
    left, right = int(np.argmax(across)), int(np.argmin(across))
    number = np.arange(len(vertices))
    upper = (number <= left) | (number >= right)
    lateral = across / np.where(across > 0, across[left], -across[right])
    for node, half in ((0.5, upper), (-0.5, upper), (0.5, ~upper), (-0.5, ~upper)):
        lateral[np.argmin(np.abs(lateral - node) + np.where(half, 0, 9))] = node
    return Contour(vertices, lateral, upper)


def _eye(
    source: Source, shape: Array, quads: Ints, charts: Ints, points: Array, count: int, side: str
) -> Eye:
    centre, radius = fit_ball(shape[np.unique(source.groups[f"helper-{side}-eye"].vertices)])
    low, high = LID_CHART[side]
    middle = points[quads].mean(1)[:, 0]
    socket = quads[(charts == 2) & (middle > low - 0.1) & (middle < high + 0.1)]
    loop = _outward(quads, _border(socket), set(np.unique(socket).tolist()), MARGIN_RING)
    margin = _with_midpoints(loop, quads, count)
    line = points[margin]
    left, right = np.argmax(line[:, 0]), np.argmin(line[:, 0])
    chord = np.interp(line[:, 0], line[[right, left], 0], line[[right, left], 1])
    upper = line[:, 1] > chord
    upper[[left, right]] = False
    ends = margin[[left, right]]
    lower = margin[~upper & ~np.isin(margin, ends)]
    return Eye(centre, radius, margin[upper], np.concatenate([lower, ends]))


def fit_ball(points: Array) -> tuple[Array, float]:
    """Centre (3,) and radius of an eyeball, which is a little smaller than the helper mesh (n, 3) round
    it.
    """
    solved, *_ = np.linalg.lstsq(np.c_[2 * points, np.ones(len(points))], (points**2).sum(1), rcond=None)
    centre = solved[:3]
    return centre, 0.985 * float(np.sqrt(solved[3] + centre @ centre))


def _outward(quads: Ints, loop: list[int], inside: set[int], count: int) -> list[int]:
    """The edge loop `count` rings outside a loop, in the same order."""
    rings = Rings(quads)
    for _ in range(count):
        inside = inside | set(loop)
        loop = [next(iter(rings.neighbours[vertex] - inside)) for vertex in loop]
    return loop


def _border(quads: Ints) -> list[int]:
    edges, _, counts = edges_of(quads)
    following: dict[int, list[int]] = {}
    for a, b in edges[counts == 1].tolist():
        following.setdefault(a, []).append(b)
        following.setdefault(b, []).append(a)
    first = min(following)
    loop = [first, following[first][0]]
    while True:
        a, b = following[loop[-1]]
        ahead = a if b == loop[-2] else b
        if ahead == first:
            return loop
        loop.append(ahead)


def nearest(points: Array, wanted: Array) -> Ints:
    found: Ints = cKDTree(points).query(np.atleast_2d(wanted))[1]
    return found
