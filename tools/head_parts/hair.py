"""Hair: a cap over the scalp and strands on cards above it, as grooms.toml says. Decimetres."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy import ndimage
from scipy.interpolate import PchipInterpolator
from scipy.spatial import cKDTree

from head_parts.bust import Bust
from head_parts.features import Mesh, facing, grid
from head_parts.surface import Array, Ints

SKULL = np.array([0.0, 7.62, 0.40])
"""Where hair is measured from: directions for its mesh, the axis of its azimuth."""
CAP_TILES, CARD_TILES = 2, 8
"""Columns of the hair's picture: opaque ones for the cap, then strands, the last two of them sparse."""
TILES = CAP_TILES + CARD_TILES
SPARSE = 2
CAP_RISE, CAP_BACK = 0.018, 0.15
"""How high a cap under cards is, and how far it stays behind the hairline."""
EDGE = 0.07
"""Width of the hairline, where strands are finer and more."""
CAP_REACH = np.radians(150)
UP = np.array([0.0, 1.0, 0.0])
FINER = 3
"""Steps in which a guide grows for each segment of its card."""
ROOT_RISE = 0.03
"""Strands lie at least so high: the straight pieces of a card cut the corner of the skull."""


@dataclass(frozen=True)
class Groom:
    """One way to wear hair; see grooms.toml for the fields."""

    line: tuple[tuple[float, float], ...]
    rise: tuple[float, float, float]
    comb: tuple[tuple[float, ...], ...] = ()
    part: float | None = None
    cards: int = 0
    segments: int = 5
    width: float = 0.13
    length: tuple[float, float, float] = (0.5, 0.3, 0.2)
    lift: float = 20.0
    stray: float = 0.12
    wave: float = 0.0
    waves: float = 1.0
    cut: float = 0.99
    gravity: float = 0.1
    hem: float | None = None
    cover: bool = False


def groom(name: str) -> Groom:
    """Raises KeyError for a name that is not in grooms.toml."""
    row = tomllib.loads(Path(__file__).with_name("grooms.toml").read_text("utf-8"))[name]
    return Groom(**{key: _tuples(value) for key, value in row.items()})


def _tuples(value: object) -> object:
    return tuple(_tuples(item) for item in value) if isinstance(value, list) else value


