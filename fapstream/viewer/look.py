"""The light on a head: shaders and look.json, the very files that the web client is built from."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any

from fapstream.head.mesh import Material

VERSION = "#version 330 core\n"

Value = bool | int | float | Sequence[float]


@dataclass(frozen=True, slots=True)
class Look:
    """The contents of fapstream/assets/look. `settings` is look.json, `sources` the shaders by file name."""

    settings: Mapping[str, Any]
    sources: Mapping[str, str]

    @property
    def fov(self) -> float:
        """Vertical field of view in degrees."""
        return float(self.settings["fov"])

    @property
    def casters(self) -> tuple[str, ...]:
        """How the names of parts begin that throw shadows."""
        return tuple(self.settings["shadow"]["casters"])

    def finish(self, part: str) -> dict[str, Value]:
        """The #defines of the first finish of which a name starts the part's own."""
        for row in self.settings["finishes"]:
            if part.startswith(tuple(row["parts"])):
                return dict(row["defines"])
        return {}

    def layer(self, part: str, material: Material) -> int:
        """Draw order: what is drawn first hides what lies under it, transparent parts come last."""
        layers: list[str] = self.settings["layers"]
        named = next((i for i, name in enumerate(layers) if name and part.startswith(name)), None)
        layer = layers.index("") if named is None else named
        return layer + len(layers) * (material.alpha == "BLEND")

    def program(self, name: str, defines: Mapping[str, Value]) -> dict[str, str]:
        """The sources of `name`.vert and `name`.frag for GLSL 3.30, as moderngl takes them."""
        head = VERSION + define_lines({**self.settings["defines"], **defines})
        return {
            "vertex_shader": head + self.sources[f"{name}.vert"],
            "fragment_shader": head + self.sources[f"{name}.frag"],
        }


def define_lines(defines: Mapping[str, Value]) -> str:
    """One #define a line: numbers become floats, lists vec2 to vec4, true 1; what is false is left out."""
    return "".join(
        f"#define {name} {_glsl(value)}\n" for name, value in defines.items() if value is not False
    )


@cache
def load_look() -> Look:
    """The package's own look."""
    folder = resources.files("fapstream").joinpath("assets", "look")
    files: Iterable[Any] = folder.iterdir()
    sources = {f.name: f.read_text("utf-8") for f in files if f.name.endswith((".vert", ".frag"))}
    return Look(json.loads(folder.joinpath("look.json").read_text("utf-8")), sources)


def _glsl(value: Value) -> str:
    if value is True:
        return "1"
    if isinstance(value, int | float):
        return repr(float(value))
    return f"vec{len(value)}({', '.join(_glsl(float(v)) for v in value)})"
