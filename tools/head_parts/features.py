"""Meshes over grids, and lashes. Decimetres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from head_parts.surface import Array, Ints, normals, triangulate

IRIS_RAD, PUPIL_RAD = 0.415, 0.15
"""Polar angles, seen from the eye's centre, of the borders of iris and pupil."""


@dataclass(frozen=True)
class Mesh:
    """points (n, 3), uvs (n, 2), triangles (m, 3)."""

    points: Array
    uvs: Array
    triangles: Ints

    @property
    def normals(self) -> Array:
        return normals(self.points, self.triangles)


def grid(points: Array, uvs: Array, closed: bool = False) -> Mesh:
    """A mesh over a (rows, columns, 3) grid; `closed` joins the last column to the first."""
    rows, columns = points.shape[:2]
    last = columns if closed else columns - 1
    i, j = np.meshgrid(np.arange(rows - 1), np.arange(last), indexing="ij")
    k = (j + 1) % columns
    quads = np.stack([i * columns + j, i * columns + k, (i + 1) * columns + k, (i + 1) * columns + j], -1)
    return Mesh(points.reshape(-1, 3), uvs.reshape(-1, 2), triangulate(quads.reshape(-1, 4)))


def joined(meshes: list[Mesh]) -> Mesh:
    offsets = np.cumsum([0] + [len(mesh.points) for mesh in meshes[:-1]])
    return Mesh(
        np.concatenate([mesh.points for mesh in meshes]),
        np.concatenate([mesh.uvs for mesh in meshes]),
        np.concatenate([mesh.triangles + start for mesh, start in zip(meshes, offsets, strict=True)]),
    )


def facing(mesh: Mesh, outward: Array) -> Mesh:
    """The mesh with its triangles turned so that normals agree with `outward` (n, 3) on the whole."""
    if (mesh.normals * outward).sum() < 0:
        return Mesh(mesh.points, mesh.uvs, mesh.triangles[:, ::-1])
    return mesh


def lashes(roots: Array, centre: Array, upper: bool) -> Mesh:
    """A curved fringe on the line `roots` (n, 3), sorted by x, of an eye; u runs along it, v root to tip."""
    x = (roots[:, 0] - roots[:, 0].mean()) / np.ptp(roots[:, 0]) * 2
    size = (0.075 if upper else 0.032) * np.clip(1.05 - 0.6 * np.abs(x) ** 3, 0.3, 1)
    away = roots - centre
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    spread = np.stack([0.55 * x * np.abs(x), np.zeros_like(x), np.zeros_like(x)], 1)
    rise = np.array([0.0, 1.0 if upper else -1.0, 0.0])
    rows = []
    for t in (0.0, 0.35, 0.7, 1.0):
        bend = away * (t - 0.25 * t * t) + spread * t + rise * (0.75 * t * t - 0.08 * t)
        rows.append(roots + size[:, None] * bend + away * 0.002)
    u = np.cumsum(np.r_[0, np.linalg.norm(np.diff(roots, axis=0), axis=1)])
    uvs = np.stack(np.meshgrid(u / u[-1], np.linspace(0.98, 0.03, 4)), -1)
    if not upper:
        uvs[..., 0] = uvs[..., 0] * 0.8 + 0.1
    return grid(np.array(rows), uvs)
