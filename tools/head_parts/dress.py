"""The shirt, and what of the skin it and the hair leave to be seen. Decimetres."""

from __future__ import annotations

import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

from head_parts import paint
from head_parts.assemble import Piece
from head_parts.bust import Bust
from head_parts.features import Mesh, facing, grid, joined
from head_parts.hair import Scalp, smoothstep
from head_parts.people import ShirtLook
from head_parts.source import Source
from head_parts.surface import Array, Ints, edges_of, laplacian, mixed_triangles

NECKLINE = (5.70, 0.34)
"""The collar's plane: height at z = 0.85, and slope towards the back."""
ROUND = 0.10
"""How round the neckline is where it meets the shoulders."""
SHIRT_GAP = 0.05
LARGE_DM2 = 1.5e-3
"""Quads of the face larger than this are subdivided."""
CHIN_CLEAR, FINE_FROM = 6.05, 5.74
"""Heights: below the first all is torso; above the second the shirt is finely made."""
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


def ear_mask(source: Source, bust: Bust) -> Array:
    """(n,) on the fine skin: 1 on the ears, falling off around them."""
    values = np.zeros(len(source.base))
    values[bust.control] = paint.sample(source.mask("ears"), paint.atlas_uvs(source, bust))
    skin = bust.skin
    fine = np.clip(bust.fine(values), 0, 1) * (np.abs(skin.points[:, 0]) > 0.55)
    core = np.flatnonzero(fine > 0.7)
    gap = cKDTree(skin.points[core]).query(skin.points)[0]
    return 1 - smoothstep(0.0, 0.12, gap)


def visible_skin(bust: Bust, scalp: Scalp, look: ShirtLook) -> np.ndarray:
    """bool per coarse quad: the face and neck, to a little under the collar; not what a cap hides."""
    points = bust.skin.points[: len(bust.control)]
    above = _over_neckline(points, look)[bust.quads].max(1) > -0.10
    hidden = (scalp.inside(points)[bust.quads].min(1) > 0.30) & (scalp.ears[bust.quads].max(1) < 0.01)
    hidden &= points[bust.quads][..., 1].min(1) > bust.eyes["l"].centre[1]
    return ((bust.charts == 0) | (bust.charts == 3)) & above & ~hidden


def worth_detail(bust: Bust, scalp: Scalp) -> np.ndarray:
    """bool per coarse quad: lips, lids, and what is large on the front of the face."""
    points = bust.skin.points[: len(bust.control)]
    corners = points[bust.quads]
    centre = corners.mean(1)
    front = (
        (centre[:, 2] > 0.90) & (centre[:, 1] > 6.32) & (centre[:, 1] < 7.64) & (np.abs(centre[:, 0]) < 0.56)
    )
    area = np.linalg.norm(np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]), axis=1) / 2
    lips = bust.skin.points[bust.skin.outer.vertices]
    near_lips = ((centre > lips.min(0) - 0.03) & (centre < lips.max(0) + 0.03)).all(1)
    eye = bust.eyes["l"].centre
    near_eyes = np.hypot((np.abs(centre[:, 0]) - eye[0]) * 0.75, centre[:, 1] - eye[1]) < 0.125
    covered = scalp.inside(points)[bust.quads].min(1) > 0.08
    return front & ~covered & (bust.charts == 0) & (near_lips | near_eyes | (area > LARGE_DM2))


def _over_neckline(points: Array, look: ShirtLook) -> Array:
    height, slope = NECKLINE
    plane = points[..., 1] - (height + look.neckline + slope * (0.85 - points[..., 2]))
    beside = 2 * (1.0 - np.abs(points[..., 0]))
    return np.asarray(-ROUND * np.logaddexp(-plane / ROUND, -beside / ROUND))


def clothes(bust: Bust, look: ShirtLook) -> Piece:
    """A plain shirt over the torso, cut at the neckline, with its collar."""
    skin = bust.skin
    centre = skin.points[: len(bust.control)][bust.quads].mean(1)
    torso = (bust.charts == 3) | ((bust.charts == 0) & (centre[:, 1] < CHIN_CLEAR))
    fine = torso & (centre[:, 1] > FINE_FROM)
    matrix, _ = laplacian(skin.points, skin.triangles)
    points = _relaxed(skin.points + skin.normals * SHIRT_GAP, matrix, 14)
    triangles = mixed_triangles(bust.quads, len(bust.control), torso, fine)
    points, triangles = clip(points, triangles, -_over_neckline(points, look))
    shirt = Mesh(points, cloth_uvs(points), triangles)
    mesh = joined([shirt, _collar(points, triangles, look)])
    return Piece.of("shirt", mesh, paint.shirt_material(look.colour))


def cloth_uvs(points: Array) -> Array:
    """Texture coordinates (n, 2) of cloth, as if hung from the shoulders: ten tiles a decimetre."""
    around = np.arctan2(points[:, 0], points[:, 2] - 0.3) * 1.4
    return np.stack([around, -points[:, 1]], 1) * 10.0


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


def _collar(points: Array, triangles: Ints, look: ShirtLook) -> Mesh:
    """A rib along the shirt's upper border."""
    edges, _, counts = edges_of(np.c_[triangles, triangles[:, :1]][:, :3])
    rim = np.unique(edges[counts == 1])
    rim = rim[np.abs(_over_neckline(points[rim], look)) < 0.03]
    line = points[rim]
    centre = line.mean(0)
    order = np.argsort(np.arctan2(line[:, 0] - centre[0], line[:, 2] - centre[2]))
    line = line[order]
    even = np.linspace(0, len(line), 41)[:-1]
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
    turn = np.linspace(0, 2 * np.pi, 6, endpoint=False)
    points = (
        path[None]
        + (0.022 * np.cos(turn))[:, None, None] * outward[None]
        + (0.075 * np.sin(turn) + 0.01)[:, None, None] * (0.9 * up - 0.35 * outward)[None]
    )
    points = np.concatenate([points, points[:1]])
    mesh = grid(points, cloth_uvs(points.reshape(-1, 3)).reshape(*points.shape[:2], 2), closed=True)
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
