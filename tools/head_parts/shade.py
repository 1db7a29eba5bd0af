"""How much of the sky each point of the skin sees: ambient occlusion from many depth pictures."""

from __future__ import annotations

import moderngl
import numpy as np

from head_parts.surface import Array, Ints

DIRECTIONS, SIZE, BIAS = 160, 768, 0.012


def openness(points: Array, normals: Array, meshes: list[tuple[Array, Ints]]) -> Array:
    """(n,) 0..1 for points with normals among opaque meshes (points, triangles); cosine weighted."""
    context = moderngl.create_context(standalone=True, backend="egl")
    program = context.program(
        vertex_shader="#version 330\nuniform mat4 m; in vec3 p; void main() {gl_Position = m * vec4(p, 1);}",
        fragment_shader="#version 330\nvoid main() {}",
    )
    depth = context.depth_texture((SIZE, SIZE))
    target = context.framebuffer(depth_attachment=depth)
    arrays = [
        context.vertex_array(
            program,
            [(context.buffer(v.astype("f4").tobytes()), "3f", "p")],
            context.buffer(t.astype("u4").tobytes()),
        )
        for v, t in meshes
    ]
    centre, radius = points.mean(0), np.ptp(points, axis=0).max() * 0.75
    seen, total = np.zeros(len(points)), np.zeros(len(points))
    context.enable(moderngl.DEPTH_TEST)
    for direction in _sphere(DIRECTIONS):
        matrix = _looking(direction, centre, radius)
        program["m"].write(matrix.T.astype("f4").tobytes())
        target.use()
        target.clear(depth=1.0)
        for array in arrays:
            array.render()
        stored = np.frombuffer(depth.read(), "f4").reshape(SIZE, SIZE)
        place = (points + normals * 0.004) @ matrix[:3, :3].T + matrix[:3, 3]
        column, row = (np.clip(((place[:, k] + 1) / 2 * SIZE).astype(int), 0, SIZE - 1) for k in (0, 1))
        clear = (place[:, 2] + 1) / 2 < stored[row, column] + BIAS / (2 * radius)
        weight = np.clip(normals @ direction, 0, 1) * (1.15 + direction[1])
        seen += weight * clear
        total += weight
    context.release()
    return seen / np.maximum(total, 1e-9)


def _sphere(count: int) -> Array:
    """Directions spread evenly (golden spiral)."""
    k = np.arange(count) + 0.5
    y, turn = 1 - 2 * k / count, np.pi * (1 + 5**0.5) * k
    ring = np.sqrt(1 - y * y)
    return np.stack([ring * np.cos(turn), y, ring * np.sin(turn)], 1)


def _looking(direction: Array, centre: Array, radius: float) -> Array:
    """Orthographic clip matrix that looks along -direction; z grows away from the light."""
    side = np.cross([0.0, 1.0, 0.0], direction)
    side /= np.linalg.norm(side)
    up = np.cross(direction, side)
    matrix = np.eye(4)
    matrix[:3, :3] = np.stack([side, up, -direction]) / radius
    matrix[:3, 3] = -matrix[:3, :3] @ centre
    return matrix
