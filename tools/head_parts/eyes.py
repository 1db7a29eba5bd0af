"""Eyes: the ball with its cornea, lashes, the wet line of the lower lid and the caruncle. Decimetres."""

from __future__ import annotations

import numpy as np

from fapstream.head.mesh import Material
from head_parts.assemble import Piece
from head_parts.bust import Bust, Eye, nearest
from head_parts.features import IRIS_RAD, PUPIL_RAD, Mesh, facing, grid, joined, lashes
from head_parts.paint import EYE_SPAN_RAD, FRINGE
from head_parts.surface import Array

RINGS = np.r_[0.0, 0.07, PUPIL_RAD, 0.2, 0.27, 0.34, IRIS_RAD, 0.46, 0.54, np.linspace(0.66, EYE_SPAN_RAD, 7)]
SPOKES = 24
CORNEA = 0.040
"""How far the cornea stands out, as a share of the ball's radius."""
WET, FLESH = 0.25, 0.75
"""Where in the picture of tears (u) the film and the caruncle are."""


def ball_reach(polar: Array) -> Array:
    """Radius in the eye's picture, 0..0.5, of polar angles: the iris gets most of it."""
    return 0.5 * np.sqrt(np.clip(polar / EYE_SPAN_RAD, 0, 1))


def eyeball(eye: Eye) -> Mesh:
    """A ball with a cornea, looking along +z."""
    turn = np.linspace(0, 2 * np.pi, SPOKES, endpoint=False)
    t, p = np.meshgrid(RINGS, turn, indexing="ij")
    bulge = 1 + CORNEA * np.clip(1 - (t / (IRIS_RAD * 1.12)) ** 2, 0, 1) ** 0.8
    direction = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], -1)
    reach = ball_reach(t)
    uvs = 0.5 + np.stack([reach * np.cos(p), -reach * np.sin(p)], -1)
    mesh = grid(eye.centre + eye.radius * bulge[..., None] * direction, uvs, closed=True)
    used = (mesh.triangles[:, :1] != mesh.triangles[:, 1:2])[:, 0]
    return facing(Mesh(mesh.points, mesh.uvs, mesh.triangles[used]), direction.reshape(-1, 3))


def lash_mesh(bust: Bust, eye: Eye) -> Mesh:
    """Both fringes of an eye, in the upper part of their picture."""
    fringes = []
    for line, upper in ((eye.upper, True), (eye.lower, False)):
        roots = bust.skin.points[line]
        fringes.append(lashes(roots[np.argsort(roots[:, 0])], eye.centre, upper))
    mesh = joined(fringes)
    return Mesh(mesh.points, mesh.uvs * (1.0, FRINGE), mesh.triangles)


def tear_piece(bust: Bust, material: Material) -> Piece:
    """A film along the lower lids and the pink flesh in the inner corners; they move with the lids."""
    meshes, roots = [], []
    for side, eye in bust.eyes.items():
        for mesh, root in (_film(bust, eye), _caruncle(bust, eye, 1.0 if side == "l" else -1.0)):
            meshes.append(mesh)
            roots.append(root)
    piece = Piece.of("tears", joined(meshes), material)
    piece.sources = np.concatenate(roots)
    return piece


def _film(bust: Bust, eye: Eye) -> tuple[Mesh, Array]:
    """A fillet between the lower lid's margin and the ball."""
    order = eye.lower[np.argsort(bust.skin.points[eye.lower][:, 0])]
    line = bust.skin.points[order]
    away = line - eye.centre
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    on_ball = eye.centre + away * (eye.radius * 1.004)
    up = np.array([0.0, 1.0, 0.0]) - away * away[:, 1:2]
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    wide = 0.011 * np.sin(np.linspace(0.12, np.pi - 0.12, len(line)))[:, None] ** 0.5
    rows = [
        line + 0.002 * away,
        0.5 * (line + on_ball) + 0.55 * wide * up + 0.003 * away,
        on_ball + wide * up,
    ]
    points = np.stack(rows)
    uvs = np.stack(np.meshgrid(np.full(len(line), WET), [0.05, 0.5, 0.95]), -1)
    return facing(grid(points, uvs), np.tile(away, (3, 1))), np.tile(order, 3)


def _caruncle(bust: Bust, eye: Eye, sign: float) -> tuple[Mesh, Array]:
    """A small mound in the inner corner."""
    margin = np.concatenate([eye.upper, eye.lower])
    inner = bust.skin.points[margin][np.argmin(sign * bust.skin.points[margin][:, 0])]
    turn, rise = np.meshgrid(np.linspace(0, 2 * np.pi, 8, endpoint=False), np.linspace(0.05, 1.57, 3))
    out = np.stack([np.cos(turn) * np.sin(rise), np.sin(turn) * np.sin(rise), np.cos(rise)], -1)
    centre = inner + np.array([0.018 * sign, -0.004, -0.022])
    points = centre + out * (0.026, 0.020, 0.024)
    uvs = np.stack([np.full(turn.shape, FLESH), rise / 1.7], -1)
    mesh = facing(grid(points, uvs, closed=True), out.reshape(-1, 3))
    return mesh, nearest(bust.skin.points, np.tile(inner, (len(mesh.points), 1)))