def smoothstep(low: float, high: float, value: Array) -> Array:
    t = np.clip((value - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def azimuth(points: Array) -> Array:
    """Degrees from the front, 0..180, about the vertical through the skull."""
    offset = points - SKULL
    return np.degrees(np.arctan2(np.abs(offset[..., 0]), offset[..., 2]))


@dataclass
class Scalp:
    """The head under the hair of one groom. `ears` (n,) 0..1 on the fine skin."""

    bust: Bust
    groom: Groom
    ears: Array

    def __post_init__(self) -> None:
        bust = self.bust
        self.eye_y = bust.eyes["l"].centre[1]
        points = bust.skin.points
        outside = np.zeros(len(points), bool)
        outside[np.unique(bust.step.faces.reshape(4, -1, 4)[:, (bust.charts == 0) | (bust.charts == 3)])] = (
            True
        )
        bare = outside & (self.ears < 0.02) & (points[:, 1] > 6.2)
        offset = points[bare] - SKULL
        self._reach = np.linalg.norm(offset, axis=1)
        self._tree = cKDTree(offset / self._reach[:, None])
        under = outside & (True if self.groom.cover else self.ears < 0.5)
        self._skin = points[under], bust.skin.normals[under]
        self._near = cKDTree(self._skin[0])

    def radius(self, direction: Array) -> Array:
        """Distance from the skull's centre to the head without its ears, smoothed; directions (..., 3)."""
        gap, index = self._tree.query(direction.reshape(-1, 3), k=48)
        weight = np.exp(-0.5 * (gap / 0.055) ** 2) + 1e-12
        return ((weight * self._reach[index]).sum(1) / weight.sum(1)).reshape(direction.shape[:-1])

    def above_skin(self, points: Array) -> tuple[Array, Array]:
        """Height (n,) of points over the skin (ears too, where hair covers them) and the way out (n, 3)."""
        surface, outward = self._skin
        gap, index = self._near.query(points, k=8)
        weight = 1 / (gap + 0.01) ** 2
        weight /= weight.sum(1, keepdims=True)
        way = (weight[..., None] * outward[index]).sum(1)
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        height = (weight * ((points[:, None] - surface[index]) * outward[index]).sum(2)).sum(1)
        return height, way

    def inside(self, points: Array) -> Array:
        """Distance inside the hairline, negative outside, of points on the scalp."""
        table = np.array(self.groom.line)
        line = PchipInterpolator(table[:, 0], table[:, 1] + self.eye_y)
        at = azimuth(points)
        offset = points - SKULL
        reach = np.maximum(np.hypot(offset[..., 0], offset[..., 2]), 0.3)
        slope = line(at, 1) / (np.radians(1) * reach)
        above = points[..., 1] - line(at)
        across = np.maximum(above / np.sqrt(1 + slope**2), above - 0.36)
        return np.where(above < -0.15, above / 2, across)

    def body(self, points: Array) -> Array:
        """How high the outermost hair stands."""
        top, front, side = self.groom.rise
        high = smoothstep(0.15, 0.85, points[..., 1] - self.eye_y)
        ahead = smoothstep(0.3, 0.95, points[..., 2] - SKULL[2]) * high
        low = smoothstep(-0.2, -0.7, points[..., 1] - self.eye_y)
        return side + (top - side) * high + (front - top) * ahead - 0.25 * side * low

    def cap(self) -> Mesh:
        """A closed surface over the scalp that leaves the skin at the hairline; thin where cards cover it."""
        polar = np.radians(np.r_[0.5, np.linspace(8, 60, 7), np.linspace(66, 146, 17)])
        turn = np.linspace(0, 2 * np.pi, 40, endpoint=False)
        t, a = np.meshgrid(polar, turn, indexing="ij")
        direction = np.stack([np.sin(t) * np.sin(a), np.cos(t), np.sin(t) * np.cos(a)], -1)
        radius = ndimage.gaussian_filter(self.radius(direction), (1.0, 1.0), mode=("nearest", "wrap"))
        scalp = SKULL + direction * radius[..., None]
        inside = self.inside(scalp)
        if self.groom.cards:
            inside = inside - CAP_BACK
            height = CAP_RISE * smoothstep(-0.01, 0.06, inside) + 0.15 * self.body(scalp) * smoothstep(
                0.1, 0.5, inside
            )
        else:
            rise = np.sqrt(smoothstep(-0.01, 0.16, inside) + 1e-6) * (
                0.3 + 0.7 * smoothstep(0.0, 0.35, inside)
            )
            height = self.body(scalp) * rise
        height = np.where(inside > 0, height, np.maximum(inside * 0.6, -0.05))
        uvs = from_above(t, a) if not self.groom.cards else _under_cards(t.shape)
        mesh = grid(scalp + direction * height[..., None], uvs, closed=True)
        used = (inside.ravel() > -0.05)[mesh.triangles].any(1)
        return facing(trimmed(mesh, used), direction.reshape(-1, 3)[np.unique(mesh.triangles[used])])


def from_above(polar: Array, turn: Array) -> Array:
    """Texture coordinates (..., 2) of directions, the top of the head in the middle of the picture."""
    reach = 0.49 * polar / CAP_REACH
    return 0.5 + np.stack([reach * np.sin(turn), reach * np.cos(turn)], -1)


def seen_from_above(uvs: Array) -> Array:
    """The directions (..., 3) of texture coordinates: the inverse of `from_above`."""
    x, y = np.moveaxis(uvs - 0.5, -1, 0)
    polar, turn = np.hypot(x, y) / 0.49 * CAP_REACH, np.arctan2(x, y)
    return np.stack([np.sin(polar) * np.sin(turn), np.cos(polar), np.sin(polar) * np.cos(turn)], -1)


def _under_cards(shape: tuple[int, int]) -> Array:
    """Texture coordinates (rows, columns, 2) in the opaque columns of the picture of strands, to and fro.

    They do not change along the strands, so that shaders find no direction to put a highlight on.
    """
    around = np.broadcast_to(np.arange(shape[1]) % 2, shape)
    return np.stack([(0.02 + 0.96 * around) * CAP_TILES / TILES, np.full(shape, 0.5)], -1)


def trimmed(mesh: Mesh, used: np.ndarray) -> Mesh:
    """Only the triangles `used` and their vertices."""
    keep, triangles = np.unique(mesh.triangles[used], return_inverse=True)
    return Mesh(mesh.points[keep], mesh.uvs[keep], triangles.reshape(-1, 3))


@dataclass
class Strands:
    """Guides: paths (n, k, 3) root to tip, the way out of the head at each point, and half a width (n,)."""

    paths: Array
    out: Array
    half: Array
    sparse: np.ndarray
    cut: float

    @classmethod
    def grown(cls, scalp: Scalp, rng: np.random.Generator) -> Strands:
        """Hair as it lies: each guide follows the comb, bends down with its length and keeps off the skin."""
        style = scalp.groom
        point, edge = _roots(scalp, rng)
        count = FINER * style.segments
        step = _lengths(scalp, point, rng)[:, None] / count
        layer = rng.uniform(0.40, 1.0, len(point)) * (0.5 + 0.5 * smoothstep(0.0, 0.3, edge))
        stray = style.stray * rng.normal(size=point.shape)
        _, way = scalp.above_skin(point)
        lift = np.radians(style.lift) * smoothstep(-0.05, 0.25, edge)[:, None]
        heading = _unit(_along(_combed(style, point) + stray, way) * np.cos(lift) + way * np.sin(lift))
        paths, out = [point + ROOT_RISE * smoothstep(0.0, 0.1, edge)[:, None] * way], [way]
        for k in range(1, count + 1):
            lie = _along(_combed(style, point) + stray, way)
            heading = _unit(0.72 * heading + 0.28 * lie - 0.4 * style.gravity * k / count * UP)
            point = point + step * heading
            height, way = scalp.above_skin(point)
            wanted = ROOT_RISE + scalp.body(point) * layer * min(1.0, 2.2 * k / count)
            hanging = style.cover & (point[:, 1] < scalp.eye_y + 0.25)
            push = np.where(hanging, np.maximum(np.maximum(wanted, 0.035) - height, 0), wanted - height)
            point = point + push[:, None] * way
            paths.append(point)
            out.append(way)
        sparse = edge < EDGE
        half = style.width / 2 * rng.uniform(0.75, 1.25, len(point)) * np.where(sparse, 0.75, 1.0)
        guides = cls(np.stack(paths, 1), np.stack(out, 1), half, sparse, style.cut)
        hem = np.full(len(point), -np.inf if style.hem is None else scalp.eye_y + style.hem)
        return guides.cut_at(hem + 0.03 * rng.normal(size=len(point)), style.segments).waved(
            style.wave, style.waves
        )

    def cut_at(self, hem: Array, segments: int) -> Strands:
        """The guides cut where they pass the height `hem` (n,), in so many segments, shorter to the root."""
        n, k = self.paths.shape[:2]
        fine = np.linspace(0, k - 1, 8 * k)
        below = np.array([np.interp(fine, np.arange(k), path[:, 1]) for path in self.paths]) < hem[:, None]
        end = np.where(below.any(1), fine[np.argmax(below, 1)], k - 1)
        at = np.linspace(0, 1, segments + 1) ** 1.3 * np.maximum(end, 1.0)[:, None]
        low = np.minimum(at.astype(int), k - 2)
        share, row = (at - low)[..., None], np.arange(n)[:, None]
        mixed = [(1 - share) * v[row, low] + share * v[row, low + 1] for v in (self.paths, self.out)]
        return replace(self, paths=mixed[0], out=mixed[1])

    def waved(self, size: float, count: float) -> Strands:
        """The guides bent to and fro, `size` at the tips, `count` times; neighbours together."""
        k = self.paths.shape[1]
        t = np.linspace(0, 1, k)
        side = _unit(np.cross(np.gradient(self.paths, axis=1), self.out))
        phase = 2.5 * self.paths[:, :1].sum(2) + 1.5 * np.sin(4 * self.paths[:, :1, 1])
        bend = size * np.sin(2 * np.pi * count * t + phase) * smoothstep(0.0, 0.5, t)
        turn = 0.5 * size * np.cos(2 * np.pi * count * t + phase) * smoothstep(0.0, 0.5, t)
        moved = self.paths + bend[..., None] * side + np.maximum(turn, -0.01)[..., None] * self.out
        return replace(self, paths=moved)

    def mesh(self, rng: np.random.Generator) -> tuple[Mesh, Array]:
        """Cards along the guides, and their normals, which lean to the way out so that neighbours agree."""
        n, k = self.paths.shape[:2]
        ahead = _unit(np.gradient(self.paths, axis=1))
        side = _unit(np.cross(ahead, self.out))
        face = np.cross(side, ahead)
        roll = np.radians(rng.normal(0, 16, n))[:, None, None]
        across = np.cos(roll) * side + np.sin(roll) * face
        taper = np.interp(np.linspace(0, 1, k), [0, 0.25, 0.7, 1], [1.05, 1.05, 0.95, 0.7])
        spread = across * (self.half[:, None] * taper)[..., None]
        points = np.stack([self.paths - spread, self.paths + spread], 2)
        normal = np.repeat(_unit(0.65 * self.out + 0.35 * face)[:, :, None], 2, 2)
        full = CARD_TILES - SPARSE
        tile = np.where(self.sparse, full + rng.integers(0, SPARSE, n), rng.integers(0, full, n))
        u = (CAP_TILES + tile[:, None] + np.array([0.03, 0.97])) / TILES
        flip = rng.random(n) < 0.5
        u[flip] = u[flip, ::-1]
        v = 0.01 + (self.cut - 0.01) * np.linspace(0, 1, k) ** 1.3
        uvs = np.stack([np.repeat(u[:, None], k, 1), np.broadcast_to(v[None, :, None], (n, k, 2))], -1)
        i, j = np.meshgrid(np.arange(n), np.arange(k - 1), indexing="ij")
        a = (i * k + j).ravel() * 2
        triangles = np.concatenate([np.stack([a, a + 1, a + 3], 1), np.stack([a, a + 3, a + 2], 1)])
        return Mesh(points.reshape(-1, 3), uvs.reshape(-1, 2), triangles), normal.reshape(-1, 3)


def _roots(scalp: Scalp, rng: np.random.Generator) -> tuple[Array, Array]:
    """Points on the scalp, evenly strewn, with how far inside the hairline each is."""
    count = scalp.groom.cards
    direction = rng.normal(size=(count * 24, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    points = SKULL + direction * scalp.radius(direction)[:, None]
    edge = scalp.inside(points)
    keep = edge > 0.0
    points, edge = points[keep], edge[keep]
    rim = np.flatnonzero(edge < EDGE)
    chosen = np.r_[_spread(points, count - count // 5), rim[_spread(points[rim], count // 5)]]
    return points[chosen], edge[chosen]


def _spread(points: Array, count: int) -> Ints:
    """`count` of the points, each the farthest from those before it."""
    chosen = [0]
    gap = np.full(len(points), np.inf)
    for _ in range(count - 1):
        gap = np.minimum(gap, ((points - points[chosen[-1]]) ** 2).sum(1))
        chosen.append(int(np.argmax(gap)))
    return np.array(chosen)


def _lengths(scalp: Scalp, roots: Array, rng: np.random.Generator) -> Array:
    top, side, nape = scalp.groom.length
    high = smoothstep(0.25, 0.75, roots[:, 1] - scalp.eye_y)
    low = smoothstep(-0.1, -0.55, roots[:, 1] - scalp.eye_y)
    length = (side + (top - side) * high + (nape - side) * low) * rng.uniform(0.8, 1.1, len(roots))
    return length


def _combed(style: Groom, points: Array) -> Array:
    """The comb's direction (n, 3) at points."""
    table = np.array(style.comb)
    turn, polar = np.radians(table[:, 0]), np.radians(table[:, 1])
    keys = np.stack([np.sin(polar) * np.sin(turn), np.cos(polar), np.sin(polar) * np.cos(turn)], 1)
    at = _unit(points - SKULL)
    weight = np.exp(8 * (at @ keys.T - 1))
    found = weight @ table[:, 2:]
    if style.part is not None:
        found[:, 0] *= np.tanh((points[:, 0] - style.part) / 0.04)
    return _unit(found)


def _along(wish: Array, out: Array) -> Array:
    """The part of `wish` that lies in the surface."""
    return _unit(wish - (wish * out).sum(1, keepdims=True) * out)


def _unit(vectors: Array) -> Array:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9)
