"""The parts made from nothing: eyeballs, teeth with gums. Decimetres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from head_parts.surface import Array, Ints, normals, triangulate

IRIS_RAD, PUPIL_RAD, EYE_SPAN_RAD = 0.415, 0.15, 2.0
TOOTH_WIDTHS = {
    "upper": (0.085, 0.066, 0.074, 0.068, 0.066, 0.098),
    "lower": (0.053, 0.058, 0.066, 0.068, 0.070, 0.105),
}
TOOTH_HEIGHTS = {
    "upper": (0.100, 0.090, 0.097, 0.082, 0.076, 0.070),
    "lower": (0.086, 0.086, 0.094, 0.080, 0.074, 0.068),
}


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


def eyeball(centre: Array, radius: float) -> tuple[Mesh, Array]:
    """A ball with a slight cornea, looking along +z, and the polar angle of each vertex."""
    theta = np.concatenate(
        [
            [0.0],
            np.linspace(0.07, PUPIL_RAD, 2),
            np.linspace(0.2, IRIS_RAD, 4),
            np.linspace(0.5, EYE_SPAN_RAD, 11),
        ]
    )
    phi = np.linspace(0, 2 * np.pi, 28, endpoint=False)
    t, p = np.meshgrid(theta, phi, indexing="ij")
    bulge = 1 + 0.035 * np.sqrt(np.clip(1 - (t / (IRIS_RAD * 1.1)) ** 2, 0, 1))
    direction = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], -1)
    reach = 0.5 * np.minimum(t / EYE_SPAN_RAD, 1)
    uvs = 0.5 + np.stack([reach * np.cos(p), -reach * np.sin(p)], -1)
    mesh = grid(centre + radius * bulge[..., None] * direction, uvs, closed=True)
    return facing(mesh, direction.reshape(-1, 3)), t.ravel()


@dataclass(frozen=True)
class Arch:
    """The line on which teeth stand, a half ellipse seen from above."""

    front: float
    half_width: float
    depth: float

    def at(self, along: Array) -> tuple[Array, Array]:
        """Points (n, 3) at y = 0 and outward directions, by arc length from the middle, + to the left."""
        angle = np.linspace(0, 1.45, 400)
        x, z = self.half_width * np.sin(angle), self.front - self.depth * (1 - np.cos(angle))
        length = np.r_[0, np.cumsum(np.hypot(np.diff(x), np.diff(z)))]
        at = np.interp(np.abs(along), length, angle)
        sign = np.where(along < 0, -1.0, 1.0)
        zero = np.zeros_like(at)
        points = np.stack(
            [sign * self.half_width * np.sin(at), zero, self.front - self.depth * (1 - np.cos(at))], -1
        )
        out = np.stack([sign * self.depth * np.sin(at), zero, self.half_width * np.cos(at)], -1)
        return points, out / np.linalg.norm(out, axis=-1, keepdims=True)


def teeth(which: str, arch: Arch, edge: float) -> Mesh:
    """One row of teeth with its gum; `edge` is the y of the biting edge. Texture: teeth left, gum right."""
    up = 1.0 if which == "upper" else -1.0
    meshes, start = [], 0.0
    for width, height in zip(TOOTH_WIDTHS[which], TOOTH_HEIGHTS[which], strict=True):
        centre = start + width / 2
        start += width
        for side in (1.0, -1.0):
            meshes.append(_tooth(arch, side * centre, width, height, edge, up))
    return joined([*meshes, _gum(arch, start, edge, up)])


def _tooth(arch: Arch, along: float, width: float, height: float, edge: float, up: float) -> Mesh:
    """A rounded box (superquadric), broader towards its biting edge."""
    turn, rise = np.meshgrid(
        np.linspace(0, 2 * np.pi, 10, endpoint=False),
        np.array([-1.57, -1.25, -0.6, 0.6, 1.25, 1.57]),
        indexing="ij",
    )
    power = lambda value, exponent: np.sign(value) * np.abs(value) ** exponent  # noqa: E731
    ring = power(np.cos(rise), 0.35)
    local_x = power(np.cos(turn), 0.55) * ring * width * 0.53
    local_z = power(np.sin(turn), 0.7) * ring * 0.030
    local_y = power(np.sin(rise), 0.75) * height / 2
    local_x *= 1 - 0.10 * (up * local_y / height + 0.5)
    point, out = arch.at(np.array(along))
    across = np.cross([0.0, 1.0, 0.0], out)
    lean = -0.25 * (up * local_y + height / 2) * 0.5
    middle = edge + up * height / 2
    points = point + local_x[..., None] * across + (local_z + lean)[..., None] * out
    points[..., 1] = middle + local_y
    shade = up * local_y / height + 0.5
    depth = np.full_like(shade, 0.02 + 0.44 * min(abs(along) / 0.45, 1.0))
    uvs = np.stack([depth, 1 - shade], -1).transpose(1, 0, 2)
    mesh = grid(points.transpose(1, 0, 2), uvs, closed=True)
    return facing(mesh, mesh.points - mesh.points.mean(0))


def _gum(arch: Arch, reach: float, edge: float, up: float) -> Mesh:
    """A tube round the roots, scalloped between the teeth by simply being higher there."""
    along, turn = np.meshgrid(
        np.linspace(-reach, reach, 33), np.linspace(0, 2 * np.pi, 8, endpoint=False), indexing="ij"
    )
    points, out = arch.at(along)
    middle = edge + up * 0.125
    points = points + out * (0.036 * np.cos(turn) - 0.018)[..., None]
    points[..., 1] = middle + 0.055 * np.sin(turn)
    uvs = np.stack([np.full_like(turn, 0.75), 0.5 + 0.5 * np.sin(turn) * up], -1)
    mesh = grid(points, uvs, closed=True)
    centre, _ = arch.at(along)
    centre[..., 1] = middle
    return facing(mesh, mesh.points - centre.reshape(-1, 3))


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
