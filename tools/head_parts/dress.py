"""Hair and shirt, and what of the skin they leave to be seen. Decimetres."""

from __future__ import annotations

import numpy as np
from scipy import ndimage
from scipy.interpolate import PchipInterpolator
from scipy.spatial import cKDTree

from head_parts import paint
from head_parts.assemble import Piece
from head_parts.bust import Bust
from head_parts.features import Mesh, facing, grid
from head_parts.source import Source
from head_parts.surface import Array, Ints, edges_of, laplacian, normals, triangulate

SKULL = np.array([0.0, 7.62, 0.40])
"""Where hair is measured from: directions for its mesh, the axis of its azimuth."""
HAIRLINE = (
    # azimuth from the front in degrees, height over the eyes
    (0, 0.665), (15, 0.66), (28, 0.60), (38, 0.47), (46, 0.25), (52, 0.04), (58, -0.17), (63, -0.20),
    (68, -0.15),
    (74, 0.06), (85, 0.14), (97, 0.08), (104, -0.16), (112, -0.42), (125, -0.60), (150, -0.70), (180, -0.72),
)  # fmt: skip
NECKLINE = (5.70, 0.34)
"""The collar's plane: height at z = 0.85, and slope towards the back."""
SHIRT_GAP = 0.05
HEAD_BONES = (
    "head",
    "jaw",
    "special",
    "levator",
    "oris",
    "oculi",
    "orbicularis",
    "risorius",
    "temporalis",
    "tongue",
    "eye",
)
NECK_SHARES = {"neck03": 0.85, "neck02": 0.55, "neck01": 0.22}


