"""A head of coloured squares for the viewer's tests."""

from __future__ import annotations

import numpy as np

from fapstream.head.fapu import Fapu
from fapstream.head.mesh import Camera, FatEntry, Head, Material, Mouth, Part


def square(name: str, z: float, half: float, material: Material) -> Part:
    """Upright, facing the viewer, `half` metres from its middle to its edges."""
    corners = np.float32([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * np.float32(half)
    corners[:, 2] = z
    normals = np.tile(np.float32([0, 0, 1]), (4, 1))
    uvs = np.float32([[0, 1], [1, 1], [1, 0], [0, 0]])
    return Part(name, corners, normals, uvs, np.uint32([[0, 1, 2], [0, 2, 3]]), material)


def squares(*parts: Part) -> Head:
    """A head of such parts; FAP 5 moves the first one up, by a millimetre each unit."""
    up = np.int16([[[0, 1, 0]] * 4])
    table = FatEntry.of(5, parts[0].name, (1,), np.arange(4, dtype=np.uint32), up, 1e-3)
    return Head(
        "squares",
        parts,
        Fapu(0.01, 0.06, 0.04, 0.02, 0.05),
        {},
        Mouth((0.0, 0.0, 0.0), (0.05, 0.02)),
        Camera((0.0, 0.0, 0.0), 0.4),
        (table,),
        (),
    )


def face(**values: int) -> np.ndarray:
    """FAPs (68,) from f5=-200."""
    out = np.zeros(68)
    for name, value in values.items():
        out[int(name[1:]) - 1] = value
    return out
