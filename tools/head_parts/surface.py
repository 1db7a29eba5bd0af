"""Geometry of quad and triangle meshes: subdivision, rings, smooth fields, rasterising."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import splu

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Subdivision:
    """One Catmull-Clark step. `matrix` (fine, coarse); fine vertices are vertex, edge, face points.

    `faces` (m, 4) fine quads, four to a coarse one: row `c * n + f` is corner c of coarse face f.
    """

    matrix: sp.csr_matrix
    faces: Ints


def edges_of(faces: Ints) -> tuple[Ints, Ints, Ints]:
    """Unique edges (e, 2), the edge number of each face side (n, 4), and faces per edge (e,)."""
    sides = np.sort(np.stack([faces, np.roll(faces, -1, 1)], 2).reshape(-1, 2), 1)
    edges, inverse, counts = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    return edges, inverse.reshape(faces.shape), counts


def catmull_clark(faces: Ints, count: int) -> Subdivision:
    """Catmull and Clark 1978, with cubic B-spline borders. `faces` (n, 4) of `count` vertices."""
    edges, sides, shared = edges_of(faces)
    n, e = len(faces), len(edges)
    owner = np.repeat(np.arange(n), 4)
    incidence = sp.csr_matrix((np.ones(n * 4), (owner, faces.ravel())), (n, count))
    face_points = incidence / 4
    edge_face = sp.csr_matrix((np.ones(n * 4), (sides.ravel(), owner)), (e, n))
    ends = sp.csr_matrix((np.ones(e * 2), (np.repeat(np.arange(e), 2), edges.ravel())), (e, count))
    inner = shared == 2
    edge_points = _diag(np.where(inner, 0.25, 0.5)) @ ends + _diag(inner * 0.25) @ edge_face @ face_points
    border = np.zeros(count, bool)
    border[edges[~inner].ravel()] = True
    valence = np.maximum(np.asarray(incidence.sum(0)).ravel(), 1)
    inside = (
        _diag(1 / valence**2) @ incidence.T @ face_points
        + _diag(1 / valence**2) @ ends.T @ ends
        + _diag((valence - 3) / valence)
    )
    rim = ends[np.flatnonzero(~inner)]
    on_rim = np.maximum(np.asarray(rim.sum(0)).ravel(), 1)
    outline = _diag(0.25 / on_rim) @ rim.T @ rim + sp.identity(count) * 0.5
    vertex_points = _diag(~border * 1.0) @ inside + _diag(border * 1.0) @ outline
    matrix = sp.vstack([vertex_points, edge_points, face_points]).tocsr()
    middle = count + e + np.arange(n)
    quads = [
        np.stack([faces[:, k], count + sides[:, k], middle, count + sides[:, k - 1]], 1) for k in range(4)
    ]
    return Subdivision(matrix, np.concatenate(quads))


def mixed_triangles(faces: Ints, count: int, keep: NDArray[np.bool_], fine: NDArray[np.bool_]) -> Ints:
    """Triangles of the faces to `keep` (n,): subdivided quads where `fine` (n,), plain ones elsewhere.

    Vertices are numbered as by `catmull_clark`. Plain quads that touch a split edge are fanned
    about their face point, so nothing cracks.
    """
    edges, sides, _ = edges_of(faces)
    step = catmull_clark(faces, count)
    split = np.zeros(len(edges), bool)
    split[sides[fine & keep].ravel()] = True
    middle = count + len(edges) + np.arange(len(faces))
    quads = step.faces.reshape(4, -1, 4)[:, fine & keep].reshape(-1, 4)
    plain = keep & ~fine & ~split[sides].any(1)
    triangles = [triangulate(quads), triangulate(faces[plain])]
    fans = []
    for face in np.flatnonzero(keep & ~fine & ~plain):
        outline = []
        for k in range(4):
            outline.append(faces[face, k])
            if split[sides[face, k]]:
                outline.append(count + sides[face, k])
        fans += [[middle[face], a, b] for a, b in zip(outline, outline[1:] + outline[:1], strict=True)]
    return np.concatenate([*triangles, np.array(fans, np.int64).reshape(-1, 3)])


def triangulate(quads: Ints) -> Ints:
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def normals(points: Array, triangles: Ints) -> Array:
    """Area-weighted vertex normals (n, 3)."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    face = np.cross(b - a, c - a)
    total = np.zeros_like(points)
    for k in range(3):
        np.add.at(total, triangles[:, k], face)
    return total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-12)