def smoothstep(low: float, high: float, value: Array) -> Array:
    t = np.clip((value - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def azimuth(points: Array) -> Array:
    """Degrees from the front, 0..180, about the vertical through the skull."""
    offset = points - SKULL
    return np.degrees(np.arctan2(np.abs(offset[..., 0]), offset[..., 2]))


def above_hairline(points: Array, eye_y: float) -> Array:
    """Distance inside the hairline, negative outside, of points on the scalp."""
    table = np.array(HAIRLINE)
    line = PchipInterpolator(table[:, 0], table[:, 1] + eye_y)
    at = azimuth(points)
    offset = points - SKULL
    reach = np.maximum(np.hypot(offset[..., 0], offset[..., 2]), 0.3)
    slope = line(at, 1) / (np.radians(1) * reach)
    above = points[..., 1] - line(at)
    across = np.maximum(above / np.sqrt(1 + slope**2), above - 0.36)
    return np.where(above < -0.15, above / 2, across)


def ear_mask(source: Source, bust: Bust) -> Array:
    """(n,) on the fine skin: 1 on the ears, falling off around them."""
    values = np.zeros(len(source.base))
    values[bust.control] = paint.sample(source.mask("ears"), paint.atlas_uvs(source, bust))
    skin = bust.skin
    fine = np.clip(bust.fine(values), 0, 1) * (np.abs(skin.points[:, 0]) > 0.55)
    core = np.flatnonzero(fine > 0.7)
    gap = cKDTree(skin.points[core]).query(skin.points)[0]
    return 1 - smoothstep(0.0, 0.12, gap)


def visible_skin(bust: Bust) -> np.ndarray:
    """bool per coarse quad: the face and neck, to a little under the collar."""
    centre = bust.step.matrix[: len(bust.control)] @ bust.shape[bust.control]
    above = _over_neckline(centre[bust.quads]).max(1) > -0.10
    return ((bust.charts == 0) | (bust.charts == 3)) & above


def worth_detail(bust: Bust) -> np.ndarray:
    """bool per coarse quad: the front of the face, where finer triangles show."""
    points = bust.skin.points[: len(bust.control)]
    centre = points[bust.quads].mean(1)
    front = (
        (centre[:, 2] > 0.75) & (centre[:, 1] > 6.28) & (centre[:, 1] < 7.86) & (np.abs(centre[:, 0]) < 0.60)
    )
    scalp = above_hairline(points, bust.eyes["l"].centre[1])[bust.quads].min(1) > 0.08
    nostril = (bust.skin.normals[: len(points)][bust.quads].mean(1)[:, 1] < -0.5) & (centre[:, 1] > 6.93)
    return front & ~scalp & ~nostril & (bust.charts == 0)


def hair(source: Source, bust: Bust) -> Piece:
    """A height field over the skull with locks along the strands; it leaves the skin at the hairline."""
    eye_y = bust.eyes["l"].centre[1]
    polar = np.radians(np.r_[0.5, np.linspace(5, 60, 15), np.linspace(62.5, 152, 32)])
    turn = np.linspace(0, 2 * np.pi, 78, endpoint=False)
    t, a = np.meshgrid(polar, turn, indexing="ij")
    direction = np.stack([np.sin(t) * np.sin(a), np.cos(t), np.sin(t) * np.cos(a)], -1)
    scalp = SKULL + direction * _scalp_radius(source, bust, direction)[..., None]
    strand, length = strands(direction)
    rng = np.random.default_rng(7)
    locks = _noise1(rng, 220, strand * 16) * 0.65 + _noise1(rng, 500, strand * 38) * 0.35
    inside = above_hairline(scalp, eye_y) + 0.014 * _noise1(rng, 300, strand * 30)
    high = smoothstep(0.15, 0.85, scalp[..., 1] - eye_y)
    front = smoothstep(0.3, 0.95, scalp[..., 2] - SKULL[2]) * high
    body = 0.045 + 0.115 * high + 0.045 * front - 0.02 * smoothstep(-0.2, -0.7, scalp[..., 1] - eye_y)
    rise = np.sqrt(smoothstep(-0.01, 0.16, inside) + 1e-6) * (0.25 + 0.75 * smoothstep(0.0, 0.35, inside))
    parting = np.exp(-((length / 0.09) ** 2)) * 0.025 * high * smoothstep(1.5, 0.9, strand)
    height = (
        body * rise
        + 0.016 * locks * smoothstep(0.02, 0.2, inside) * (0.5 + high) * smoothstep(0.05, 0.9, length)
        - parting
    )
    height = np.where(inside > 0, height, np.maximum(inside * 0.6, -0.05))
    mesh = grid(
        scalp + direction * height[..., None], np.stack([strand * 1.6, 0.05 + length * 0.55], -1), closed=True
    )
    used = (inside.ravel() > -0.05)[mesh.triangles].any(1)
    mesh = facing(_trimmed(mesh, used), direction.reshape(-1, 3)[np.unique(mesh.triangles[used])])
    return Piece.of("hair", mesh, paint.hair_material())


def strands(direction: Array) -> tuple[Array, Array]:
    """For directions on the skull: which strand, and how far along it from the parting (radians)."""
    polar = np.arccos(np.clip(direction[..., 1], -1, 1))
    flat = polar[..., None] * np.stack([direction[..., 0], direction[..., 2]], -1)
    flat /= np.maximum(np.sin(polar), 1e-6)[..., None]
    start, end = np.array([0.36, 1.20]), np.array([0.10, -0.45])
    line = end - start
    length = np.linalg.norm(line)
    offset = flat - start
    along = offset @ line / length
    aside = np.abs(offset[..., 0] * line[1] - offset[..., 1] * line[0]) / length
    beyond = np.where(along > length, along - length, np.where(along < 0, along, 0))
    angle = np.arctan2(beyond, aside)
    return np.clip(along, 0, length) + 0.55 * angle, np.hypot(aside, beyond)


def _scalp_radius(source: Source, bust: Bust, direction: Array) -> Array:
    """Distance from the skull's centre to the head without its ears, smoothed."""
    ears = ear_mask(source, bust)
    points = bust.skin.points
    outside = np.zeros(len(points), bool)
    outside[np.unique(bust.step.faces.reshape(4, -1, 4)[:, bust.charts == 0])] = True
    outside &= (ears < 0.02) & (points[:, 1] > 6.2)
    offset = points[outside] - SKULL
    reach = np.linalg.norm(offset, axis=1)
    gap, index = cKDTree(offset / reach[:, None]).query(direction.reshape(-1, 3), k=48)
    weight = np.exp(-0.5 * (gap / 0.055) ** 2) + 1e-12
    radius = ((weight * reach[index]).sum(1) / weight.sum(1)).reshape(direction.shape[:2])
    return ndimage.gaussian_filter(radius, (1.0, 1.0), mode=("nearest", "wrap"))


def _noise1(rng: np.random.Generator, count: int, at: Array) -> Array:
    """Smooth noise of unit size, about one wave per unit of `at`."""
    values = rng.uniform(-1, 1, count)
    return ndimage.map_coordinates(
        values, [np.asarray(at).ravel() + count / 2], order=3, mode="grid-wrap"
    ).reshape(at.shape)


def _trimmed(mesh: Mesh, used: np.ndarray) -> Mesh:
    keep, triangles = np.unique(mesh.triangles[used], return_inverse=True)
    return Mesh(mesh.points[keep], mesh.uvs[keep], triangles.reshape(-1, 3))


def _over_neckline(points: Array) -> Array:
    height, slope = NECKLINE
    plane = points[..., 1] - (height + slope * (0.85 - points[..., 2]))
    return np.minimum(plane, 2 * (1.0 - np.abs(points[..., 0])))


def clothes(bust: Bust) -> dict[str, Piece]:
    """A plain shirt over the torso, cut at the neckline, and its collar."""
    torso = bust.quads[bust.charts == 3]
    skin = bust.skin
    matrix, _ = laplacian(skin.points, skin.triangles)
    points = _relaxed(skin.points + skin.normals * SHIRT_GAP, matrix, 6)
    points, triangles = clip(points, triangulate(torso), -_over_neckline(points))
    shirt = Mesh(points, np.zeros((len(points), 2)), triangles)
    ring = _collar(points, triangles)
    return {
        "shirt": Piece.of("shirt", shirt, paint.SHIRT),
        "collar": Piece.of("collar", ring, paint.SHIRT),
    }


def _relaxed(points: Array, matrix: object, rounds: int) -> Array:
    """Points moved towards the mean of their neighbours."""
    import scipy.sparse as sp

    adjacency = -(matrix - sp.diags(matrix.diagonal()))
    total = np.asarray(adjacency.sum(1)).ravel()[:, None]
    for _ in range(rounds):
        points = points + 0.5 * ((adjacency @ points) / np.maximum(total, 1e-9) - points) * (total > 0)
    return points


def clip(points: Array, triangles: Ints, inside: Array) -> tuple[Array, Ints]:
    """The part of a mesh where `inside` (n,) is positive, cut exactly; new vertices on the cut."""
    new: dict[tuple[int, int], int] = {}
    added: list[Array] = []

    def cross(a: int, b: int) -> int:
        key = (min(a, b), max(a, b))
        if key not in new:
            t = inside[key[0]] / (inside[key[0]] - inside[key[1]])
            new[key] = len(points) + len(added)
            added.append(points[key[0]] + t * (points[key[1]] - points[key[0]]))
        return new[key]

    kept = []
    for triangle in triangles.tolist():
        outline = []
        for a, b in zip(triangle, triangle[1:] + triangle[:1], strict=True):
            if inside[a] > 0:
                outline.append(a)
            if (inside[a] > 0) != (inside[b] > 0):
                outline.append(cross(a, b))
        kept += [[outline[0], outline[i], outline[i + 1]] for i in range(1, len(outline) - 1)]
    everything = np.concatenate([points, np.array(added).reshape(-1, 3)])
    used, compact = np.unique(np.array(kept), return_inverse=True)
    return everything[used], compact.reshape(-1, 3)


def _collar(points: Array, triangles: Ints) -> Mesh:
    """A rib along the shirt's upper border."""
    edges, _, counts = edges_of(np.c_[triangles, triangles[:, :1]][:, :3])
    rim = np.unique(edges[counts == 1])
    rim = rim[np.abs(_over_neckline(points[rim])) < 1e-6]
    line = points[rim]
    centre = line.mean(0)
    order = np.argsort(np.arctan2(line[:, 0] - centre[0], line[:, 2] - centre[2]))
    line = line[order]
    even = np.linspace(0, len(line), 53)[:-1]
    smooth = ndimage.gaussian_filter1d(line, 1.5, axis=0, mode="wrap")
    path = np.stack(
        [np.interp(even, np.arange(len(line) + 1), np.r_[smooth[:, k], smooth[0, k]]) for k in range(3)], 1
    )
    ahead = np.roll(path, -1, 0) - np.roll(path, 1, 0)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    outward = path - centre
    outward -= (outward * ahead).sum(1, keepdims=True) * ahead
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    up = np.cross(ahead, outward)
    up *= np.sign(up[:, 1:2])
    turn = np.linspace(0, 2 * np.pi, 8, endpoint=False)
    points = (
        path[None]
        + (0.022 * np.cos(turn))[:, None, None] * outward[None]
        + (0.075 * np.sin(turn) + 0.01)[:, None, None] * (0.9 * up - 0.35 * outward)[None]
    )
    points = np.concatenate([points, points[:1]])
    mesh = grid(points, np.zeros((*points.shape[:2], 2)), closed=True)
    return facing(mesh, (points - path[None]).reshape(-1, 3))


def neck_weights(source: Source, bust: Bust) -> Array:
    """(n,) on the fine skin: how far it follows the head's rotation."""
    rows = source.json("rigs/standard/weights.default.json")["weights"]
    share, total = np.zeros(len(source.base)), np.zeros(len(source.base))
    for bone, pairs in rows.items():
        table = np.asarray(pairs).reshape(-1, 2)
        part = 1.0 if bone.startswith(HEAD_BONES) else NECK_SHARES.get(bone, 0.0)
        np.add.at(share, table[:, 0].astype(int), table[:, 1] * part)
        np.add.at(total, table[:, 0].astype(int), table[:, 1])
    fine = bust.fine(share / np.maximum(total, 1e-9))
    matrix, _ = laplacian(bust.skin.points, bust.skin.triangles)
    return np.clip(_relaxed(fine[:, None], matrix, 25)[:, 0], 0, 1)


def spread(points: Array, values: Array, wanted: Array) -> Array:
    """Values of the nearest points."""
    found: Array = values[cKDTree(points).query(wanted)[1]]
    return found


__all__ = ["clothes", "ear_mask", "hair", "neck_weights", "normals", "spread", "visible_skin", "worth_detail"]