class Rings:
    """Edge loops of a quad mesh, followed straight on through vertices of four edges."""

    def __init__(self, faces: Ints) -> None:
        self.neighbours: dict[int, set[int]] = defaultdict(set)
        self.faces_at: dict[int, set[int]] = defaultdict(set)
        self.faces = faces
        for number, face in enumerate(faces.tolist()):
            for k in range(4):
                a, b = face[k], face[(k + 1) % 4]
                self.neighbours[a].add(b)
                self.neighbours[b].add(a)
                self.faces_at[a].add(number)

    def follow(self, first: int, second: int) -> list[int]:
        """The loop that starts first, second, ... ; raises ValueError if it does not close."""
        loop = [first, second]
        while len(loop) < 1000:
            here, before = loop[-1], loop[-2]
            beside = {int(v) for f in self.faces_at[here] & self.faces_at[before] for v in self.faces[f]}
            ahead = self.neighbours[here] - beside
            if len(self.neighbours[here]) != 4 or len(ahead) != 1:
                break
            (following,) = ahead
            if following == first:
                return loop
            loop.append(following)
        raise ValueError(f"the edge loop through {first} and {second} does not close")


def laplacian(points: Array, triangles: Ints) -> tuple[sp.csr_matrix, Array]:
    """Cotangent Laplacian (n, n), positive semi-definite, and vertex areas (n,)."""
    n = len(points)
    rows, columns, values = [], [], []
    area = np.zeros(n)
    for k in range(3):
        i, j, o = triangles[:, k], triangles[:, (k + 1) % 3], triangles[:, (k + 2) % 3]
        u, v = points[i] - points[o], points[j] - points[o]
        cross = np.linalg.norm(np.cross(u, v), axis=1)
        cotangent = np.clip((u * v).sum(1) / np.maximum(cross, 1e-12), 0.02, 10) / 2
        rows += [i, j]
        columns += [j, i]
        values += [cotangent, cotangent]
        np.add.at(area, o, cross / 6)
    weights = sp.csr_matrix(
        (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(n, n)
    )
    return _diag(np.asarray(weights.sum(1)).ravel()) - weights, np.maximum(area, area[area > 0].min())


def smooth_fields(points: Array, triangles: Ints, fixed: Ints, values: Array, harmonic: float = 0.0) -> Array:
    """Biharmonic functions on a surface: (n, m) fields that equal `values` (len(fixed), m) at `fixed`.

    `harmonic` mixes in the Laplacian itself (1/length^2), which keeps the fields from overshooting.
    """
    matrix, area = laplacian(points, triangles)
    energy = (matrix @ _diag(1 / area) @ matrix + harmonic * matrix).tocsc()
    free = np.setdiff1d(np.arange(len(points)), fixed)
    fields = np.zeros((len(points), values.shape[1]))
    fields[fixed] = values
    solver = splu(energy[free][:, free].tocsc())
    fields[free] = solver.solve(-(energy[free][:, fixed] @ values))
    return fields


def rasterise(uvs: Array, triangles: Ints, attributes: Array, size: int) -> tuple[Array, NDArray[np.bool_]]:
    """Attributes (n, k) over the texture: (size, size, k), row 0 at v = 0, and what is covered."""
    picture = np.zeros((size, size, attributes.shape[1]))
    covered = np.zeros((size, size), bool)
    pixels = uvs * size - 0.5
    for corners in triangles:
        a, b, c = pixels[corners]
        low = np.maximum(np.ceil(np.minimum(np.minimum(a, b), c) - 0.5), 0).astype(int)
        high = np.minimum(np.floor(np.maximum(np.maximum(a, b), c) + 0.5), size - 1).astype(int)
        det = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        if abs(det) < 1e-9 or (high < low).any():
            continue
        x, y = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
        s = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / det
        t = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / det
        inside = (s >= -1e-3) & (t >= -1e-3) & (s + t <= 1 + 1e-3)
        if not inside.any():
            continue
        shares = np.stack([1 - s - t, s, t], -1)[inside]
        picture[y[inside], x[inside]] = shares @ attributes[corners]
        covered[y[inside], x[inside]] = True
    return picture, covered


def _diag(values: Array) -> sp.dia_matrix:
    return sp.diags(np.asarray(values, float))
